"""Interpolation between meshes of one shape."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest

from fdsolver.grid import Grid, GridError
from fdsolver.meshes import annulus, rectangle, rectangle_with_hole
from fdsolver.transfer import prolong

SHAPES: dict[str, Callable[[int], Grid]] = {
    "rectangle": lambda nodes: rectangle(100.0, 60.0, nodes, bias=1.5),
    "annulus": lambda nodes: annulus(62.5, 250.0, nodes),
    "hole": lambda nodes: rectangle_with_hole(50.0, 125.0, 15.0, nodes),
}
shapes = pytest.mark.parametrize("make", SHAPES.values(), ids=SHAPES.keys())
# Splines solve small well-conditioned systems: some tens of roundings of values of about one.
ROUNDING = 1e-13


def logical(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    return grid.xi[:, None], grid.eta[None, :]


@shapes
def test_constants_are_exact(make: Callable[[int], Grid]):
    coarse, fine = make(500), make(2100)
    field = np.broadcast_to([1.0, -2.5, 7.0], (coarse.ni, coarse.nj, 3))
    result = prolong(field, coarse, fine)
    assert result.shape == (fine.ni, fine.nj, 3)
    np.testing.assert_allclose(result, np.broadcast_to([1.0, -2.5, 7.0], result.shape), rtol=ROUNDING)


@shapes
def test_the_same_mesh_gives_the_field_back(make: Callable[[int], Grid]):
    grid = make(700)
    field = np.random.default_rng(1).standard_normal((grid.ni, grid.nj, 3))
    np.testing.assert_allclose(prolong(field, grid, grid), field, rtol=0, atol=ROUNDING * np.abs(field).max())


@pytest.mark.parametrize("degrees", [(1, 0), (0, 1), (1, 1), (3, 3)])
def test_cubics_are_exact_on_an_open_mesh(degrees: tuple[int, int]):
    coarse, fine = SHAPES["rectangle"](500), SHAPES["rectangle"](2100)

    def cubic(grid: Grid) -> np.ndarray:
        xi, eta = logical(grid)
        return (xi - 0.3) ** degrees[0] * (eta + 0.2) ** degrees[1] + xi - 2 * eta

    np.testing.assert_allclose(prolong(cubic(coarse), coarse, fine), cubic(fine), rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("make", [SHAPES["annulus"], SHAPES["hole"]], ids=["annulus", "hole"])
def test_cubics_of_eta_are_exact_on_a_closed_mesh(make: Callable[[int], Grid]):
    coarse, fine = make(700), make(2100)
    field = np.broadcast_to(coarse.eta**3 - coarse.eta, (coarse.ni, coarse.nj))
    expected = np.broadcast_to(fine.eta**3 - fine.eta, (fine.ni, fine.nj))
    np.testing.assert_allclose(prolong(field, coarse, fine), expected, rtol=0, atol=ROUNDING)


def test_a_cubic_between_each_two_breaks_is_exact_on_the_hole_mesh():
    """A different cubic on each side, continuous at the corners: kinks there cost nothing."""
    coarse, fine = SHAPES["hole"](700), SHAPES["hole"](2100)

    def field(grid: Grid) -> np.ndarray:
        places = np.append(grid.breaks, grid.breaks[0] + 1.0)
        xi = np.where(grid.xi < places[0] - 1e-12, grid.xi + 1.0, grid.xi)
        value = np.zeros(grid.ni)
        for k, (low, high) in enumerate(zip(places[:-1], places[1:], strict=True)):
            inside = (xi >= low - 1e-12) & (xi <= high + 1e-12)
            t = (xi[inside] - low) / (high - low)
            value[inside] = t * (1 - t) * (k - t)
        return value[:, None] * (1.0 + grid.eta)

    np.testing.assert_allclose(prolong(field(coarse), coarse, fine), field(fine), rtol=0, atol=ROUNDING)


@shapes
def test_error_of_a_smooth_field_is_of_fourth_order(make: Callable[[int], Grid]):
    """An interpolation of second order would put its own kinks, and so bending, into the finer start."""

    def field(grid: Grid) -> np.ndarray:
        x, y = np.moveaxis(grid.u, -1, 0) / grid.length_mm
        return np.sin(5.0 * x + 1.0) * np.cos(4.0 * y)

    fine = make(120000)
    errors = {}
    for nodes in (1500, 6000):
        coarse = make(nodes)
        difference = prolong(field(coarse), coarse, fine) - field(fine)
        errors[coarse.nodes] = float(np.abs(difference).max())
    (n1, e1), (n2, e2) = errors.items()
    # spacing goes as the root of the count; on the coarser annulus higher orders take a few tenths off
    assert math.log(e1 / e2) / math.log(math.sqrt(n2 / n1)) > 3.5
    assert e2 < 1e-4


def test_a_closed_mesh_interpolates_periodically():
    coarse, fine = SHAPES["annulus"](2000), SHAPES["annulus"](9000)
    result = prolong(np.sin(2 * np.pi * logical(coarse)[0] + 0.4) + 0 * coarse.eta, coarse, fine)
    error = np.abs(result - np.sin(2 * np.pi * logical(fine)[0] + 0.4)).max(axis=1)
    # (2 pi / ni)^4 / 384 is the error of a cubic spline of a sine; the seam is no worse than the rest
    limit = (2 * np.pi / coarse.ni) ** 4 / 384.0
    assert error.max() < 1.1 * limit
    assert error[[0, 1, -2, -1]].max() < 1.1 * limit


@pytest.mark.parametrize("make", [SHAPES["annulus"], SHAPES["hole"]], ids=["annulus", "hole"])
def test_turning_the_field_by_half_a_turn_turns_the_result(make: Callable[[int], Grid]):
    coarse, fine = make(700), make(2100)
    field = np.random.default_rng(2).standard_normal((coarse.ni, coarse.nj))
    turned = prolong(np.roll(field, coarse.ni // 2, axis=0), coarse, fine)
    expected = np.roll(prolong(field, coarse, fine), fine.ni // 2, axis=0)
    np.testing.assert_allclose(turned, expected, rtol=0, atol=10 * ROUNDING)


def test_kinks_at_the_corner_rays_do_not_overshoot():
    """Positions have the kinks of the map: in pieces they stay on the sheet, else they leave it."""
    coarse, fine = SHAPES["hole"](700), SHAPES["hole"](20000)
    cut = prolong(coarse.u, coarse, fine)
    through = prolong(coarse.u, dataclasses.replace(coarse, breaks=()), dataclasses.replace(fine, breaks=()))
    outside = {name: np.abs(u / (25.0, 62.5)).max() - 1.0 for name, u in (("cut", cut), ("through", through))}
    assert outside["cut"] < 1e-12
    assert outside["through"] > 1e-3


def test_a_mesh_with_three_columns_interpolates_parabolas_across():
    coarse, fine = annulus(225.0, 250.0, 400), annulus(225.0, 250.0, 3000)
    assert coarse.nj == 3
    field = np.broadcast_to((coarse.eta - 0.3) ** 2, (coarse.ni, coarse.nj))
    expected = np.broadcast_to((fine.eta - 0.3) ** 2, (fine.ni, fine.nj))
    np.testing.assert_allclose(prolong(field, coarse, fine), expected, rtol=0, atol=ROUNDING)


def test_refuses_meshes_of_different_shapes():
    coarse, fine = SHAPES["annulus"](500), SHAPES["hole"](500)
    with pytest.raises(GridError, match="shape annulus .* cannot go to one of shape rectangle-with-hole"):
        prolong(np.zeros((coarse.ni, coarse.nj, 3)), coarse, fine)


def test_refuses_a_field_that_does_not_fit():
    coarse, fine = SHAPES["annulus"](500), SHAPES["annulus"](900)
    with pytest.raises(GridError, match="the field has the shape"):
        prolong(np.zeros((fine.ni, fine.nj, 3)), coarse, fine)


def test_refuses_breaks_between_rows():
    coarse, fine = (dataclasses.replace(SHAPES["annulus"](nodes), breaks=(0.2501,)) for nodes in (500, 900))
    with pytest.raises(GridError, match=r"no row of nodes at its break xi = 0\.2501"):
        prolong(np.zeros((coarse.ni, coarse.nj)), coarse, fine)
