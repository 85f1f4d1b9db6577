"""Measures of the strip's wrinkles against the pull, with the band of the mesh sequence; as curves and as a table."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from reports.bands import Banded, banded
from reports.content import Table
from reports.loads import energy_gained, finest, measure, partner_key, wrinkled
from reports.stored import Stored
from reports.style import number, whole


@dataclass(frozen=True)
class PullCurves:
    """pulls : (m,) %.  curves : name -> one banded value for each pull.  runs : the runs of each pull."""

    pulls: np.ndarray
    curves: Mapping[str, list[Banded]]
    runs: Mapping[float, list[Stored]]

    def finest(self, pull: float) -> Stored | None:
        """The finest usable run of a pull."""
        return finest(self.runs[pull])


def curves(groups: Mapping[float, list[Stored]], flat: Mapping[tuple[object, ...], Stored]) -> PullCurves:
    """Extrapolate every measure at every pull.

    groups : runs by pull (%), from coarse to fine.  flat : flat runs by `loads.partner_key`.
    """
    quantities: Mapping[str, Callable[[Stored], float]] = {
        "amplitude": lambda s: measure(s, "amplitude_mm"),
        "rms": lambda s: measure(s, "rms_mm"),
        "wavelength": lambda s: measure(s, "wavelength_mm") if wrinkled(s) else math.nan,
        "half_waves": lambda s: measure(s, "half_waves") if wrinkled(s) else math.nan,
        "bending": lambda s: s.value("energy_N_mm", "bending"),
        "gained": lambda s: energy_gained(s, flat.get(partner_key(s))),
    }
    found = {name: [banded(runs, q, wrinkled) for runs in groups.values()] for name, q in quantities.items()}
    return PullCurves(np.array(list(groups)), found, groups)


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
                *(c.text() for c in cells[:3]),
                whole(cells[3].finest),
                *(c.text() for c in cells[4:]),
                number(last.value("stability", "lowest"), 2) if last is not None else "–",
                f"{good} of {len(runs)}",
                whole(last.value("nodes")) if last is not None else "–",
                number(float(np.nansum([s.value("cpu_seconds") for s in runs])), 2),
            )
        )
    columns = (
        "pull (%)",
        "largest |z| (mm)",
        "rms z (mm)",
        "wavelength (mm)",
        "half waves",
        "bending energy (N\u00a0mm)",
        "gained (N\u00a0mm)",
        "lowest eigenvalue (–)",
        "con\u00adverged",
        "finest mesh",
        "CPU (s)",
    )
    caption = (
        "Wrinkles across the middle against the pull: limit of the mesh sequence ± its band (the finest mesh's value ± "
        "the range of the meshes where they approach no limit; the finest value alone where the meshes disagree on "
        "whether the strip wrinkles); half-waves on the finest mesh. The lowest eigenvalue is that of the finest "
        "state's tangent: positive where the state, flat or wrinkled, is stable."
    )
    return Table(caption, columns, tuple(rows))
