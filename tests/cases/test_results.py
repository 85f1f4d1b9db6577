"""Result folders: complete, read back exactly, refused when damaged."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cases import load_result, load_scene, run
from cases.files import read_csv
from cases.methods import Task
from cases.results import ResultError
from cases.scene import scene_hash
from fdsolver import meshes
from fdsolver.result import Solution, Status
from tests.cases.made import Fake, assert_same, made_solution

KEYS = {
    *("scene", "method", "status", "message", "nodes", "zones", "steps", "force_evaluations", "residual"),
    *("seconds", "cpu_seconds", "seconds_compile", "peak_memory_MB", "energy_N_mm", "reactions", "stretch"),
    *("out_of_plane_mm", "hourglass", "nodes_per_wrinkle", "stability", "effects", "errors", "warnings"),
    *("sections", "buckling", "versions", "machine", "threads", "seed", "code", "scene_hash"),
}
INNER_KEYS = {
    "energy_N_mm": {"total", "membrane", "bending"},
    "stretch": {"major_max", "major_min", "minor_min"},
    "out_of_plane_mm": {"max_abs", "rms"},
    "hourglass": {"out_of_plane", "in_plane"},
    "stability": {"stable", "how", "lowest"},
    "buckling": {"critical"},
}
MEASURES = {"amplitude_mm", "rms_mm", "wavelength_mm", "half_waves", "symmetry"}


def test_the_result_has_every_key_of_the_contract(solved: tuple[Solution, Path]) -> None:
    solution, out = solved
    document = json.loads((out / "result.json").read_text())
    assert set(document) >= KEYS
    for key, inner in INNER_KEYS.items():
        assert set(document[key]) >= inner, key
    assert set(document["reactions"]) == {"inner", "outer"}
    for reaction in document["reactions"].values():
        assert {key: len(value) for key, value in reaction.items()} == {"force_N": 3, "moment_N_mm": 3}
    assert set(document["sections"]) == {"ring_1", "ring_2", "ring_3"}
    for measures in document["sections"].values():
        assert set(measures) == MEASURES
    assert set(document["effects"]) == {
        "out_of_plane",
        "bending",
        "strain_gradient",
        "kinematics",
        "symmetry",
    }
    for effect in document["effects"].values():
        assert set(effect) == {"on", "why", "size", "justified"}
    assert not document["effects"]["bending"]["on"]
    assert document["status"] == "converged"
    assert document["residual"] < 1e-8
    assert document["nodes"] == solution.grid.nodes
    assert document["zones"] == solution.grid.zones
    assert document["seed"] == 3
    assert document["out_of_plane_mm"]["max_abs"] == pytest.approx(125.0, rel=1e-9)
    assert document["stretch"]["major_max"] == solution.zone.stretch_major.max()
    assert document["scene_hash"] == scene_hash(load_scene(out / "scene.toml"), "tension-field", seed=3)
    assert document["versions"]["numpy"] == np.__version__


def test_the_rms_height_is_that_of_the_sheet_not_of_the_nodes(tmp_path: Path, faked: Fake) -> None:
    """A tilted sheet, z = x: the rms over a rectangle is its half width / sqrt(3), however nodes gather."""
    grid = meshes.rectangle(30.0, 20.0, 3000, bias=2.0)
    faked(lambda task: made_solution(grid, lambda x, y: x))
    run(load_scene("strip-tension"), method="tension-field", out=tmp_path / "out")
    document = json.loads((tmp_path / "out" / "result.json").read_text())
    # Second order in the spacing, which is about a thirtieth of the half width at the edge.
    assert document["out_of_plane_mm"]["rms"] == pytest.approx(15.0 / np.sqrt(3.0), rel=3e-3)


def test_the_folder_has_every_file_of_the_contract(solved: tuple[Solution, Path]) -> None:
    solution, out = solved
    names = {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}
    rings = {f"sections/ring_{k}.csv" for k in (1, 2, 3)}
    assert names == {
        "result.json",
        "scene.toml",
        "fields.npz",
        "history.csv",
        "sheet.vtu",
        "paths/radius.csv",
        *rings,
    }
    with np.load(out / "fields.npz") as fields:
        assert fields["u"].shape == (solution.grid.ni, solution.grid.nj, 2)
        assert fields["r"].shape == (solution.grid.ni, solution.grid.nj, 3)
        assert fields["state"].shape == solution.grid.zone_area.shape
    assert list(read_csv(out / "history.csv")) == [
        "level",
        "step",
        "energy",
        "kinetic",
        "residual",
        "restart",
    ]
    assert list(read_csv(out / "paths" / "radius.csv"))[0] == "R_mm"
    assert list(read_csv(out / "sections" / "ring_1.csv")) == ["s_mm", "x_mm", "y_mm", "z_mm"]


def test_load_result_gives_the_solution_back(solved: tuple[Solution, Path]) -> None:
    solution, out = solved
    again = load_result(out)
    assert_same(solution, again)
    assert again.sheet == solution.sheet
    assert np.array_equal(again.grid.u, solution.grid.u)
    assert set(again.history) == set(solution.history)
    for name, column in solution.history.items():
        assert np.array_equal(again.history[name], column), name
    assert dict(again.hourglass) == dict(solution.hourglass)
    assert len(again.levels) == len(solution.levels)


def test_the_stored_scene_runs_again_to_the_same_bits(solved: tuple[Solution, Path]) -> None:
    solution, out = solved
    assert_same(solution, run(load_scene(out / "scene.toml"), method="tension-field", seed=3))


def test_a_result_with_positions_that_are_not_finite_is_stored(tmp_path: Path, faked: Fake) -> None:
    def broken(task: Task) -> Solution:
        solution = made_solution(meshes.rectangle(100.0, 50.0, 400))
        r = np.full_like(solution.r, np.nan)
        nothing = np.full_like(solution.zone.stretch_major, np.nan)
        zone = replace(
            solution.zone,
            stretch_major=nothing,
            stretch_minor=nothing,
            stress_major=nothing,
            stress_minor=nothing,
        )
        return replace(solution, status=Status.NOT_FINITE, r=r, zone=zone, residual=float("nan"))

    faked(broken)
    out = tmp_path / "out"
    run(load_scene("strip-tension"), method="tension-field", out=out)
    document = json.loads((out / "result.json").read_text())
    assert document["status"] == "not_finite"
    assert document["residual"] is None
    assert document["stretch"]["major_max"] is None
    assert document["sections"] == {}
    again = load_result(out)
    assert np.isnan(again.residual)
    assert np.isnan(again.r).all()


@pytest.mark.parametrize("missing", ["fields.npz", "scene.toml", "history.csv"])
def test_a_folder_that_lost_a_file_is_damaged(
    missing: str, tmp_path: Path, solved: tuple[Solution, Path]
) -> None:
    shutil.copytree(solved[1], tmp_path / "out")
    (tmp_path / "out" / missing).unlink()
    with pytest.raises(ResultError, match=f"The result folder .* is damaged: .*{missing}"):
        load_result(tmp_path / "out")


def test_tampered_folders_are_refused(tmp_path: Path, solved: tuple[Solution, Path]) -> None:
    for path in solved[1].iterdir():
        if path.is_file():
            (tmp_path / path.name).write_bytes(path.read_bytes())
    whole = json.loads((tmp_path / "result.json").read_text())
    document = {key: value for key, value in whole.items() if key != "sha256"}  # as older versions wrote it
    for text, sentence in (
        (json.dumps(whole | {"steps": whole["steps"] + 1}), "is damaged: it is not what was written"),
        (json.dumps(whole | {"sha256": 3}), "is damaged: it is not what was written"),
        ("", "cannot be read"),
        ("[1, 2]", "is not the result.json"),
        (json.dumps(document | {"status": "perfect"}), "there is no status 'perfect'"),
        (json.dumps(document | {"reactions": {"inner": {}}}), "'force_N' is missing"),
    ):
        (tmp_path / "result.json").write_text(text)
        with pytest.raises(ResultError, match=re.escape(sentence)):
            load_result(tmp_path)
    with pytest.raises(ResultError, match="holds no result"):
        load_result(tmp_path / "nowhere")


@pytest.mark.parametrize("first", ["from cases.compare import compare", "import cases.compare", "pass"])
def test_the_package_is_light_and_its_names_are_functions(first: str, project: Path) -> None:
    """`import cases` loads no library; `compare` is the function, not the module of that name."""
    script = (
        "import sys, cases\n"
        "heavy = {'numpy', 'numba', 'pydantic'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
        f"{first}\n"
        "from cases import compare, load_result, load_scene, run\n"
        "assert all(callable(name) for name in (cases.compare, compare, load_result, load_scene, run))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=project, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_snapshots_are_stored_and_read_back(tmp_path: Path, faked: Fake) -> None:
    grid = meshes.rectangle(100.0, 50.0, 400)
    made = made_solution(grid, lambda x, y: np.sin(x))
    shots = {
        "step": np.array([0, 20]),
        "level": np.array([0, 0]),
        "kinetic_N_mm": np.array([0.0, 1 / 3]),
        "r": np.stack([0.5 * made.r, made.r]),
    }
    faked(lambda task: replace(made, snapshots=shots))
    run(load_scene("strip-tension"), method="tension-field", out=tmp_path / "with")
    again = load_result(tmp_path / "with").snapshots
    assert set(again) == set(shots)
    for name, array in shots.items():
        np.testing.assert_array_equal(again[name], array)
    faked(lambda task: made)
    run(load_scene("strip-tension"), method="tension-field", out=tmp_path / "without")
    assert not (tmp_path / "without" / "snapshots.npz").exists()
    assert load_result(tmp_path / "without").snapshots == {}
