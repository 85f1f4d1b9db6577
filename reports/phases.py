"""The phase of the wrinkles across the middle: how much of the profile is symmetric, how much antisymmetric.

Wrinkles z = e(x) cos(k x + phase) under an envelope e that is symmetric about the middle have the symmetric part
e cos(k x) cos(phase) and the antisymmetric one -e sin(k x) sin(phase).  Over several waves cos(k x) and sin(k x) are
equally large, so the rms values of both parts, with the signs of cos(phase) and sin(phase), are a point on a circle
whose radius is the rms height and whose angle is the phase.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from reports.loads import MIDDLE
from reports.stored import Stored


@dataclass(frozen=True)
class Phase:
    """even_mm, odd_mm : rms of both parts (mm), with the signs of cos(phase) and sin(phase)."""

    even_mm: float
    odd_mm: float

    @property
    def angle_deg(self) -> float:
        """The phase, 0 to 360 degrees."""
        return math.degrees(math.atan2(self.odd_mm, self.even_mm)) % 360.0

    @property
    def rms_mm(self) -> float:
        """Root mean square height."""
        return math.hypot(self.even_mm, self.odd_mm)


def phase_of(run: Stored) -> Phase | None:
    """Phase of the wrinkles of a run; None without a profile or where it is flat."""
    section = run.section(MIDDLE)
    if not section or not np.any(section["z_mm"]) or not np.isfinite(section["z_mm"]).all():
        return None
    return phase(section["x_mm"], section["z_mm"])


def phase(x: np.ndarray, z: np.ndarray) -> Phase:
    """Phase of the profile z (n,) mm at evenly spaced places x (n,) mm, symmetric about 0 and rising."""
    mirrored = np.interp(-x, x, z)
    even, odd = 0.5 * (z + mirrored), 0.5 * (z - mirrored)
    centre = len(x) // 2
    slope = float(odd[centre + 1] - odd[centre - 1])
    return Phase(math.copysign(_rms(x, even), float(even[centre])), math.copysign(_rms(x, odd), -slope))


def _rms(x: np.ndarray, z: np.ndarray) -> float:
    return math.sqrt(float(np.trapezoid(z**2, x)) / float(x[-1] - x[0]))
