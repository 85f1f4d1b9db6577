"""Measures of the sheared sheet's wrinkles: across the middle, in the corner fans, and along section A."""

from __future__ import annotations

import math

import numpy as np

from cases.direction import mean_crest_deg, wrinkle_direction
from cases.files import read_fields
from reports.loads import MIDDLE, measure
from reports.stored import Stored

MIDDLE_PART = 0.25  # of the width, to either side: what counts as the middle of the sheet


def middle_amplitude(stored: Stored) -> float:
    """Largest |z| on section A within a quarter of the width from the middle, mm; NaN without a section."""
    section = stored.section(MIDDLE)
    if not section:
        return math.nan
    x, z = section["x_mm"], section["z_mm"]
    inside = np.abs(x) <= MIDDLE_PART * float(np.ptp(x))
    return float(np.abs(z[inside]).max()) if inside.any() else math.nan


def fan_maximum(stored: Stored) -> float:
    """Largest |z| nearer to an upright edge than the sheet is high: the corner fans, mm; NaN without a shape."""
    if not stored.drawable:
        return math.nan
    u, z = stored.fields["u"], stored.fields["r"][..., 2]
    height = float(np.ptp(u[..., 1]))
    outer = np.abs(u[..., 0]) >= 0.5 * float(np.ptp(u[..., 0])) - height
    return float(np.abs(z[outer]).max()) if outer.any() else math.nan


def zero_crossings(stored: Stored) -> float:
    """Sign changes along section A between its outermost extrema above 5 % of the amplitude."""
    return measure(stored, "half_waves") - 1.0


def direction_deg(stored: Stored) -> float:
    """Mean direction of the wrinkles' crests in the middle of the sheet, degrees from the x axis.

    NaN without a shape, or where the middle is flat.
    """
    wavelength = measure(stored, "wavelength_mm")
    if not stored.drawable or math.isnan(wavelength):
        return math.nan
    grid, r, _ = read_fields(stored.folder / "fields.npz")
    centre = 0.25 * (grid.u[1:, 1:] + grid.u[1:, :-1] + grid.u[:-1, 1:] + grid.u[:-1, :-1])
    inside = (np.abs(centre) <= MIDDLE_PART * np.ptp(grid.u.reshape(-1, 2), axis=0)).all(axis=-1)
    return mean_crest_deg(wrinkle_direction(grid, r[..., 2], wavelength), inside)


def half_wavelength_across(stored: Stored) -> float:
    """Half of the wavelength on section A, as seen across the wrinkles' own direction, mm."""
    direction = direction_deg(stored)
    return 0.5 * measure(stored, "wavelength_mm") * abs(math.sin(math.radians(direction)))
