"""Tables of the sheared sheet: sizes of the wrinkles, loads and energies, each with its two bands; the runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from cases.estimates import ShearEstimate
from reports.bands import banded
from reports.content import Table
from reports.loads import energy_gained, partner_key, planned_nodes, top_move
from reports.shear_measures import Measured, value_of
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import find, stable

Load = tuple[float, float]
Groups = Mapping[Load, list[Stored]]
Quantity = Callable[[Stored], float]


def spread(runs: Sequence[Stored], quantity: Quantity) -> float:
    """Half of the range of a quantity over converged runs; NaN with fewer than two."""
    values = [v for s in runs if s.converged and math.isfinite(v := quantity(s))]
    return 0.5 * (max(values) - min(values)) if len(values) > 1 else math.nan


def same_mesh(meshes: Sequence[Stored], seeds: Sequence[Stored]) -> list[Stored]:
    """The further seeds, and the run of the mesh sequence on their mesh."""
    nodes = {planned_nodes(s) for s in seeds}
    return [*(s for s in meshes if planned_nodes(s) in nodes), *seeds]


def banded_text(
    meshes: Sequence[Stored], seeds: Sequence[Stored], quantity: Quantity, digits: int = 3
) -> str:
    """Value on the finest mesh with the band of the meshes and that of the seeds; `digits` 0 for a count."""
    value = banded(meshes, quantity)
    if math.isnan(value.finest):
        return "–"
    among = spread(same_mesh(meshes, seeds), quantity)
    if digits == 0:
        return f"{whole(value.finest)} ± {number(value.error, 2)} ± {number(among, 2)}"
    return f"{number(value.finest, digits)} ± {number(value.error, 2)} ± {number(among, 2)}"


def load_words(load: Load) -> tuple[str, str]:
    """Displacement and pre-stretch as cells."""
    return f"{load[0]:g}", f"{load[1]:g}"


def wrinkle_size_table(
    meshes: Groups,
    seeds: Groups,
    measured: Measured,
    estimates: Mapping[float, ShearEstimate],
    thickness_mm: float,
) -> Table:
    """Sizes of the wrinkles beside their estimate."""

    def named(name: str) -> Quantity:
        return lambda s: value_of(measured, s, name, thickness_mm)

    rows = []
    for load, runs in meshes.items():
        others = seeds.get(load, [])
        estimate = estimates[load[0]]
        rows.append(
            (
                *load_words(load),
                banded_text(runs, others, named("half_wavelength_mm")),
                number(estimate.half_wavelength_mm, 3),
                banded_text(runs, others, named("middle_amplitude_mm")),
                number(estimate.amplitude_mm, 3),
                banded_text(runs, others, named("fan_maximum_mm")),
                banded_text(runs, others, named("zero_crossings"), 0),
                banded_text(runs, others, named("crest_deg")),
            )
        )
    columns = (
        "shear (mm)",
        "pre-stretch (mm)",
        "half-wavelength across (mm)",
        "estimated",
        "middle |z| (mm)",
        "estimated",
        "fan |z| (mm)",
        "zero crossings",
        "direction (degrees)",
    )
    caption = (
        "Wrinkles of the sheared sheet: value on the finest mesh ± its error by the mesh sequence (the range of the "
        "meshes where they approach no limit) ± half of the range over three random starts; an en dash where that is "
        "not known. The middle is the inner half of section A; the fans have the largest height of the whole sheet."
    )
    return Table(caption, columns, tuple(rows))


def energy_table(meshes: Groups, seeds: Groups, flat: Mapping[tuple[object, ...], Stored]) -> Table:
    """Reactions of the upper clamp and energies."""
    quantities: Mapping[str, Quantity] = {
        "shear reaction (N)": lambda s: find(s, ("reactions", "top", "force_N", "#0")),
        "vertical reaction (N)": lambda s: find(s, ("reactions", "top", "force_N", "#1")),
        "energy (N\u00a0mm)": lambda s: s.value("energy_N_mm", "total"),
        "bending energy (N\u00a0mm)": lambda s: s.value("energy_N_mm", "bending"),
        "gained by wrinkling (N\u00a0mm)": lambda s: energy_gained(s, flat.get(partner_key(s))),
    }
    rows = []
    for load, runs in meshes.items():
        others = seeds.get(load, [])
        cells = [banded_text(runs, others, q, 4) for q in quantities.values()]
        seconds = float(np.nansum([s.value("cpu_seconds") for s in (*runs, *others)]))
        rows.append((*load_words(load), *cells, number(seconds, 3)))
    columns = ("shear (mm)", "pre-stretch (mm)", *quantities, "CPU (s)")
    return Table(
        "Reactions of the upper clamp and energies of the sheared sheet, with the same two bands.",
        columns,
        tuple(rows),
    )


def run_rows(mine: Sequence[Stored], measured: Measured, thickness_mm: float) -> Table:
    """Every run of the sheared sheet but the flat ones."""
    rows = []
    for run in mine:
        if run.run.part == "flat":
            continue
        move, rise, _ = top_move(run.run)
        rows.append(
            (
                f"{move:g}",
                f"{rise:g}",
                whole(run.value("nodes")),
                str(run.run.seed),
                run.status.replace("_", " "),
                number(run.value("residual"), 2),
                whole(run.value("steps")),
                stable(run),
                number(run.value("nodes_per_wrinkle"), 2),
                whole(value_of(measured, run, "zero_crossings", thickness_mm)),
                number(run.value("energy_N_mm", "total"), 6),
                number(run.value("cpu_seconds"), 3),
            )
        )
    columns = (
        "shear (mm)",
        "pre-stretch (mm)",
        "nodes",
        "seed",
        "status",
        "residual (–)",
        "steps",
        "stable",
        "nodes per wrinkle",
        "zero crossings",
        "energy (N\u00a0mm)",
        "CPU (s)",
    )
    return Table("Runs of the sheared sheet.", columns, tuple(rows))
