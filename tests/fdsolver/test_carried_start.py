"""Starting from another state of the same sheet: on another mesh, at another load."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fdsolver import meshes
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid, GridError
from fdsolver.material import Sheet
from fdsolver.model import KOITER
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.relax import Settings
from fdsolver.result import Status
from fdsolver.start import carried_start, fixed_nodes, smooth_start

HOLD = EdgeCondition("pinned")


def strip(nodes: int) -> Grid:
    return meshes.rectangle(20.0, 8.0, nodes)


def pulled(by: float) -> dict[str, EdgeCondition]:
    return {"left": HOLD, "right": EdgeCondition("pinned", move_mm=(by, 0.0, 0.0))}


def test_a_state_on_another_mesh_is_interpolated() -> None:
    """z = sin(x) sin(y / 2): cubic splines of a mesh of 0.2 mm, so an error of about 0.2^4 / 100."""
    coarse, fine = strip(4000), strip(9000)

    def shape(u: np.ndarray) -> np.ndarray:
        z = np.sin(u[..., 0]) * np.sin(0.5 * u[..., 1])
        return np.stack([1.1 * u[..., 0] + 1.0, u[..., 1], z], axis=-1)

    carried = carried_start(fine, {}, coarse, shape(coarse.u))
    np.testing.assert_allclose(carried, shape(fine.u), rtol=0.0, atol=1e-4)


def test_edges_are_where_the_new_load_wants_them_and_an_affine_state_stays_affine() -> None:
    """From a pull of 2 mm to one of 3 mm: the uniform start at 2 mm is carried to the uniform start at 3 mm."""
    coarse, fine = strip(500), strip(1500)
    carried = carried_start(fine, pulled(3.0), coarse, smooth_start(coarse, pulled(2.0)))
    np.testing.assert_allclose(carried, smooth_start(fine, pulled(3.0)), rtol=0.0, atol=1e-9)
    fixed = fixed_nodes(fine, pulled(3.0))
    assert fixed.any() and not fixed.all()
    np.testing.assert_array_equal(carried[fixed, 2], 0.0)


@pytest.mark.parametrize(
    "other",
    [meshes.rectangle(20.0, 9.0, 500), meshes.annulus(5.0, 10.0, 500), meshes.rectangle(8.0, 20.0, 500)],
)
def test_another_sheet_is_refused(other: Grid) -> None:
    r = np.concatenate([other.u, np.zeros((other.ni, other.nj, 1))], axis=-1)
    with pytest.raises(GridError, match="the start is a"):
        carried_start(strip(500), pulled(1.0), other, r)


def test_a_run_from_its_own_result_is_over_at_once_and_one_from_a_neighbour_soon() -> None:
    """An arch under compression: from its own state no step is needed, on the one mesh unless levels are asked for."""
    sheet = Sheet(young_MPa=3500.0, poisson=0.0, thickness_mm=0.5)
    settings = Settings(tolerance=1e-6)
    grid = strip(2000)
    cold = Problem(sheet, pulled(-0.1), grid, strip)
    first = solve(cold, KOITER, settings)
    assert first.status is Status.CONVERGED and np.abs(first.r[..., 2]).max() > 0.5
    own = replace(cold, perturbation=0.0, initial=(first.grid, first.r))
    again = solve(own, KOITER, settings)
    assert again.steps == 0 and len(again.levels) == 1
    # positions pass through lengths L and splines at their own knots: rounding only
    np.testing.assert_allclose(again.r, first.r, rtol=0.0, atol=1e-12)
    neighbour = replace(cold, edges=pulled(-0.12), perturbation=0.0, initial=(first.grid, first.r))
    warm = solve(neighbour, KOITER, settings)
    assert warm.status is Status.CONVERGED
    # the arch keeps its side
    assert np.sum(warm.r[..., 2] * first.r[..., 2]) > 0.0
    alone = solve(replace(cold, edges=pulled(-0.12)), KOITER, replace(settings, levels=1))
    assert warm.steps < alone.steps
    assert warm.energy_N_mm["total"] == pytest.approx(alone.energy_N_mm["total"], rel=1e-4)
