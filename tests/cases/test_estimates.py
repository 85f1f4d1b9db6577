"""The hand estimate of shear wrinkles: its numbers for the paper's sheet, its scaling, its balance."""

from __future__ import annotations

import math

import pytest

from cases import load_scene
from cases.estimates import NoEstimate, estimate_of, shear_estimate
from fdsolver.material import Sheet

KAPTON = Sheet(3500.0, 0.31, 0.025)


@pytest.mark.parametrize(
    # by hand: sqrt(10.0531 / sqrt(2.7117 g)) and the half-wavelength / pi times sqrt(1.38 g)
    ("move", "half_wavelength", "amplitude"),
    [(0.5, 9.8832, 0.23098), (3.0, 6.3148, 0.36150), (0.05, 17.575, 0.12989)],
)
def test_the_numbers_of_the_papers_sheet(move: float, half_wavelength: float, amplitude: float) -> None:
    found = estimate_of(load_scene("shear", {"edges.top.move_mm": [move, 0.05, 0.0]}))
    assert found.half_wavelength_mm == pytest.approx(half_wavelength, rel=1e-4)
    assert found.amplitude_mm == pytest.approx(amplitude, rel=1e-4)
    assert found.crest_deg == 45.0


def test_the_wavelength_balances_bending_and_tension() -> None:
    """Energy of a sine of wavenumber k across and one half-wave along a crest of length l = sqrt(2) H.

    At given slope the bending energy goes with D k^2 and that of the tension Y h g / 2 along the crests with
    (Y h g / 2) (pi / l)^2 / k^2, which are equal at the best k.
    """
    height, g = 128.0, 0.004
    k = math.pi / shear_estimate(KAPTON, height, g).half_wavelength_mm
    bending = KAPTON.bending_stiffness_N_mm * k**2
    crest = math.sqrt(2.0) * height
    tension = 0.5 * KAPTON.young_MPa * KAPTON.thickness_mm * g * (math.pi / crest) ** 2 / k**2
    assert bending == pytest.approx(tension, rel=1e-12)


def test_the_amplitude_takes_up_the_width_that_is_too_much() -> None:
    """A sine of slope s shortens its line by s^2 / 4; too much are g / 2 - nu g / 2."""
    found = shear_estimate(KAPTON, 128.0, 0.01)
    slope = math.pi * found.amplitude_mm / found.half_wavelength_mm
    assert slope**2 / 4.0 == pytest.approx(0.5 * 0.01 * (1.0 - 0.31), rel=1e-12)


@pytest.mark.parametrize(("height", "shear"), [(128.0, 0.0), (128.0, -0.1), (0.0, 0.1), (128.0, math.nan)])
def test_no_estimate_without_shear(height: float, shear: float) -> None:
    with pytest.raises(NoEstimate, match="above zero"):
        shear_estimate(KAPTON, height, shear)


def test_no_estimate_for_other_scenes() -> None:
    with pytest.raises(NoEstimate, match="rectangles"):
        estimate_of(load_scene("annulus"))
    with pytest.raises(NoEstimate, match="above zero"):
        estimate_of(load_scene("stretch"))
