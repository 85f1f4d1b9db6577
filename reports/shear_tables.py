"""Tables of the sheared sheet: sizes of the wrinkles, loads and energies, each with its two bands; the runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cases.estimates import ShearEstimate
from cases.mesh_sequence import believed, mesh_limit
from reports.content import Table
from reports.figures_shear_bands import Series
from reports.loads import energy_gained, partner_key, planned_nodes, top_move
from reports.shear_measures import Measured, value_of
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import find, stable

Load = tuple[float, float]
Groups = Mapping[Load, list[Stored]]
Quantity = Callable[[Stored], float]
LOAD = "shear + pre-stretch (mm)"


@dataclass(frozen=True)
class Believed:
    """A quantity on the finest mesh, the range to believe, and whether that is about a limit of the meshes."""

    finest: float
    low: float
    high: float
    has_limit: bool


def values_of(runs: Sequence[Stored], quantity: Quantity) -> list[float]:
    """The quantity of every converged run that has it."""
    return [v for s in runs if s.converged and math.isfinite(v := quantity(s))]


def same_mesh(meshes: Sequence[Stored], seeds: Sequence[Stored]) -> list[Stored]:
    """The further seeds, and the run of the mesh sequence on their mesh."""
    nodes = {planned_nodes(s) for s in seeds}
    return [*(s for s in meshes if planned_nodes(s) in nodes), *seeds]


def to_believe(meshes: Sequence[Stored], seeds: Sequence[Stored], quantity: Quantity) -> Believed | None:
    """The quantity on the finest mesh with its range; None where no run has it."""
    runs = [s for s in meshes if s.converged and math.isfinite(quantity(s))]
    values, others = values_of(runs, quantity), values_of(same_mesh(meshes, seeds), quantity)
    if not values:
        return None
    try:
        limit = mesh_limit([planned_nodes(s) for s in runs], values)
    except ValueError:  # fewer than three meshes, or meshes too close to each other
        everything = [*values[-3:], *others]
        return Believed(values[-1], min(everything), max(everything), False)
    return Believed(values[-1], *believed(limit, values, others), not limit.refused)


def series(
    load: Load, meshes: Sequence[Stored], seeds: Sequence[Stored], quantity: Quantity
) -> Series | None:
    """The quantity under one load as it is drawn; None where no mesh has it."""
    found = to_believe(meshes, seeds, quantity)
    if found is None:
        return None
    points = [
        np.array(
            [(planned_nodes(s), quantity(s)) for s in runs if s.converged and math.isfinite(quantity(s))]
        )
        for runs in (meshes, seeds)
    ]
    return Series(load, points[0].reshape(-1, 2), points[1].reshape(-1, 2), found.low, found.high)


def banded_text(
    meshes: Sequence[Stored], seeds: Sequence[Stored], quantity: Quantity, digits: int = 3
) -> str:
    """Value on the finest mesh, limit with its band or else range; `digits` 0 for a count."""
    found = to_believe(meshes, seeds, quantity)
    if found is None:
        return "–"

    def text(value: float) -> str:
        return number(value, digits) if digits else whole(value)

    if found.low == found.high:
        return text(found.finest)
    if found.has_limit and digits:
        middle, half = 0.5 * (found.low + found.high), 0.5 * (found.high - found.low)
        return f"{text(found.finest)}; {text(middle)} ± {number(half, 2)}"
    return f"{text(found.finest)}; {text(found.low)} to {text(found.high)}"


def load_words(load: Load) -> str:
    """Displacement and pre-stretch as a cell."""
    return f"{load[0]:g} + {load[1]:g}"


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
                load_words(load),
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
        LOAD,
        "half-wavelength across (mm)",
        "estimate (mm)",
        "middle |z| (mm)",
        "estimate (mm)",
        "fan |z| (mm)",
        "zero crossings",
        "direction (degrees)",
    )
    caption = (
        "Wrinkles of the sheared sheet: value on the finest mesh; then either limit of the mesh sequence ± its band "
        "and half of the range over three random starts, or, where the meshes approach no limit, the least and the "
        "greatest value of the three meshes and the three starts. The middle is the inner half of section A; the fans "
        "have the largest height of the whole sheet."
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
        rows.append((load_words(load), *cells))
    columns = (LOAD, *quantities)
    return Table(
        "Reactions of the upper clamp and energies of the sheared sheet, with the same bands.",
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
        crossings = value_of(measured, run, "zero_crossings", thickness_mm)
        imposed = run.run.imposed_mm
        rows.append(
            (
                load_words((move, rise)),
                whole(run.value("nodes")),
                f"seed {run.run.seed}" if imposed is None else f"waves of {imposed:g} mm",
                run.status.replace("_", " "),
                number(run.value("residual"), 2),
                whole(run.value("steps")),
                stable(run),
                number(run.value("nodes_per_wrinkle"), 2) if math.isfinite(crossings) else "–",
                whole(crossings),
                number(run.value("energy_N_mm", "total"), 6),
                number(run.value("cpu_seconds"), 3),
            )
        )
    columns = (
        LOAD,
        "nodes",
        "start",
        "status",
        "residual (–)",
        "steps",
        "stable",
        "nodes per wrinkle",
        "zero crossings",
        "energy (N\u00a0mm)",
        "CPU (s)",
    )
    return Table("Runs of the sheared sheet; imposed waves by their half-wavelength.", columns, tuple(rows))
