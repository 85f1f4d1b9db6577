"""Unrelaxed membranes keep the axisymmetric state, although it is unstable."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver.axisymmetry import is_axisymmetric, mean_round
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.meshes import annulus, rectangle
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.relax import Settings
from fdsolver.result import Status

SHEET = Sheet(3500.0, 0.31, 0.025)
TWIST = {"inner": EdgeCondition("pinned", (0.0, 0.0, 125.0), 90.0), "outer": EdgeCondition("pinned")}


def ring(nodes: int) -> Grid:
    return annulus(62.5, 250.0, nodes)


def problem(grid: Grid, edges: dict[str, EdgeCondition]) -> Problem:
    return Problem(SHEET, edges, grid, ring)


def asymmetry(grid: Grid, r: np.ndarray) -> float:
    scaled = np.moveaxis(r, -1, 0) / grid.length_mm
    return float(np.abs(scaled - mean_round(grid, scaled)).max())


def test_the_mean_keeps_rigid_and_radial_fields() -> None:
    grid = ring(600)
    x, y = grid.u[..., 0], grid.u[..., 1]
    for field in ((x, y, 0.0 * x), (-y, x, 0.0 * x), (0.0 * x, 0.0 * x, np.hypot(x, y))):
        stacked = np.stack(field)
        np.testing.assert_allclose(
            mean_round(grid, stacked), stacked, rtol=0, atol=1e-12 * np.abs(stacked).max()
        )


def test_the_mean_removes_what_goes_round() -> None:
    grid = ring(600)
    wave = np.cos(3.0 * np.arctan2(grid.u[..., 1], grid.u[..., 0]))
    sideways = np.stack([np.ones_like(wave), 0.0 * wave, wave])
    np.testing.assert_allclose(mean_round(grid, sideways), 0.0, atol=1e-13)


@pytest.mark.parametrize(
    ("edges", "model", "expected"),
    [
        (TWIST, MEMBRANE, True),
        (TWIST, KOITER, False),
        ({**TWIST, "inner": EdgeCondition("pinned", (1.0, 0.0, 0.0))}, MEMBRANE, False),
    ],
)
def test_which_problems_are_axisymmetric(
    edges: dict[str, EdgeCondition], model: Model, expected: bool
) -> None:
    assert is_axisymmetric(problem(ring(600), edges), model) is expected


def test_a_rectangle_is_not_axisymmetric() -> None:
    grid = rectangle(10.0, 10.0, 400)
    pulled = {"left": EdgeCondition("pinned"), "right": EdgeCondition("pinned")}
    assert not is_axisymmetric(Problem(SHEET, pulled, grid, lambda nodes: grid), MEMBRANE)


def test_the_membrane_stays_axisymmetric_and_is_called_unstable() -> None:
    grid = ring(1250)
    solution = solve(problem(grid, TWIST), MEMBRANE, Settings(tolerance=1e-8))
    assert solution.status is Status.CONVERGED
    assert asymmetry(grid, solution.r) < 1e-10  # rounding of some thousand steps
    assert solution.stability["stable"] is False
    assert solution.zone.stress_minor.min() < 0.0
