"""The mesh type: areas, quality figures and what it refuses."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable

import numpy as np
import pytest

from fdsolver.grid import Grid, GridError, quality, zone_corners
from fdsolver.meshes import annulus, rectangle, rectangle_with_hole

# Sums of some thousand numbers of one sign, each rounded to 1e-16.
ROUNDING = 1e-13


def open_grid(u: np.ndarray) -> Grid:
    ni, nj = u.shape[:2]
    bottom = np.stack([np.arange(ni), np.zeros(ni, dtype=np.int64)], axis=-1)
    return Grid("rectangle", u, False, {"bottom": bottom}, np.linspace(0, 1, ni), np.linspace(0, 1, nj), 1.0)


def lattice(ni: int, nj: int) -> np.ndarray:
    x, y = np.meshgrid(np.arange(float(ni)), np.arange(float(nj)), indexing="ij")
    return np.stack([x, y], axis=-1)


def shoelace(polygon: np.ndarray) -> float:
    """Area of a polygon (m, 2), positive counter-clockwise."""
    x, y = polygon.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def test_zone_area_is_that_of_the_polygon_of_its_corners():
    u = lattice(6, 5) + np.random.default_rng(4).uniform(-0.2, 0.2, (6, 5, 2))
    grid = open_grid(u)
    for i, j in np.ndindex(5, 4):
        corners = np.array([u[i, j], u[i + 1, j], u[i + 1, j + 1], u[i, j + 1]])
        assert grid.zone_area[i, j] == pytest.approx(shoelace(corners), rel=ROUNDING)


def test_closed_mesh_has_a_zone_between_its_last_and_first_row():
    grid = annulus(10.0, 20.0, 500)
    last = grid.u[[-1, 0, 0, -1], [0, 0, 1, 1]]
    assert grid.zone_area.shape == (grid.ni, grid.nj - 1)
    assert grid.zones == grid.zone_area.size
    assert grid.zone_area[-1, 0] == pytest.approx(shoelace(last), rel=ROUNDING)


def test_node_area_on_a_uniform_rectangle_is_the_cell_and_its_half_and_quarter_at_the_edge():
    area = open_grid(lattice(4, 3)).node_area
    assert area.tolist() == [[0.25, 0.5, 0.25], [0.5, 1.0, 0.5], [0.5, 1.0, 0.5], [0.25, 0.5, 0.25]]


def test_node_area_of_a_closed_mesh_gathers_the_four_zones_round_a_node():
    grid = rectangle_with_hole(50.0, 125.0, 15.0, 600)
    z = grid.zone_area
    assert grid.node_area[0, 3] == pytest.approx((z[0, 2] + z[0, 3] + z[-1, 2] + z[-1, 3]) / 4, rel=ROUNDING)
    assert grid.node_area[5, 0] == pytest.approx((z[4, 0] + z[5, 0]) / 4, rel=ROUNDING)


@pytest.mark.parametrize(
    ("grid", "area"),
    [
        (rectangle(101.6, 254.0, 3000, bias=2.0), 101.6 * 254.0),
        # An n-gon inscribed in a circle of radius R has the area n R^2 sin(2 pi / n) / 2.
        (annulus(62.5, 250.0, 3000), lambda n: 0.5 * n * np.sin(2 * np.pi / n) * (250.0**2 - 62.5**2)),
    ],
    ids=["rectangle", "annulus"],
)
def test_areas_of_zones_and_of_nodes_sum_to_the_sheet(grid: Grid, area: float | Callable[[int], float]):
    expected = area(grid.ni) if callable(area) else area
    assert grid.zone_area.sum() == pytest.approx(expected, rel=ROUNDING)
    assert grid.node_area.sum() == pytest.approx(expected, rel=ROUNDING)


def test_areas_of_the_plate_with_a_hole_sum_to_rectangle_less_polygon():
    grid = rectangle_with_hole(50.0, 125.0, 15.0, 3000)
    hole = shoelace(grid.u[::-1, 0])  # i runs clockwise
    assert grid.zone_area.sum() == pytest.approx(50.0 * 125.0 - hole, rel=ROUNDING)
    assert grid.node_area.sum() == pytest.approx(50.0 * 125.0 - hole, rel=ROUNDING)


def test_areas_are_computed_once():
    grid = rectangle(10.0, 10.0, 400)
    assert grid.zone_area is grid.zone_area
    assert grid.node_area is grid.node_area


def test_zone_corners_run_round_the_zone():
    u = lattice(3, 4)
    a, b, c, d = zone_corners(u, closed=False)
    assert [x[1, 2].tolist() for x in (a, b, c, d)] == [[1, 2], [2, 2], [2, 3], [1, 3]]


def test_quality_of_a_sheared_lattice():
    # Edges (3, 0) and (1, 1): angles of 45 and 135 degrees, lengths 3 and sqrt 2, area 3. The first column of
    # zones has (2, 2) instead of (1, 1): closer to squares, and larger.
    u = lattice(4, 5)
    u[:, 0, 1] = -1.0
    u = u @ np.array([[3.0, 0.0], [1.0, 1.0]])
    figures = quality(open_grid(np.ascontiguousarray(u)))
    assert figures.smallest_angle_deg == pytest.approx(45.0, rel=ROUNDING)
    assert figures.largest_aspect == pytest.approx(3.0 / np.sqrt(2.0), rel=ROUNDING)
    assert figures.smallest_zone_area_mm2 == pytest.approx(3.0, rel=ROUNDING)


def test_quality_shows_a_folded_corner_as_a_negative_angle():
    u = lattice(3, 3)
    u[1, 1] = (0.3, 0.3)  # beyond the diagonal of zone (0, 0), whose area stays positive: 0.3
    figures = quality(open_grid(u))
    assert figures.smallest_zone_area_mm2 == pytest.approx(0.3, rel=ROUNDING)
    assert figures.smallest_angle_deg < 0.0


def test_refuses_a_zone_turned_inside_out_naming_it():
    u = lattice(5, 4)
    u[3, 2] = (0.5, 2.0)
    with pytest.raises(GridError, match=re.escape("zone (2, 1) at (1.875, 1.5) mm has the area -0.25 mm^2")):
        open_grid(u)


def test_refuses_a_zone_without_area():
    u = lattice(4, 4)
    u[:, 2] = u[:, 1]
    with pytest.raises(
        GridError, match=r"zone \(0, 1\) .* has the area 0 mm\^2; .* \(3 of 9 zones are not\)"
    ):
        open_grid(u)


def test_refuses_a_closed_mesh_that_runs_the_wrong_way_round():
    grid = annulus(10.0, 20.0, 400)
    with pytest.raises(GridError, match=rf"zone \(0, 0\) .* \({grid.zones} of {grid.zones} zones are not\)"):
        dataclasses.replace(grid, u=grid.u[::-1].copy())


def test_refuses_an_inverted_zone_across_the_seam_of_a_closed_mesh():
    grid = annulus(10.0, 20.0, 400)
    u = grid.u.copy()
    u[-1, 4:6] = u[1, 4:6]  # the last row beyond the first: its own zone, across the seam, turns over
    with pytest.raises(GridError, match=rf"zone \({grid.ni - 1}, "):
        dataclasses.replace(grid, u=u)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_refuses_a_position_that_is_not_finite_naming_the_node(value: float):
    u = lattice(5, 4)
    u[3, 1, 0] = value
    with pytest.raises(
        GridError, match=rf"node \(3, 1\) has the position \({value}, 1.0\), which is not finite"
    ):
        open_grid(u)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"u": lattice(4, 4)[..., 0]}, "shape"),
        ({"u": lattice(4, 4).astype(np.float32)}, "float64"),
        ({"u": np.asfortranarray(lattice(4, 4))}, "C-contiguous"),
        ({"u": lattice(1, 4)}, "at least 2 rows"),
        ({"u": lattice(2, 4), "closed": True}, "at least 3 rows"),
        ({"xi": np.linspace(0, 1, 5)}, r"xi must have the shape \(4,\)"),
        ({"eta": np.array([0.0, 0.5, 0.5, 1.0])}, "eta must rise"),
        ({"eta": np.array([0.0, np.nan, 0.5, 1.0])}, "eta must rise"),
        ({"edges": {"top": np.array([[0, 4]])}}, "edge top names a node outside the mesh of 4 x 4 nodes"),
        ({"edges": {"top": np.array([[0.0, 3.0]])}}, "edge top must be an int64 array"),
        ({"length_mm": 0.0}, "length_mm must be positive"),
        ({"length_mm": np.inf}, "length_mm must be positive"),
        ({"length_mm": np.nan}, "length_mm must be positive"),
        ({"breaks": (1.5,)}, "breaks must lie between 0 and 1"),
    ],
    ids=lambda value: value if isinstance(value, str) else None,
)
def test_refuses_arrays_that_do_not_fit(change: dict[str, object], message: str):
    good = open_grid(lattice(4, 4))
    with pytest.raises(GridError, match=message):
        dataclasses.replace(good, **change)


def test_refuses_a_closed_direction_that_repeats_its_first_row():
    grid = annulus(10.0, 20.0, 400)
    with pytest.raises(GridError, match="xi must stay below 1"):
        dataclasses.replace(grid, xi=np.linspace(0.0, 1.0, grid.ni))
