"""Relaxation that starts from a buckling mode."""

from __future__ import annotations

import numpy as np
import pytest

from cases import load_scene
from cases.boundary import problem_of
from cases.methods import MethodError, choose
from cases.mode_start import mode_state
from fdsolver.model import KOITER

# a strip that is easy to wrinkle: few half-waves, which a coarse mesh carries
STRIP = {
    "mesh.nodes": 1200,
    "mesh.vertices": 400,
    "sheet.thickness_mm": 0.4,
    "edges.top.move_mm": [0.0, 30.0, 0.0],
}


def test_the_start_is_the_pulled_sheet_lifted_by_the_mode() -> None:
    scene = load_scene("stretch", STRIP)
    grid, r = mode_state(scene, 1)
    z = r[..., 2]
    assert 0.3 < np.abs(z).max() <= 0.4  # one thickness at a vertex, less at nodes between
    mirrored = z[::-1]
    # the lowest two are a pair of opposite parity; linear interpolation keeps it to a percent
    correlation = (z * mirrored).sum() / (z**2).sum()
    assert abs(correlation) > 0.97
    other = mode_state(scene, 2)[1][..., 2]
    assert np.sign((other * other[::-1]).sum()) == -np.sign(correlation)
    assert r[:, -1, 1] == pytest.approx(grid.u[:, -1, 1] + 30.0) and r[:, 0, 1] == pytest.approx(
        grid.u[:, 0, 1]
    )
    # pulled sheets of rubber narrow by about half the strain; the middle is free of the grips
    middle = grid.nj // 2
    width = np.ptp(r[:, middle, 0]) / np.ptp(grid.u[:, middle, 0])
    assert width == pytest.approx(1.0 - 0.5 * 30.0 / 254.0, abs=0.01)


def test_the_problem_of_a_plate_carries_the_start() -> None:
    problem = problem_of(load_scene("stretch", STRIP | {"start.from": "mode:1"}), KOITER, 0)
    assert problem.initial is not None and np.abs(problem.initial[1][..., 2]).max() > 0.3


def test_a_scene_without_buckling_load_has_no_mode() -> None:
    scene = load_scene("annulus", {"start.from": "mode:1"})
    with pytest.raises(
        MethodError, match="has no mode to start from: an edge of the scene annulus moves along z"
    ):
        choose(scene, "koiter")


def test_a_mode_that_was_not_looked_for_is_refused() -> None:
    scene = load_scene("stretch", STRIP)
    with pytest.raises(MethodError, match="there are 1[0-9] modes|there are 2[0-9] modes"):
        mode_state(scene, 900)


def test_a_sheet_that_is_only_pulled_has_no_mode() -> None:
    with pytest.raises(MethodError, match="start.from = 'mode:1': The sheet is nowhere compressed"):
        mode_state(load_scene("strip-tension", {"mesh.vertices": 400}), 1)
