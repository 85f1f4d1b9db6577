"""When a sheet counts as at rest: the residual wanted of it, and columns under small loads."""

from __future__ import annotations

import numpy as np
import pytest

from cases import load_scene, run
from fdsolver import meshes
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.relax import Settings
from fdsolver.residual import ROUNDING, USUAL_STRAIN, wanted
from fdsolver.result import Status

CELLS = np.full((11, 21), 20.0)  # weight of nodes a twentieth of the length apart
CELLS[[0, -1]] = 0.0  # two supported edges
AREA = 9 * 21 / 400.0


@pytest.mark.parametrize(
    ("strain", "share"), [(1e-5, 1e-4), (1e-3, 1e-2), (0.05, 0.5), (0.1, 1.0), (0.4, 1.0)]
)
def test_less_is_wanted_in_proportion_to_a_strain_below_a_tenth(strain: float, share: float) -> None:
    assert wanted(1e-6, 0.5 * strain**2 * AREA, CELLS, relaxed=False) == pytest.approx(
        1e-6 * share, rel=1e-12
    )
    assert USUAL_STRAIN == 0.1


def test_no_more_is_wanted_than_rounding_allows() -> None:
    assert wanted(1e-6, 0.0, CELLS, False) == wanted(1e-6, -1e-20, CELLS, False) == 20.0 * ROUNDING
    assert wanted(1e-15, 0.0, CELLS, False) == 1e-15  # unless it is asked for


def test_a_slack_sheet_has_an_end() -> None:
    """Without energy there is no strain to go by; a hundredth of the tolerance is enough."""
    assert wanted(1e-8, 0.0, CELLS, relaxed=True) == pytest.approx(1e-10, rel=1e-12)
    assert wanted(1e-8, 0.5 * 0.05**2 * AREA, CELLS, relaxed=True) == pytest.approx(0.5e-8, rel=1e-12)


def test_a_membrane_that_is_lifted_a_little_pulls_with_the_force_of_the_closed_form() -> None:
    """A strain of 1e-4: at a residual of 1e-8 the two rims would pull with forces 5 % apart."""
    scene = load_scene("annulus-lift", {"edges.inner.move_mm": [0.0, 0.0, 2.8]})
    exact, found = (run(scene, method=method, nodes=2000) for method in ("exact", "tension-field"))
    expected = float(exact.reactions["inner"].force_N[2])
    for rim, sign in (("inner", 1.0), ("outer", -1.0)):
        # second order: 2e-3 on 2 000 nodes
        assert found.reactions[rim].force_N[2] == pytest.approx(sign * expected, rel=4e-3)


def strip(nodes: int) -> Grid:
    return meshes.rectangle(20.0, 4.0, nodes)


@pytest.mark.parametrize("times", [4.0, 12.0, 50.0, 100.0, 300.0])
def test_a_column_that_a_small_load_pushes_has_the_energy_of_one_half_wave(times: float) -> None:
    """Euler: beyond the critical strain c the stress stays at Y c, so E = Y h A (c e - c^2 / 2), here for e <= 3e-4."""
    thickness = 0.02
    critical = (np.pi / 20.0 * thickness) ** 2 / 12.0
    strain = times * critical
    ends = {"left": 0.5 * strain * 20.0, "right": -0.5 * strain * 20.0}
    edges = {name: EdgeCondition("pinned", move_mm=(move, 0.0, 0.0)) for name, move in ends.items()}
    problem = Problem(Sheet(3500.0, 0.0, thickness), edges, strip(500), strip, perturbation=1e-6)
    solution = solve(problem, KOITER, Settings(tolerance=1e-6))
    expected = 3500.0 * thickness * 80.0 * critical * (strain - 0.5 * critical)
    assert (solution.status, solution.stability["stable"]) == (Status.CONVERGED, True)
    assert solution.energy_N_mm["total"] == pytest.approx(expected, rel=5e-3)  # 50 cells
