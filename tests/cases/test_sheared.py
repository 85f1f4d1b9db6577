"""Measures of sheared sheets on made wrinkles of known length, direction, number and height."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cases.scene import load_scene
from cases.sheared import ShearMeasures, shear_measures, with_bands
from cases.starts import with_waves
from fdsolver import meshes
from fdsolver.result import Reaction, Solution
from tests.cases.made import made_solution

GRID = meshes.rectangle(380.0, 128.0, 30000, bias=0.0)
SECTION = load_scene("shear").sections["midsection"]


def sheared(crest_deg: float, half_wavelength: float, height: float = 0.4) -> Solution:
    """Straight waves all over the sheet, and a rail that feels 3 N along and 5 N across."""
    angle = np.radians(crest_deg)

    def waves(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return height * np.sin(np.pi * (x * np.sin(angle) - y * np.cos(angle)) / half_wavelength)

    made = made_solution(GRID, waves)
    rail = Reaction(np.array([3.0, 5.0, 0.0]), np.zeros(3))
    return replace(made, reactions={"top": rail})


@pytest.mark.parametrize(("crest", "half_wavelength"), [(45.0, 10.0), (45.0, 7.3), (50.0, 9.0), (38.0, 12.0)])
def test_straight_wrinkles(crest: float, half_wavelength: float) -> None:
    found = shear_measures(sheared(crest, half_wavelength), SECTION)
    assert found.crest_deg == pytest.approx(crest, abs=0.5)
    # the middle of 190 mm holds about 13 half-waves: their mean to a hundredth
    assert found.half_wavelength_mm == pytest.approx(half_wavelength, rel=1.5e-2)
    assert found.coherence > 0.98
    assert found.middle_amplitude_mm == pytest.approx(0.4, rel=2e-3)
    assert found.fan_maximum_mm == pytest.approx(0.4, rel=5e-3)
    crossings = 380.0 * np.sin(np.radians(crest)) / half_wavelength
    assert abs(found.zero_crossings - crossings) <= 1.0
    assert (found.shear_N, found.vertical_N) == (3.0, 5.0)


def test_fans_are_found_beside_the_middle() -> None:
    made = sheared(45.0, 10.0)
    fan = 2.0 * np.exp(-(((GRID.u[..., 0] - 150.0) / 15.0) ** 2) - ((GRID.u[..., 1] - 30.0) / 15.0) ** 2)
    r = made.r.copy()
    r[..., 2] += fan
    found = shear_measures(replace(made, r=r), SECTION)
    assert found.middle_amplitude_mm == pytest.approx(0.4, rel=2e-3)
    # the waves add to or take from the fan's 2 mm
    assert found.fan_maximum_mm == pytest.approx(2.0, abs=0.45)


def test_a_flat_sheet_has_no_wavelength() -> None:
    found = shear_measures(replace(sheared(45.0, 10.0), r=made_solution(GRID).r), SECTION)
    assert np.isnan(found.half_wavelength_mm) and np.isnan(found.crest_deg) and np.isnan(found.coherence)
    assert (found.zero_crossings, found.middle_amplitude_mm, found.fan_maximum_mm) == (0, 0.0, 0.0)


def measures(force: float, crossings: int) -> ShearMeasures:
    return ShearMeasures(9.9, 45.0, 0.9, 0.4, 0.8, crossings, force, 1.0, 6.0, 0.1)


def test_bands_come_from_meshes_and_seeds() -> None:
    """Errors 1 / nodes are of second order in the mesh width; a count that jumps has no limit."""
    on_meshes = {n: measures(10.0 + 5000.0 / n, k) for n, k in ((5000, 27), (10000, 29), (20000, 28))}
    table = with_bands(on_meshes, [measures(10.3, 26), measures(10.1, 30)]).set_index("measure")
    force = table.loc["shear_N"]
    assert force["limit"] == pytest.approx(10.0, rel=1e-9) and force["order"] == pytest.approx(2.0)
    assert (force["lowest_seed"], force["highest_seed"]) == (10.1, 10.3)
    # the finest mesh is 0.25 from the limit, Roache's factor 1.25; half of the seeds' range
    assert (force["low"], force["high"]) == pytest.approx((10.0 - 0.4125, 10.0 + 0.4125))
    count = table.loc["zero_crossings"]
    assert "oscillate" in count["refused"]
    assert (count["finest"], count["band"], count["lowest_seed"], count["highest_seed"]) == (
        28.0,
        2.0,
        26.0,
        30.0,
    )
    assert (count["low"], count["high"]) == (26.0, 30.0)  # the seeds go further than the meshes


def test_imposed_waves_leave_the_clamped_edges_alone() -> None:
    scene = load_scene("shear")
    r = with_waves(scene, GRID, 10.0, 0.3)
    flat = with_waves(scene, GRID, 10.0, 0.0)
    np.testing.assert_array_equal(r[..., :2], flat[..., :2])
    assert not flat[..., 2].any()
    np.testing.assert_allclose(r[:, [0, -1], 2], 0.0, atol=1e-15)
    # next to the edge cos^2 leaves (pi dy / H)^2 of the height
    assert np.abs(r[:, [1, -2], 2]).max() < 0.3 * (np.pi * 1.3 / 128.0) ** 2
    made = made_solution(GRID)
    found = shear_measures(replace(sheared(45.0, 10.0), r=made.r + [0.0, 0.0, 1.0] * r), SECTION)
    assert found.half_wavelength_mm == pytest.approx(10.0, rel=1.5e-2)
    assert found.crest_deg == pytest.approx(45.0, abs=1.0)
