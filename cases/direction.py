"""Direction of wrinkles, zone by zone, from the structure tensor of the height.

The structure tensor of a height z(x, y) is the local mean of grad z (x) grad z, here less that of the mean slope, so
that a tilted or slowly bowed sheet has none. Its principal direction of the larger value runs across the wrinkles; the
crests are at right angles to it. How much the two values differ says how much there is a direction at all.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.ndimage import gaussian_filter

from fdsolver.grid import Grid
from fdsolver.membrane import zone_constants

# Slopes below a millionth are what residuals of 1e-6 leave on a flat sheet: they have no direction worth a name.
LEAST_SLOPE = 1e-6


@dataclass(frozen=True)
class Direction:
    """Wrinkles of every zone, arrays (zone rows, nj - 1).

    crest_deg : direction of the crests in the reference plane against the x axis, in [0, 180) degrees; NaN where flat.
    coherence : (larger - smaller) / (larger + smaller) value of the structure tensor: 1 for straight parallel wrinkles,
        0 where no direction is preferred; NaN where flat.
    slope : rms slope of the wrinkles.
    """

    crest_deg: np.ndarray
    coherence: np.ndarray
    slope: np.ndarray


def wrinkle_direction(grid: Grid, z: np.ndarray, window_mm: float) -> Direction:
    """Direction of the wrinkles of a height z (ni, nj), mm, on the reference plane.

    window_mm : standard deviation of the Gaussian window of the local means; about one wavelength. On a mesh of
        unequal zones it is the window in the middle-sized ones.
    """
    sx, sy = zone_slopes(grid, z)
    mean_x, mean_y = (_local_mean(grid, part, window_mm) for part in (sx, sy))
    xx = _local_mean(grid, sx * sx, window_mm) - mean_x**2
    yy = _local_mean(grid, sy * sy, window_mm) - mean_y**2
    xy = _local_mean(grid, sx * sy, window_mm) - mean_x * mean_y
    trace = np.maximum(xx + yy, 0.0)
    flat = trace < LEAST_SLOPE**2
    across = 0.5 * np.degrees(np.arctan2(2.0 * xy, xx - yy))
    crest = np.where(flat, np.nan, np.mod(across + 90.0, 180.0))
    coherence = np.where(flat, np.nan, np.hypot(xx - yy, 2.0 * xy) / np.where(flat, 1.0, trace))
    return Direction(crest, coherence, np.sqrt(trace))


def mean_crest_deg(direction: Direction, inside: np.ndarray) -> float:
    """Mean direction of the crests over the zones `inside`, each with the weight of its squared slope, [0, 180) deg.

    Directions, not angles, are averaged: 1 and 179 degrees have the mean 0. NaN where all zones are flat.
    """
    chosen = inside & np.isfinite(direction.crest_deg)
    if not chosen.any():
        return float("nan")
    weight = direction.slope[chosen] ** 2
    doubled = np.exp(2j * np.radians(direction.crest_deg[chosen]))
    return float(np.mod(0.5 * np.degrees(np.angle(np.sum(weight * doubled))), 180.0))


def zone_slopes(grid: Grid, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slopes dz/dx and dz/dy of every zone [57], arrays (zone rows, nj - 1), of a height z (ni, nj), mm."""
    g1x, g1y, g2x, g2y, _ = zone_constants(grid)
    z = z / grid.length_mm  # the constants are in lengths L
    far, near = (np.roll(z, -1, axis=0), z) if grid.closed else (z[1:], z[:-1])
    d1, d2 = far[:, 1:] - near[:, :-1], near[:, 1:] - far[:, :-1]
    return d1 * g1x + d2 * g2x, d1 * g1y + d2 * g2y


def _local_mean(grid: Grid, field: np.ndarray, window_mm: float) -> np.ndarray:
    """Mean of a zone field in a Gaussian window, weighted by area; beyond the sheet there is nothing."""
    steps = np.diff(grid.u, axis=0), np.diff(grid.u, axis=1)
    sizes = [window_mm / float(np.median(np.linalg.norm(step, axis=-1))) for step in steps]
    modes: tuple[Literal["wrap", "constant"], Literal["constant"]] = (
        "wrap" if grid.closed else "constant",
        "constant",
    )
    weighted = gaussian_filter(grid.zone_area * field, sizes, mode=modes)
    area = gaussian_filter(grid.zone_area, sizes, mode=modes)
    return weighted / area
