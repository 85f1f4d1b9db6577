"""Snapshots of a run: where in the history they stand, and what they show."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from fdsolver import meshes
from fdsolver.grid import Grid
from fdsolver.model import KOITER
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.relax import BLOCK, Settings
from fdsolver.result import Solution, Status
from fdsolver.snapshots import SPREAD
from tests.relaxing import EDGES, SHEET

COUNT = 7


def grid_of(nodes: int) -> Grid:
    return meshes.rectangle(20.0, 12.0, nodes)


def pulled(damping: str, levels: int = 1, count: int = COUNT) -> Solution:
    """A thick strip, which is pulled and stays flat."""
    grid = grid_of(2000 if levels > 1 else 400)
    moved = dataclasses.replace(EDGES["right"], move_mm=(0.2, 0.05, 0.0))
    problem = Problem(SHEET, {**EDGES, "right": moved}, grid, grid_of, perturbation=1e-3)
    settings = Settings(tolerance=1e-8, damping=damping, levels=levels, snapshots=count)
    solution = solve(problem, KOITER, settings)
    assert solution.status is Status.CONVERGED
    return solution


@pytest.mark.parametrize("damping", ["adaptive", "kinetic", "kinetic-published"])
def test_snapshots_begin_with_the_start_end_with_the_result_and_stand_in_the_history(damping: str) -> None:
    solution = pulled(damping)
    shots, history = solution.snapshots, solution.history
    assert set(shots) == {"step", "level", "kinetic_N_mm", "r"}
    assert shots["r"].shape == (len(shots["step"]), *solution.grid.u.shape[:2], 3)
    assert shots["step"][0] == 0 and shots["step"][-1] == solution.steps
    np.testing.assert_array_equal(shots["r"][-1], solution.r)
    # the start carries the random perturbation, of at most 1e-3 of the width of 20 mm
    assert 0.5 * 2e-2 < np.abs(shots["r"][0][..., 2]).max() <= 2e-2
    place = np.searchsorted(history["step"], shots["step"])
    np.testing.assert_array_equal(history["step"][place], shots["step"])
    np.testing.assert_array_equal(shots["level"], 0)
    np.testing.assert_array_equal(history["kinetic"][place], shots["kinetic_N_mm"])


def test_with_kinetic_damping_they_stand_at_peaks_of_the_kinetic_energy() -> None:
    solution = pulled("kinetic")
    kinetic, step = solution.history["kinetic"], solution.history["step"]
    inner = np.searchsorted(step, solution.snapshots["step"][1:-1])
    assert len(inner) >= 3
    assert np.all(kinetic[inner] > kinetic[inner - 1])
    assert np.all(kinetic[inner] > kinetic[inner + 1])
    # most looks are no peaks, so that the shapes would not stand there by chance
    assert np.count_nonzero(np.diff(np.sign(np.diff(kinetic))) < 0) < len(kinetic) / 2


def test_with_viscous_damping_their_steps_grow_by_a_factor() -> None:
    steps = pulled("adaptive", count=1000).snapshots["step"]
    assert steps[1] == BLOCK
    ratio = steps[2:-1] / steps[1:-2]
    assert np.all(ratio >= SPREAD)
    # the first look past the factor is taken
    assert np.all(steps[2:-1] < SPREAD * steps[1:-2] + BLOCK)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_as_many_as_wanted(count: int) -> None:
    shots = pulled("adaptive", count=count).snapshots
    assert len(shots["step"]) == count == len(set(shots["step"].tolist()))
    assert np.all(np.diff(shots["step"]) > 0)


def test_none_unless_asked_for() -> None:
    assert pulled("adaptive", count=0).snapshots == {}


def test_shapes_of_coarse_meshes_are_shown_on_the_mesh_of_the_result() -> None:
    solution = pulled("adaptive", levels=2, count=1000)
    shots, coarse = solution.snapshots, int(solution.levels[0]["steps"])
    assert set(shots["level"].tolist()) == {0, 1}
    assert shots["r"].shape[1:3] == (solution.grid.ni, solution.grid.nj)
    last_coarse = np.flatnonzero(shots["level"] == 0)[-1]
    assert 0.5 * coarse < shots["step"][last_coarse] <= coarse
    before, after = shots["r"][last_coarse], solution.r
    # at rest on the coarse mesh within its error, a tenth of the displacements of 0.2 mm
    assert np.abs(before - after)[..., :2].max() < 0.02
    assert np.abs(shots["r"][0] - after)[..., :2].max() > np.abs(before - after)[..., :2].max()
