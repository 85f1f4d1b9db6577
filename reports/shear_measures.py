"""Measures of the sheared sheet's wrinkles, run by run, as the tables ask for them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from cases.results import ResultError, load_result
from cases.sheared import ShearMeasures, shear_measures
from fdsolver.result import Solution
from reports.loads import WRINKLED, section_line
from reports.stored import Stored

Measured = Mapping[str, ShearMeasures]
SHAPE = ("half_wavelength_mm", "crest_deg", "zero_crossings")  # of wrinkles; a flat sheet has none


def measure_all(runs: Iterable[Stored]) -> dict[str, ShearMeasures]:
    """Measures by the run's name, of all runs with a readable shape and a section."""
    found = {}
    for run in runs:
        line = section_line(run)
        if not run.drawable or line is None:
            continue
        try:
            state = load_result(run.folder)
        except ResultError:
            continue
        if isinstance(state, Solution) and "top" in state.reactions:
            found[run.run.name] = shear_measures(state, line)
    return found


def value_of(measured: Measured, run: Stored, name: str, thickness_mm: float) -> float:
    """One measure of a run; NaN if it has none, or for the shape of the wrinkles of a sheet that stayed flat."""
    found = measured.get(run.run.name)
    if found is None or (name in SHAPE and found.fan_maximum_mm < WRINKLED * thickness_mm):
        return math.nan
    return float(getattr(found, name))
