"""The mesh round a hole: corners, sides, straight lines."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver.meshes import rectangle_with_hole

# Positions are a few roundings of 1e-16 away from their formula.
ROUNDING = 1e-14

HOLED = [(50.0, 125.0, 15.0), (100.0, 100.0, 25.0), (300.0, 70.0, 30.0)]


@pytest.mark.parametrize(("width", "height", "hole"), HOLED)
@pytest.mark.parametrize(("nodes", "bias"), [(400, 1.0), (437, 0.7), (5000, 0.3)])
def test_edges_of_the_plate_with_a_hole(width: float, height: float, hole: float, nodes: int, bias: float):
    grid = rectangle_with_hole(width, height, hole, nodes, bias=bias)
    assert grid.length_mm == max(width, height)
    i, j = grid.edges["hole"].T
    np.testing.assert_allclose(np.hypot(*grid.u[i, j].T), hole, rtol=ROUNDING)
    ends = {
        "right": ((1, 1), (1, -1)),
        "bottom": ((1, -1), (-1, -1)),
        "left": ((-1, -1), (-1, 1)),
        "top": ((-1, 1), (1, 1)),
    }
    for name, (first, last) in ends.items():
        i, j = grid.edges[name].T
        assert (j == grid.nj - 1).all()
        line = grid.u[i, j]
        assert line[0].tolist() == [0.5 * width * first[0], 0.5 * height * first[1]]
        assert line[-1].tolist() == [0.5 * width * last[0], 0.5 * height * last[1]]
        axis = 0 if name in ("left", "right") else 1
        assert (line[:, axis] == line[0, axis]).all()
        step = np.diff(line[:, 1 - axis])
        assert (step > 0.0).all() or (step < 0.0).all()
    sides = sum(len(grid.edges[name]) for name in ends)
    assert sides == grid.ni + 4  # every outer node, the corners twice


@pytest.mark.parametrize(("width", "height", "hole"), HOLED)
def test_lines_of_the_plate_with_a_hole_are_straight(width: float, height: float, hole: float):
    u = rectangle_with_hole(width, height, hole, 2000, bias=0.7).u
    along = u[:, -1:] - u[:, :1]
    off = along[..., 0] * (u - u[:, :1])[..., 1] - along[..., 1] * (u - u[:, :1])[..., 0]
    assert np.abs(off).max() < ROUNDING * max(width, height) ** 2


@pytest.mark.parametrize(("width", "height", "hole"), HOLED)
def test_corner_rays_leave_the_circle_at_the_corners_angle(width: float, height: float, hole: float):
    grid = rectangle_with_hole(width, height, hole, 2000)
    row = round(grid.breaks[0] * grid.ni)
    assert grid.xi[row] == pytest.approx(grid.breaks[0], rel=ROUNDING)
    corner = np.array([width, -height]) / np.hypot(width, height)
    np.testing.assert_allclose(grid.u[row, 0], hole * corner, rtol=ROUNDING)
