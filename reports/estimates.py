"""An estimate of the wrinkles of a sheared sheet, in the style of Wong and Pellegrino (2006).

It was taken over as formulas and could not be checked against their text, which the report says beside it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class ShearEstimate:
    """half_wavelength_mm : across the wrinkles.  amplitude_mm : height of a crest above the middle plane."""

    half_wavelength_mm: float
    amplitude_mm: float


def shear_estimate(move_mm: float, height_mm: float, thickness_mm: float, poisson: float) -> ShearEstimate:
    """Estimate for a sheet of given height whose upper edge is moved sideways; a pre-stretch does not enter.

    With g the displacement over the height: half-wavelength sqrt(pi height thickness / sqrt(3 (1 - nu^2) g)) and
    amplitude (half-wavelength / pi) sqrt(2 (1 - nu) g).
    """
    angle = move_mm / height_mm
    half = math.sqrt(math.pi * height_mm * thickness_mm / math.sqrt(3.0 * (1.0 - poisson**2) * angle))
    return ShearEstimate(half, half / math.pi * math.sqrt(2.0 * (1.0 - poisson) * angle))
