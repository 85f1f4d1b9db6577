"""The three shapes: node counts, edges, symmetry, grading, and one map at every node count."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fdsolver.grid import Grid, GridError, quality
from fdsolver.meshes import annulus, rectangle, rectangle_with_hole

# Positions are a few roundings of 1e-16 away from their formula.
ROUNDING = 1e-14

SHAPES: dict[str, Callable[[int], Grid]] = {
    "square": lambda nodes: rectangle(100.0, 100.0, nodes),
    "strip": lambda nodes: rectangle(101.6, 254.0, nodes, bias=1.5),
    "wide 10:1": lambda nodes: rectangle(1000.0, 100.0, nodes),
    "tall 1:10": lambda nodes: rectangle(100.0, 1000.0, nodes, bias_y=2.0),
    "annulus": lambda nodes: annulus(62.5, 250.0, nodes),
    "annulus, uniform rings": lambda nodes: annulus(62.5, 250.0, nodes, bias=0.0),
    "thin annulus": lambda nodes: annulus(225.0, 250.0, nodes),
    "annulus with a small hole": lambda nodes: annulus(2.5, 250.0, nodes),
    "hole": lambda nodes: rectangle_with_hole(50.0, 125.0, 15.0, nodes),
    "square with a hole": lambda nodes: rectangle_with_hole(100.0, 100.0, 25.0, nodes),
    "square with a pinhole": lambda nodes: rectangle_with_hole(100.0, 100.0, 1.0, nodes),
    "square with a wide hole": lambda nodes: rectangle_with_hole(100.0, 100.0, 48.0, nodes),
    "long plate with a hole": lambda nodes: rectangle_with_hole(400.0, 100.0, 20.0, nodes),
}
shapes = pytest.mark.parametrize("make", SHAPES.values(), ids=SHAPES.keys())


@shapes
@pytest.mark.parametrize("nodes", [400, 401, 419, 450, 999, 5000, 20000, 40000, 120000])
def test_nodes_are_within_five_percent(make: Callable[[int], Grid], nodes: int):
    grid = make(nodes)
    assert abs(grid.nodes / nodes - 1.0) <= 0.05
    assert grid.nodes == grid.u.shape[0] * grid.u.shape[1]


@settings(max_examples=150, deadline=None)
@given(
    nodes=st.integers(400, 6000),
    height=st.floats(0.1, 10.0),
    part=st.floats(0.02, 0.97),
    bias=st.floats(0.0, 2.0),
)
def test_any_shape_and_count_gives_sound_zones_within_five_percent(
    nodes: int, height: float, part: float, bias: float
):
    for grid in (
        rectangle(1.0, height, nodes, bias=bias),
        annulus(part, 1.0, nodes, bias=bias),
        rectangle_with_hole(1.0, height, 0.5 * part * min(1.0, height), nodes, bias=bias),
    ):
        assert abs(grid.nodes / nodes - 1.0) <= 0.05
        assert quality(grid).smallest_angle_deg > 0.0


@shapes
@pytest.mark.parametrize("nodes", [20000, 50000, 120000])
def test_large_meshes_come_closer_to_the_count(make: Callable[[int], Grid], nodes: int):
    # even the thin annulus, 19 columns at 20000 nodes, has pairs of counts within 1 %
    assert abs(make(nodes).nodes / nodes - 1.0) < 0.01


# Limits from the shapes themselves: the coarsest cells of an annulus are trapezia; the odd counts of a square
# differ by two; at the corner of a rectangle with the sides a <= b a cell has the angle atan(a / b), and is
# longer than wide by up to 2 b / a.
@pytest.mark.parametrize(
    ("name", "aspect", "angle"),
    [
        ("square", 1.12, 90.0),
        ("wide 10:1", 1.15, 90.0),
        ("annulus", 1.1, 85.0),
        ("thin annulus", 1.25, 85.0),
        ("annulus with a small hole", 1.1, 82.0),
        ("hole", 5.0, math.degrees(math.atan(50 / 125))),
        ("square with a hole", 2.0, 45.0),
        ("square with a pinhole", 2.0, 45.0),
    ],
)
@pytest.mark.parametrize("nodes", [400, 999, 20000])
def test_cells_are_about_square(name: str, aspect: float, angle: float, nodes: int):
    figures = quality(SHAPES[name](nodes))
    assert figures.largest_aspect < aspect
    assert figures.smallest_angle_deg > angle - 0.1


def test_rectangle_runs_along_x_and_y_and_its_edges_lie_on_its_sides():
    grid = rectangle(30.0, 50.0, 700, bias=1.0)
    assert not grid.closed
    assert grid.length_mm == 30.0
    assert grid.u[0, 0].tolist() == [-15.0, -25.0]
    assert grid.u[-1, -1].tolist() == [15.0, 25.0]
    for name, axis, value in (("left", 0, -15.0), ("right", 0, 15.0), ("bottom", 1, -25.0), ("top", 1, 25.0)):
        i, j = grid.edges[name].T
        assert (grid.u[i, j, axis] == value).all()
        assert (np.diff(grid.u[i, j, 1 - axis]) > 0.0).all()
        assert len(i) == (grid.nj if axis == 0 else grid.ni)


def test_rectangle_has_nodes_on_both_centre_lines():
    grid = rectangle(30.0, 50.0, 700, bias=1.0)
    assert (grid.u[grid.ni // 2, :, 0] == 0.0).all()
    assert (grid.u[:, grid.nj // 2, 1] == 0.0).all()


def test_rectangle_is_uniform_by_default():
    u = rectangle(30.0, 50.0, 700).u
    np.testing.assert_allclose(np.diff(u[:, 0, 0]), 30.0 / (len(u) - 1), rtol=ROUNDING * len(u))


def test_bias_of_the_rectangle_is_the_sinh_map_of_its_direction():
    grid = rectangle(2.0, 2.0, 4000, bias_y=2.0)
    np.testing.assert_allclose(grid.u[:, 0, 0], 2 * grid.xi - 1, rtol=0, atol=ROUNDING)
    expected = np.sinh(2.0 * (2 * grid.eta - 1)) / np.sinh(2.0)
    np.testing.assert_allclose(grid.u[0, :, 1], expected, rtol=0, atol=ROUNDING)
    spacing = np.diff(grid.u[0, :, 1])
    # the half cell between the middle of an interval and the edge: second order in the spacing of 1/30
    assert spacing[0] / spacing[len(spacing) // 2] == pytest.approx(np.cosh(2.0), rel=0.05)


def test_annulus_runs_clockwise_and_outward():
    grid = annulus(62.5, 250.0, 2000)
    assert grid.closed
    assert grid.length_mm == 250.0
    assert grid.u[0, 0].tolist() == [62.5, 0.0]
    assert grid.u[grid.ni // 4, -1].tolist() == [0.0, -250.0]
    radius = np.hypot(grid.u[..., 0], grid.u[..., 1])
    angle = -2 * np.pi * grid.xi
    np.testing.assert_allclose(grid.u[..., 0], radius * np.cos(angle)[:, None], rtol=0, atol=250 * ROUNDING)
    np.testing.assert_allclose(grid.u[..., 1], radius * np.sin(angle)[:, None], rtol=0, atol=250 * ROUNDING)
    for name, column, value in (("inner", 0, 62.5), ("outer", grid.nj - 1, 250.0)):
        assert grid.edges[name].tolist() == [[i, column] for i in range(grid.ni)]
        np.testing.assert_allclose(radius[:, column], value, rtol=ROUNDING)


@pytest.mark.parametrize("bias", [0.0, 0.5, 0.95, 1.0, 2.0])
def test_bias_of_the_annulus_makes_a_power_of_the_radius_linear(bias: float):
    grid = annulus(62.5, 250.0, 2000, bias=bias)
    radius = grid.u[0, :, 0]
    level = np.log(radius) if bias == 1.0 else radius ** (1.0 - bias)
    np.testing.assert_allclose(np.diff(level), (level[-1] - level[0]) / (grid.nj - 1), rtol=1e-10)


def test_bias_is_smooth_through_the_logarithmic_case():
    near, exact = annulus(62.5, 250.0, 2000, bias=1.0 + 2e-6), annulus(62.5, 250.0, 2000)
    np.testing.assert_allclose(near.u, exact.u, rtol=0, atol=250 * 2e-6)


@shapes
@pytest.mark.parametrize("nodes", [400, 3000])
def test_mesh_has_the_mirror_symmetries_of_its_shape_to_the_last_bit(make: Callable[[int], Grid], nodes: int):
    grid = make(nodes)
    u = grid.u
    if grid.closed:
        # row i mirrored in the x axis is row -i, in the y axis row ni/2 - i
        rows = np.arange(grid.ni)
        in_x_axis, in_y_axis = u[-rows % grid.ni], u[(grid.ni // 2 - rows) % grid.ni]
    else:
        in_x_axis, in_y_axis = u[:, ::-1], u[::-1]
    assert np.array_equal(in_x_axis * (1.0, -1.0), u)
    assert np.array_equal(in_y_axis * (-1.0, 1.0), u)


@shapes
def test_meshes_of_two_counts_share_one_map(make: Callable[[int], Grid]):
    """Rows or columns with equal logical coordinates lie in the same places, and the breaks are the same."""
    a, b = make(500), make(4100)
    shared_xi = [
        (i, int(np.abs(b.xi - x).argmin())) for i, x in enumerate(a.xi) if np.abs(b.xi - x).min() < 1e-12
    ]
    shared_eta = [
        (j, int(np.abs(b.eta - x).argmin())) for j, x in enumerate(a.eta) if np.abs(b.eta - x).min() < 1e-12
    ]
    assert len(shared_xi) >= 3
    assert len(shared_eta) >= 2
    ia, ib = np.transpose(shared_xi)
    ja, jb = np.transpose(shared_eta)
    size = np.abs(a.u).max()
    np.testing.assert_allclose(a.u[np.ix_(ia, ja)], b.u[np.ix_(ib, jb)], rtol=0, atol=10 * ROUNDING * size)
    assert a.breaks == b.breaks


@shapes
def test_the_map_is_smooth_between_its_breaks(make: Callable[[int], Grid]):
    """Second differences fall fourfold when both spacings are halved, away from the breaks."""
    figures = []
    for nodes in (5000, 20000):
        grid = make(nodes)
        u = np.concatenate([grid.u, grid.u[:2]]) if grid.closed else grid.u
        second = np.abs(np.diff(u, 2, axis=0)).max(axis=(1, 2))
        middle = grid.xi[0] + (np.arange(len(second)) + 1.0) / (grid.ni if grid.closed else grid.ni - 1)
        near = [np.abs((middle - x + 0.5) % 1.0 - 0.5) for x in grid.breaks]
        away = np.min(near, axis=0) > 1e-9 if near else np.ones(len(second), dtype=bool)
        figures.append((grid.ni, second[away].max() / np.abs(grid.u).max()))
    (rows, coarse), (more, fine) = figures
    if coarse > 1e-12:  # a uniform rectangle has none
        # third differences enter at the next order: a tenth at these counts
        assert math.log(coarse / fine) / math.log(more / rows) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rectangle(0.0, 1.0, 400), "width_mm must be positive and finite, not 0.0"),
        (lambda: rectangle(1.0, math.nan, 400), "height_mm must be positive and finite, not nan"),
        (lambda: rectangle(math.inf, 1.0, 400), "width_mm must be positive and finite, not inf"),
        (lambda: rectangle(10**400, 1.0, 400), "width_mm must be positive and finite"),
        (lambda: rectangle(1.0, 1.0, 99), "nodes must be at least 100, not 99"),
        (lambda: rectangle(1.0, 1.0, 1), "nodes must be at least 100, not 1"),
        (lambda: rectangle(1.0, 1.0, -400), "nodes must be at least 100, not -400"),
        (lambda: rectangle(1.0, 1.0, 10**9), "nodes must be at most 50000000, not 1000000000"),
        (lambda: annulus(1.0, 2.0, 10**400), "nodes must be at most 50000000"),
        (lambda: annulus(1.0, 2.0, math.nan), "nodes must be at most 50000000, not nan"),
        (lambda: annulus(1.0, 2.0, 400.5), "nodes must be a whole number, not 400.5"),
        (lambda: rectangle(1.0, 1.0, 400, bias=-0.1), "bias_x must lie between 0 and 5, not -0.1"),
        (lambda: rectangle(1.0, 1.0, 400, bias_y=6.0), "bias_y must lie between 0 and 5, not 6.0"),
        (lambda: annulus(1.0, 2.0, 400, bias=math.nan), "bias must lie between 0 and 5, not nan"),
        (lambda: annulus(0.0, 2.0, 400), "inner_radius_mm must be positive"),
        (lambda: annulus(2.0, 2.0, 400), "inner_radius_mm 2 must be below outer_radius_mm 2"),
        (
            lambda: rectangle_with_hole(50.0, 125.0, 25.0, 400),
            "hole_radius_mm 25 must be below half the shorter side, 25 mm: the hole is wider than the sheet",
        ),
        (lambda: rectangle_with_hole(50.0, 125.0, 15.0, 10**12), "nodes must be at most 50000000"),
    ],
)
def test_refuses_what_cannot_be_meshed(make: Callable[[], Grid], message: str):
    with pytest.raises(GridError) as refusal:
        make()
    assert str(refusal.value).startswith(message)


def test_refuses_zones_too_small_for_floating_point():
    with pytest.raises(GridError, match=r"zone \(0, 0\) .* has the area 0 mm"):
        rectangle(1e-200, 1e-200, 400)
