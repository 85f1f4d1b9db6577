"""Measures of the strip's wrinkles against the pull, with the band of the mesh sequence; as curves and as a table."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from reports.bands import Banded, banded, counted
from reports.content import Table
from reports.loads import (
    crest_height,
    energy_gained,
    finest,
    measure,
    partner_key,
    pull_percent,
    wavelength,
    wrinkled,
)
from reports.stored import Stored
from reports.style import number, whole

Flat = Mapping[tuple[object, ...], Stored]


@dataclass(frozen=True)
class PullCurves:
    """What the runs of the strip say against the pull.

    pulls : (m,) %. curves : name -> one banded value for each pull. runs : the runs of each pull, from coarse to fine.
    flat : runs whose strip was kept flat, by `loads.partner_key`.
    """

    pulls: np.ndarray
    curves: Mapping[str, list[Banded]]
    runs: Mapping[float, list[Stored]]
    flat: Flat

    def finest(self, pull: float) -> Stored | None:
        """The finest usable run of a pull."""
        return finest(self.runs[pull])

    def flat_eigenvalues(self) -> dict[float, tuple[np.ndarray, np.ndarray]]:
        """For each mesh (nodes) pulls (%) and lowest eigenvalues of the strip kept flat, relative."""
        found: dict[float, list[tuple[float, float]]] = {}
        for run in self.flat.values():
            lowest = run.value("stability", "lowest")
            if run.converged and math.isfinite(lowest):
                found.setdefault(run.value("nodes"), []).append((pull_percent(run), lowest))
        return {nodes: (*np.array(sorted(found[nodes])).T,) for nodes in sorted(found)}


def curves(groups: Mapping[float, list[Stored]], flat: Flat) -> PullCurves:
    """Extrapolate every measure at every pull.

    groups : runs by pull (%), from coarse to fine.  flat : flat runs by `loads.partner_key`.
    """

    quantities: Mapping[str, Callable[[Stored], float]] = {
        "amplitude": crest_height,
        "rms": lambda s: measure(s, "rms_mm"),
        "wavelength": lambda s: wavelength(s) if wrinkled(s) else math.nan,
        "bending": lambda s: s.value("energy_N_mm", "bending"),
        "gained": lambda s: energy_gained(s, flat.get(partner_key(s))),
    }
    found = {name: [banded(runs, q, wrinkled) for runs in groups.values()] for name, q in quantities.items()}
    found["half_waves"] = [
        counted(runs, lambda s: measure(s, "half_waves") if wrinkled(s) else math.nan)
        for runs in groups.values()
    ]
    return PullCurves(np.array(list(groups)), found, groups, flat)


def crossings(pulls: np.ndarray, eigenvalues: np.ndarray) -> list[tuple[float, bool]]:
    """Pulls (%) at which the eigenvalue passes zero, linearly between neighbours, and whether it falls there."""
    change = np.flatnonzero(eigenvalues[:-1] * eigenvalues[1:] < 0.0)
    rise = eigenvalues[change + 1] - eigenvalues[change]
    places = pulls[change] - eigenvalues[change] * (pulls[change + 1] - pulls[change]) / rise
    return [(float(place), bool(r < 0.0)) for place, r in zip(places, rise, strict=True)]


FLAT_CELLS = ("flat", "–", "–", "–", "–", "–")


def _cells(cells: Sequence[Banded]) -> tuple[str, ...]:
    """Crest height, rms height, wavelength, half-waves, bending energy and energy gained."""
    return (*(c.text() for c in cells[:3]), whole(cells[3].finest), *(c.text() for c in cells[4:]))


def pull_table(found: PullCurves) -> Table:
    """Limits with their bands at every pull, how stable the finest state is, and the seconds of the sequence."""
    rows = []
    for k, pull in enumerate(found.pulls):
        runs = found.runs[float(pull)]
        last = finest(runs)
        good = sum(s.converged for s in runs)
        cells = [
            found.curves[n][k] for n in ("amplitude", "rms", "wavelength", "half_waves", "bending", "gained")
        ]
        rows.append(
            (
                f"{pull:g}",
                *(_cells(cells) if last is None or not last.converged or wrinkled(last) else FLAT_CELLS),
                number(lowest_flat(last, found.flat), 2),
                f"{good} of {len(runs)}",
                number(seconds_of(runs, found.flat), 2),
            )
        )
    columns = (
        "pull (%)",
        "crest height (mm)",
        "rms z (mm)",
        "mean wavelength (mm)",
        "half waves",
        "bending energy (N\u00a0mm)",
        "gained (N\u00a0mm)",
        "eigenvalue of flat (–)",
        "converged",
        "CPU (s)",
    )
    caption = (
        "Wrinkles across the middle against the pull (crest height: of the envelope, whatever the phase): limit of the "
        "mesh sequence ± its band; the finest mesh's value ± the range of the meshes where they approach no limit; the "
        "finest value alone where the meshes disagree on whether the strip wrinkles. Half-waves on the finest mesh. "
        "The eigenvalue is the lowest, relative, of the strip kept flat on that mesh: negative where it must wrinkle. "
        "CPU: all meshes, wrinkled and flat."
    )
    return Table(caption, columns, tuple(rows))


def lowest_flat(run: Stored | None, flat: Flat) -> float:
    """Lowest eigenvalue of the strip kept flat under the load and on the mesh of a run; NaN if unknown."""
    partner = flat.get(partner_key(run)) if run is not None else None
    return partner.value("stability", "lowest") if partner is not None and partner.converged else math.nan


def seconds_of(runs: Sequence[Stored], flat: Flat) -> float:
    """CPU seconds of some runs and of their flat partners."""
    everything = [*runs, *(flat[key] for s in runs if (key := partner_key(s)) in flat)]
    return float(np.nansum([s.value("cpu_seconds") for s in everything]))
