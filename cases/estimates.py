"""Wrinkles of a sheared sheet estimated by hand, beside what is computed.

An estimate in the style of Wong and Pellegrino (2006): straight parallel wrinkles at 45 degrees, a sheet in simple
tension along them, and the wavelength at which bending across the wrinkles and the tension that curves along them cost
the same. We could not check it against their text; it is an estimate, not a reference.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from cases.schema import RectangleSheet, Scene
from fdsolver.material import Sheet


class NoEstimate(ValueError):
    """A scene that the estimate is not for; the message is one sentence."""


@dataclass(frozen=True)
class ShearEstimate:
    """half_wavelength_mm : across the wrinkles. amplitude_mm : of the middle of the sheet. crest_deg : direction."""

    half_wavelength_mm: float
    amplitude_mm: float
    crest_deg: float = 45.0


def shear_estimate(sheet: Sheet, height_mm: float, shear: float) -> ShearEstimate:
    """Wrinkles of a wide sheet sheared between two rails `height_mm` apart.

    shear : g = displacement of one rail along the other / height. The half-wavelength is
    sqrt(pi H h / sqrt(3 (1 - nu^2) g)), the amplitude (half-wavelength / pi) sqrt(2 (1 - nu) g): across the
    wrinkles the rails shorten the sheet by g / 2, of which the contraction that goes with the tension along them takes
    nu g / 2, and waves the rest.

    Raises NoEstimate for a shear or a height that is not positive.
    """
    if not (shear > 0.0 and height_mm > 0.0 and math.isfinite(shear * height_mm)):
        raise NoEstimate(
            f"The estimate needs a shear and a height above zero, not {shear:g} and {height_mm:g} mm."
        )
    nu = sheet.poisson
    stiffness = math.sqrt(3.0 * (1.0 - nu**2) * shear)
    half_wavelength = math.sqrt(math.pi * height_mm * sheet.thickness_mm / stiffness)
    return ShearEstimate(half_wavelength, half_wavelength / math.pi * math.sqrt(2.0 * (1.0 - nu) * shear))


def estimate_of(scene: Scene) -> ShearEstimate:
    """The estimate for a rectangle whose top edge is moved along x.

    Raises NoEstimate for other sheets, and for one whose edges do not shear it.
    """
    if not isinstance(scene.sheet, RectangleSheet):
        raise NoEstimate("The estimate is for rectangles that are sheared between bottom and top.")
    move = scene.edges["top"].move_mm[0] - scene.edges["bottom"].move_mm[0]
    sheet = Sheet(scene.material.young_MPa, scene.material.poisson, scene.sheet.thickness_mm)
    return shear_estimate(sheet, scene.sheet.height_mm, abs(move) / scene.sheet.height_mm)
