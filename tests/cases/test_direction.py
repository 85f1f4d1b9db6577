"""Directions of made wrinkles on every kind of mesh, clean and noisy."""

from __future__ import annotations

import numpy as np
import pytest

from cases.direction import LEAST_SLOPE, mean_crest_deg, wrinkle_direction, zone_slopes
from cases.lattice import zone_centres
from fdsolver import meshes
from fdsolver.grid import Grid

WAVE = 6.0
MESHES = {
    "uniform": meshes.rectangle(60.0, 40.0, 9000, bias=0.0),
    "biased": meshes.rectangle(60.0, 40.0, 9000, bias=1.0),
    "ring": meshes.annulus(15.0, 40.0, 20000),
}


def waves(grid: Grid, crest_deg: float, height: float = 0.3) -> np.ndarray:
    """Straight parallel wrinkles with crests in this direction."""
    angle = np.radians(crest_deg)
    across = -grid.u[..., 0] * np.sin(angle) + grid.u[..., 1] * np.cos(angle)
    return height * np.sin(2.0 * np.pi * across / WAVE)


def turned(found: np.ndarray, expected: float | np.ndarray) -> np.ndarray:
    """Angle between two directions, degrees, -90 to 90."""
    return np.mod(found - expected + 90.0, 180.0) - 90.0


def away_from_edges(grid: Grid, distance: float) -> np.ndarray:
    centre = zone_centres(grid)
    if grid.shape == "annulus":
        radius = np.linalg.norm(centre, axis=-1)
        return (radius > 15.0 + distance) & (radius < 40.0 - distance)
    return (np.abs(centre[..., 0]) < 30.0 - distance) & (np.abs(centre[..., 1]) < 20.0 - distance)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("crest", [0.0, 30.0, 45.0, 90.0, 135.0, 179.0])
def test_straight_wrinkles_have_their_direction_everywhere(mesh: str, crest: float) -> None:
    grid = MESHES[mesh]
    found = wrinkle_direction(grid, waves(grid, crest), window_mm=WAVE)
    # a coarse zone shortens slopes along x and y by up to (pi / nodes per wave)^2 / 2, unequally: about a degree
    assert np.abs(turned(found.crest_deg, crest))[away_from_edges(grid, WAVE)].max() < 1.5
    assert np.abs(turned(found.crest_deg, crest)).max() < 10.0
    assert found.coherence[away_from_edges(grid, WAVE)].min() > 0.95
    assert abs(turned(mean_crest_deg(found, away_from_edges(grid, WAVE)), crest)) < 0.5
    # rms slope of the sine
    slope = 2.0 * np.pi / WAVE * 0.3 / np.sqrt(2.0)
    assert found.slope[away_from_edges(grid, WAVE)].mean() == pytest.approx(slope, rel=0.05)


def test_radial_wrinkles_follow_the_radius() -> None:
    grid = MESHES["ring"]
    centre = zone_centres(grid)
    angle = np.arctan2(grid.u[..., 1], grid.u[..., 0])
    found = wrinkle_direction(grid, 0.3 * np.sin(24.0 * angle), window_mm=3.0)
    expected = np.degrees(np.arctan2(centre[..., 1], centre[..., 0]))
    assert np.abs(turned(found.crest_deg, expected))[away_from_edges(grid, 3.0)].max() < 2.0


def test_a_tilt_and_a_slow_bow_do_not_turn_the_wrinkles() -> None:
    grid = MESHES["uniform"]
    x, y = grid.u[..., 0], grid.u[..., 1]
    bowed = waves(grid, 45.0) + 0.2 * x - 3.0 * np.cos(np.pi * y / 200.0)
    found = wrinkle_direction(grid, bowed, window_mm=WAVE)
    assert np.abs(turned(found.crest_deg, 45.0))[away_from_edges(grid, WAVE)].max() < 1.5


def test_noise_lowers_the_coherence_but_hardly_turns_the_direction() -> None:
    grid = MESHES["uniform"]
    noise = 0.01 * np.random.default_rng(3).standard_normal((grid.ni, grid.nj))
    inside = away_from_edges(grid, WAVE)
    clean = wrinkle_direction(grid, waves(grid, 60.0), window_mm=WAVE)
    found = wrinkle_direction(grid, waves(grid, 60.0) + noise, window_mm=WAVE)
    # the slope of the noise is 0.03 of the wrinkles'; a window has about 250 zones
    assert np.abs(turned(found.crest_deg, clean.crest_deg))[inside].max() < 2.0
    assert found.coherence[inside].mean() < clean.coherence[inside].mean()
    rough = wrinkle_direction(grid, 30.0 * noise, window_mm=WAVE)
    assert np.median(rough.coherence[inside]) < 0.2


def test_crossed_wrinkles_have_no_direction() -> None:
    grid = MESHES["uniform"]
    found = wrinkle_direction(grid, waves(grid, 45.0) + waves(grid, 135.0), window_mm=WAVE)
    assert np.median(found.coherence[away_from_edges(grid, WAVE)]) < 0.1


def test_where_the_sheet_is_flat_there_is_none() -> None:
    grid = MESHES["uniform"]
    x = grid.u[..., 0]
    z = np.where(x > 0.0, waves(grid, 90.0), 0.0)
    found = wrinkle_direction(grid, z, window_mm=2.0)
    left = zone_centres(grid)[..., 0] < -10.0
    assert np.isnan(found.crest_deg[left]).all() and np.isnan(found.coherence[left]).all()
    assert found.slope[left].max() < LEAST_SLOPE
    assert np.isnan(mean_crest_deg(found, left))
    assert abs(turned(mean_crest_deg(found, np.full(left.shape, True)), 90.0)) < 0.5


def test_directions_are_averaged_across_the_half_turn() -> None:
    grid = MESHES["uniform"]
    y = grid.u[..., 1]
    z = np.where(y > 0.0, waves(grid, 5.0), waves(grid, 175.0))
    found = wrinkle_direction(grid, z, window_mm=WAVE)
    assert abs(turned(mean_crest_deg(found, away_from_edges(grid, WAVE)), 0.0)) < 1.0


@pytest.mark.parametrize("mesh", MESHES)
def test_slopes_of_a_tilted_sheet_are_exact(mesh: str) -> None:
    grid = MESHES[mesh]
    sx, sy = zone_slopes(grid, 0.2 * grid.u[..., 0] - 0.7 * grid.u[..., 1] + 3.0)
    np.testing.assert_allclose(sx, 0.2, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(sy, -0.7, rtol=0.0, atol=1e-12)
