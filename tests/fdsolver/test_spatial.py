"""Stability of bent plates: columns in higher waves against the closed form, and dense eigenproblems."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh

from fdsolver import meshes, spatial, stability
from fdsolver.edges import EdgeCondition
from fdsolver.level import Level
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE
from fdsolver.problem import Problem
from fdsolver.relax import Settings, begin, relax
from fdsolver.result import Status
from fdsolver.spatial import NEUTRAL, examinable, lowest_in_space
from fdsolver.stability import relax_to_stable
from tests.dense import tangent

LENGTH, WIDTH = 20.0, 4.0


def column(nodes: int, thickness_mm: float, waves: int) -> tuple[Level, np.ndarray]:
    """A pinned strip without lateral contraction, shortened to its equilibrium in so many half-waves.

    Twice the strain of their critical load goes half into the waves A sin(n k x), which take up (n k A)^2 / 4.
    """
    k = waves * np.pi / LENGTH
    critical = (k * thickness_mm) ** 2 / 12.0
    grid = meshes.rectangle(LENGTH, WIDTH, nodes)
    ends = {"left": critical * LENGTH, "right": -critical * LENGTH}
    edges = {name: EdgeCondition("pinned", move_mm=(move, 0.0, 0.0)) for name, move in ends.items()}
    problem = Problem(Sheet(3500.0, 0.0, thickness_mm), edges, grid, lambda n: grid, perturbation=0.0)
    level = Level(problem, KOITER, grid, threads=1)
    r = level.start()
    x = grid.u[..., 0] - grid.u[0, 0, 0]
    r[2] = np.where(level.fixed, 0.0, 2.0 * np.sqrt(critical) / k * np.sin(k * x) / grid.length_mm)
    state = begin(r)
    place = (level.force, ~level.fixed, level.weight, state)
    assert relax(*place, Settings(tolerance=1e-8, max_steps=400_000)) is Status.CONVERGED
    return level, state.r


@pytest.mark.parametrize("waves", [2, 3])
@pytest.mark.parametrize(("nodes", "thickness_mm"), [(500, 0.2), (1500, 0.2), (500, 0.02)])
def test_a_column_in_a_higher_wave_is_unstable_by_its_closed_form(
    waves: int, nodes: int, thickness_mm: float
) -> None:
    """Under n^2 times Euler's load the first wave has D k^4 - n^2 D k^4, over its bending D k^4: 1 - n^2."""
    level, r = column(nodes, thickness_mm, waves)
    found = lowest_in_space(level.force, r, level.scaled(level.flat), level.weight, 0)
    assert found is not None and found[1] is not None
    assert found[0] == pytest.approx(
        1.0 - waves**2, rel=0.02
    )  # 50 cells: the n-th critical load, and the width
    first = np.sin(np.pi * (level.grid.u[..., 0] - level.grid.u[0, 0, 0]) / LENGTH)
    assert np.vdot(found[1][2], first) ** 2 > 0.99 * np.vdot(found[1], found[1]) * np.vdot(first, first)


def test_the_first_wave_of_a_column_is_stable() -> None:
    level, r = column(500, 0.2, 1)
    bound, mode, _ = lowest_in_space(level.force, r, level.scaled(level.flat), level.weight, 0) or (0, 0, 0)
    assert (bound, mode) == (-NEUTRAL, None)


def test_a_column_leaves_its_second_wave_for_the_first() -> None:
    level, r = column(500, 0.2, 2)
    state = begin(r)
    status, verdict = relax_to_stable(level, state, Settings(tolerance=1e-7))
    assert (status, verdict["stable"], state.kicks) == (Status.CONVERGED, True, 1)
    z = state.r[2, 1:-1, level.grid.nj // 2]
    assert np.all(z > 0.0) or np.all(z < 0.0)


def test_it_is_the_lowest_value_of_the_dense_problem() -> None:
    """Bending of the flat sheet for each component, from the dense tangent of the flat sheet out of its plane."""
    level, r = column(150, 0.5, 2)
    force, nodes = level.force, level.grid.nodes
    bending = tangent(force, level.scaled(level.flat))[2 * nodes :, 2 * nodes :]
    loose = np.flatnonzero(np.tile(~level.fixed.ravel(), 3))
    stiffness = tangent(force, r)[np.ix_(loose, loose)]
    metric = np.kron(np.eye(3), bending)[np.ix_(loose, loose)]
    expected = eigh(stiffness, metric, eigvals_only=True)[0]
    found = lowest_in_space(force, r, level.scaled(level.flat), level.weight, 0)
    assert found is not None
    assert found[0] == pytest.approx(expected, rel=1e-3)


def test_membranes_and_large_meshes_are_left_to_the_iteration(monkeypatch: pytest.MonkeyPatch) -> None:
    level, r = column(500, 0.2, 2)
    assert examinable(level.force)
    assert not examinable(Level(level.problem, MEMBRANE, level.grid, threads=1).force)
    monkeypatch.setattr(spatial, "MOST_NODES", 400)
    assert not examinable(level.force)
    monkeypatch.setattr(stability, "search", lambda *_: "searched")
    assert stability.examine(level, begin(r)) == "searched"


def test_modes_that_are_not_found_are_left_to_the_iteration(monkeypatch: pytest.MonkeyPatch) -> None:
    level, r = column(500, 0.2, 2)
    monkeypatch.setattr(spatial, "SHIFTS", (1.0,))  # t is -3: no factor at this shift
    assert lowest_in_space(level.force, r, level.scaled(level.flat), level.weight, 0) is None
    monkeypatch.setattr(stability, "search", lambda *_: "searched")
    assert stability.examine(level, begin(r)) == "searched"
