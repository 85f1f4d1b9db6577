"""Measures of the sheared sheet's wrinkles, run by run, as the tables ask for them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from cases.sheared import ShearMeasures, shear_measures
from reports.loads import WRINKLED, readable_states
from reports.stored import Stored

Measured = Mapping[str, ShearMeasures]
SHAPE = ("half_wavelength_mm", "crest_deg", "zero_crossings")  # of wrinkles; a flat sheet has none


def measure_all(runs: Iterable[Stored]) -> dict[str, ShearMeasures]:
    """Measures by the run's name, of all runs with a readable shape and a section."""
    return {
        run.run.name: shear_measures(state, line)
        for run, line, state in readable_states(runs)
        if "top" in state.reactions
    }


def value_of(measured: Measured, run: Stored, name: str, thickness_mm: float) -> float:
    """One measure of a run; NaN if it has none, or for the shape of the wrinkles of a sheet that stayed flat."""
    found = measured.get(run.run.name)
    if found is None or (name in SHAPE and found.fan_maximum_mm < WRINKLED * thickness_mm):
        return math.nan
    return float(getattr(found, name))
