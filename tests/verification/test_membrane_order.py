"""Small in-plane displacements against exact plane-stress solutions: second order on all meshes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import convolve2d

from fdsolver import meshes
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE
from tests.linear import edge_nodes, solve, stiffness

SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=0.5)
NU = SHEET.poisson
NODES = (500, 2000, 8000)
LEAST_ORDER = 1.8
HALF_WIDTH, HALF_HEIGHT = 0.5, 0.2
MODELS = {"membrane": MEMBRANE, "koiter": KOITER}  # the second has the hourglass stiffness

MESHES: dict[str, Callable[[int], Grid]] = {
    "uniform": lambda nodes: meshes.rectangle(20.0, 8.0, nodes),
    "graded": lambda nodes: meshes.rectangle(20.0, 8.0, nodes, bias=1.5),
    "annulus": lambda nodes: meshes.annulus(60.0, 250.0, nodes),
    "hole": lambda nodes: meshes.rectangle_with_hole(125.0, 50.0, 15.0, nodes),
}


def circle(radius: float) -> np.ndarray:
    """x^2 + y^2 - radius^2 as coefficients c[m, n] of x^m y^n."""
    return np.array([[-(radius**2), 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])


def displacement(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Polynomials (u, v), zero at every edge."""
    box = np.outer([1.0, 0.0, -1.0 / HALF_WIDTH**2], [1.0, 0.0, -1.0 / HALF_HEIGHT**2])
    if name == "annulus":
        edge = convolve2d(circle(0.24), -circle(1.0))
    else:
        edge = convolve2d(circle(15.0 / 125.0), box) if name == "hole" else box
    tilted = np.array([[0.3, 1.0], [-2.0, 0.0]])  # 0.3 + y - 2 x
    return convolve2d(edge, np.array([[1.0, 0.0], [0.5, 0.0]])), convolve2d(edge, tilted)


def derivative(c: np.ndarray, along_x: int, along_y: int) -> np.ndarray:
    """Derivative of a polynomial, of the same array shape."""
    for axis, times in ((0, along_x), (1, along_y)):
        for _ in range(times):
            lower = np.polynomial.polynomial.polyder(c, axis=axis)
            c = np.pad(lower, [(0, c.shape[k] - lower.shape[k]) for k in range(2)])
    return c


def body_force(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """-div S of plane stress per Y, as polynomials."""
    direct, shear = 1 / (1 - NU**2), 1 / (2 * (1 + NU))
    f_x = direct * (derivative(u, 2, 0) + NU * derivative(v, 1, 1)) + shear * (
        derivative(u, 0, 2) + derivative(v, 1, 1)
    )
    f_y = direct * (derivative(v, 0, 2) + NU * derivative(u, 1, 1)) + shear * (
        derivative(v, 2, 0) + derivative(u, 1, 1)
    )
    return -f_x, -f_y


def assert_second_order(name: str, errors: list[float], grids: list[Grid]) -> None:
    observed = np.diff(np.log(errors)) / np.diff([-0.5 * np.log(grid.nodes) for grid in grids])
    print(f"{name:28s} errors {np.array(errors)} orders {observed}")
    assert observed[-1] > LEAST_ORDER, f"{name}: errors {errors}"
    assert errors[-1] < 1e-2, f"{name}: errors {errors}"


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", MESHES)
def test_manufactured_displacements(name: str, model: str) -> None:
    """All edges held, a body force inside; kinks (corner rays) apart."""
    fields = displacement(name)
    loads = body_force(*fields)
    grids = [MESHES[name](nodes) for nodes in NODES]
    off, on = [], []
    for grid in grids:
        x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
        exact, load = (
            np.stack([np.polynomial.polynomial.polyval2d(x, y, c) for c in pair]) for pair in (fields, loads)
        )
        matrix = stiffness(grid, SHEET, MODELS[model], {}, axes=(0, 1))
        area = grid.node_area / grid.length_mm**2
        found = solve(matrix, area * load, edge_nodes(grid, tuple(grid.edges)))
        error = np.abs(found - exact).max(axis=0) / np.abs(exact).max()
        kink = np.any(np.abs(grid.xi[:, None] - np.array(grid.breaks)) < 1e-9, axis=1)
        off.append(error[~kink].max())
        on.append(error[kink].max(initial=0.0))
    assert_second_order(f"{model}, {name}", off, grids)
    if grids[0].breaks:
        assert_second_order(f"{model}, {name}, on kinks", on, grids)


@pytest.mark.parametrize("model", MODELS)
def test_annulus_pulled_at_its_inner_edge(model: str) -> None:
    """Lame: u = A R + B / R, u = 1 inside and no radial stress at the free outer edge.

    The bare membrane is exact at the nodes of this geometrically graded mesh; the hourglass stiffness is not.
    """
    inner = 0.24
    a, b = np.linalg.solve([[inner, 1 / inner], [1 + NU, -(1 - NU)]], [1.0, 0.0])
    grids, errors = [MESHES["annulus"](nodes) for nodes in NODES], []
    for grid in grids:
        place = np.moveaxis(grid.u / grid.length_mm, 2, 0)
        radius = np.hypot(*place)
        exact = place * (a + b / radius**2)
        fixed = edge_nodes(grid, ("inner",))
        matrix = stiffness(grid, SHEET, MODELS[model], {}, axes=(0, 1))
        given = np.where(fixed, exact, 0.0)
        found = given + solve(matrix, -(matrix @ given.ravel()).reshape(given.shape), fixed)
        errors.append(np.abs(found - exact).max())
    if model == "membrane":
        assert max(errors) < 1e-8  # rounding of the differences behind the stiffness, 1e-9
    else:
        assert_second_order(f"{model}, free annulus", errors, grids)
