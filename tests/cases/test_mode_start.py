"""Relaxation that starts from a buckling mode."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cases import load_scene
from cases.__main__ import main
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


def solved(folder: Path, *changes: str) -> dict[str, Any]:
    """result.json of the pulled strip on a coarse mesh, solved on the command line."""
    words = ["run", "stretch", "--method", "koiter", "--nodes", "2000", "--tol", "1e-9", "--quiet"]
    settings = [word for change in ("mesh.vertices=400", *changes) for word in ("--set", change)]
    assert main([*words, *settings, "--out", str(folder)]) == 0
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))


def test_a_start_from_either_mode_ends_at_the_energy_of_the_cold_start(tmp_path: Path) -> None:
    """The first two modes are cosine and sine of one pattern: their wrinkles differ in phase, which is neutral."""
    cold = solved(tmp_path / "cold")
    for number, parity in ((1, 1.0), (2, -1.0)):
        found = solved(tmp_path / f"mode-{number}", f"start.from=mode:{number}")
        assert found["stability"]["stable"] is True
        # wrinkles gain 8e-6 of the energy; a mesh of four nodes to a wrinkle pins their phase by 1e-9
        assert found["energy_N_mm"]["total"] == pytest.approx(cold["energy_N_mm"]["total"], rel=2e-9)
        assert found["energy_N_mm"]["bending"] == pytest.approx(cold["energy_N_mm"]["bending"], rel=2e-3)
        # relaxation keeps the symmetry of its start
        assert found["sections"]["midsection"]["symmetry"] == pytest.approx(parity, abs=1e-6)
        assert found["steps"] < cold["steps"]
