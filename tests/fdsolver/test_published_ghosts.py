"""The ghost nodes of the published scheme against closed forms: growth of waves, moment-free edges, corners, clamps."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fdsolver import meshes
from fdsolver.effects import build_force
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER
from fdsolver.published_force import PublishedForce, build_published

SHEET = Sheet(young_MPa=1.0, poisson=0.5, thickness_mm=0.5)
WIDE, SMALL = 2000, 1e-9


def published(grid: Grid, variant: str, sheet: Sheet = SHEET, **edges: str) -> PublishedForce:
    return build_published(grid, sheet, edges, build_force(grid, sheet, KOITER, edges), variant)


def flat(grid: Grid, force: PublishedForce, z: np.ndarray | float = 0.0) -> np.ndarray:
    """The flat sheet with heights z (ni, nj), scaled, as a state with ghosts."""
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    place = np.pad(np.stack([x, y, z + 0.0 * x]), ((0, 0), (1, 1), (1, 1)))
    force.ghosts.place(place)
    return place


def follow(force: PublishedForce, place: np.ndarray, steps: int) -> None:
    """Steps of the ghosts beside a sheet at rest."""
    f, rest = np.empty_like(place), np.zeros_like(place)
    for _ in range(steps):
        force(place, f)
        force.follow(place, rest)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("variant", ["printed", "filtered"])
@pytest.mark.parametrize("wave", [0.2, 0.5, 1.0])
def test_a_wave_of_ghost_offsets_grows_or_decays_as_derived(variant: str, wave: float, ratio: float) -> None:
    """One step: 1 - rate (cos^2(k/2) - nu s sin^2(k/2)), and, filtered, times 1 - sin^4(k/2)."""
    grid = meshes.rectangle(60.0, 60.0, WIDE, cell_ratio=ratio)
    force = published(grid, variant)
    intervals = grid.nj - 1
    k = math.pi * round(wave * intervals) / intervals
    shape = SMALL * np.cos(k * np.arange(grid.nj))
    place = flat(grid, force)
    place[2, 0, 1:-1] = shape
    follow(force, place, 1)
    s = (np.diff(grid.u[:, 0, 0])[0] / np.diff(grid.u[0, :, 1])[0]) ** 2
    growth = max(SHEET.poisson * s, 1.0)
    rate = 0.5 / (growth if variant == "printed" else growth**2)
    sine, cosine = math.sin(k / 2) ** 2, math.cos(k / 2) ** 2
    expected = 1.0 - rate * (cosine - SHEET.poisson * s * sine)
    if variant == "filtered":
        expected *= 1.0 - sine**2
        assert abs(expected) < 1.0, "a filtered line decays at every wave"
    elif wave == 1.0:
        assert expected > 1.0, "the shortest wave of a printed line grows"
    inner = slice(3, -3)  # the corner ghosts have rules of their own
    found = place[2, 0, 1:-1]
    np.testing.assert_allclose(found[inner], expected * shape[inner], rtol=0, atol=1e-9 * SMALL)


@pytest.mark.parametrize("variant", ["filtered", "stabilised"])
def test_a_bent_strip_curves_across_its_free_edges_so_that_no_moment_is_left(variant: str) -> None:
    """Cylindrical bending z = curvature y^2 / 2: b_11 = -nu curvature at the edges x = const, M_11 = 0."""
    grid = meshes.rectangle(60.0, 40.0, 1500)
    force = published(grid, variant)
    curvature = 1e-5
    y = grid.u[..., 1] / grid.length_mm
    place = flat(grid, force, 0.5 * curvature * y**2)
    follow(force, place, 60)
    spacing = np.diff(grid.u[:, 0, 0])[0] / grid.length_mm
    offset = place[2, 0] - 2.0 * place[2, 1] + place[2, 2]
    inner = slice(9, -9)
    # the two other edges are not in equilibrium: what they do to the corners decays to this along the line
    np.testing.assert_allclose(offset[inner], -SHEET.poisson * curvature * spacing**2, rtol=1e-3)
    f = np.empty_like(place)
    force(place, f)
    across, along = force.row_edges[:, 3, inner], force.column_edges[:, 3, inner]
    stiffness = force.bending / (1.0 - SHEET.poisson**2)
    assert np.abs(across).max() < 1e-3 * stiffness * curvature
    assert np.abs(along).max() < 1e-3 * stiffness * curvature, (
        "the other two edges are free of moment as well"
    )


def test_corner_ghosts_continue_the_twist() -> None:
    grid = meshes.rectangle(60.0, 40.0, 1500, bias=0.8)
    force = published(grid, "filtered")
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    place = flat(grid, force, 1e-6 * x * y)
    f = np.empty_like(place)
    force(place, f)
    twist = force.bending / (1.0 + SHEET.poisson) * 1e-6
    for edges in (force.row_edges, force.column_edges):
        np.testing.assert_allclose(edges[:, 6, 1:-1], twist, rtol=1e-9)


def test_a_clamped_edge_has_no_slope_across_it_and_a_ghost_layer_that_mirrors_the_sheet() -> None:
    grid = meshes.rectangle(60.0, 40.0, 1500)
    force = published(grid, "filtered", left="clamped", top="clamped")
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    place = flat(grid, force, 1e-3 * (x - x[0, 0]) ** 2 * (y - y[0, -1]) ** 2)
    follow(force, place, 3)
    np.testing.assert_array_equal(place[2, 0], place[2, 2])
    np.testing.assert_array_equal(place[2, 1:, -1], place[2, 1:, -3])
    np.testing.assert_allclose(force.row_edges[0, 2, 1:-1], 1.0, atol=1e-12)


def test_ghosts_follow_a_sheet_that_moves_as_a_whole() -> None:
    """n . v of (74) carries them along; nothing is left for the moment to do."""
    grid = meshes.rectangle(60.0, 40.0, 1500)
    force = published(grid, "filtered")
    place = flat(grid, force)
    f, speed = np.empty_like(place), np.zeros_like(place)
    force(place, f)
    speed[:, 1:-1, 1:-1] = np.array([1e-4, -2e-4, 3e-4])[:, None, None]
    moved = place + speed
    force.follow(moved, speed)
    expected = place + np.array([1e-4, -2e-4, 3e-4])[:, None, None]
    np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-15)


def test_a_ghost_row_that_zigzags_costs_more_energy_than_any_sheet_has() -> None:
    grid = meshes.rectangle(60.0, 40.0, 1500)
    force = published(grid, "printed")
    place = flat(grid, force)
    f = np.empty_like(place)
    assert force(place, f).sum() < 1e-20
    spacing = np.diff(grid.u[:, 0, 0])[0] / grid.length_mm
    zigzag = (-1.0) ** np.arange(grid.nj)
    place[2, -1, 1:-1] = 0.4 * spacing * zigzag
    assert force(place, f).sum() < 1.0
    assert force.ghosts.roughness(place)[1] == pytest.approx(0.4, rel=1e-12)
    place[2, -1, 1:-1] = 0.6 * spacing * zigzag
    assert force(place, f).sum() > 1e5
