"""Runs and result folders: complete, read back exactly, resumed, refused, never damaged."""

from __future__ import annotations

import errno
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cases import load_result, load_scene, run
from cases import methods as methods_module
from cases.files import read_csv
from cases.methods import LATER, METHODS, MethodError, Task, choose, methods_of
from cases.results import ResultError
from cases.runner import FolderRefused
from cases.scene import scene_hash
from fdsolver import meshes
from fdsolver.checkpoint import CheckpointError, StorageError
from fdsolver.result import Solution, Status
from tests.cases.made import made_solution

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


def assert_same(first: Solution, second: Solution) -> None:
    """Equal in every bit that a folder stores."""
    assert first.r.tobytes() == second.r.tobytes()
    for name in ("stretch_major", "stretch_minor", "stress_major", "stress_minor", "state"):
        assert np.array_equal(getattr(first.zone, name), getattr(second.zone, name))
    for name in ("method", "status", "message", "steps", "force_evaluations", "residual", "warnings", "seed"):
        assert getattr(first, name) == getattr(second, name), name
    assert dict(first.energy_N_mm) == dict(second.energy_N_mm)
    assert set(first.reactions) == set(second.reactions)
    for edge, reaction in first.reactions.items():
        assert np.array_equal(reaction.force_N, second.reactions[edge].force_N)
        assert np.array_equal(reaction.moment_N_mm, second.reactions[edge].moment_N_mm)


@pytest.fixture(scope="module", name="solved")
def _solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Solution, Path]:
    """The turned annulus by tension field, coarse, in a folder."""
    out = tmp_path_factory.mktemp("runs") / "annulus"
    return run(load_scene("annulus"), method="tension-field", nodes=900, seed=3, out=out), out


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
    assert set(document["effects"]) == {"out_of_plane", "bending", "strain_gradient", "kinematics"}
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


Fake = Callable[[Callable[[Task], Solution]], None]


@pytest.fixture(name="faked")
def _faked(monkeypatch: pytest.MonkeyPatch) -> Fake:
    """Put a function in the place of the tension-field solver."""

    def fake(solve: Callable[[Task], Solution]) -> None:
        monkeypatch.setitem(METHODS, "tension-field", replace(METHODS["tension-field"], solve=solve))

    return fake


def never(_: Task) -> Solution:
    raise AssertionError("this must not be solved again")


def test_a_finished_run_is_returned_not_solved_again(solved: tuple[Solution, Path], faked: Fake) -> None:
    solution, out = solved
    faked(never)
    for resume in (False, True):
        again = run(load_scene("annulus"), method="tension-field", nodes=900, seed=3, out=out, resume=resume)
        assert_same(solution, again)


@pytest.mark.parametrize(
    "change",
    [
        {"nodes": 1200},
        {"seed": 4},
        {"tolerance": 1e-7},
        {"method": "membrane"},
        {"scene": load_scene("annulus", {"edges.inner.rotate_deg": 80.0})},
    ],
    ids=lambda change: next(iter(change)),
)
def test_another_run_does_not_touch_the_folder(
    change: dict, solved: tuple[Solution, Path], faked: Fake
) -> None:
    _, out = solved
    faked(never)
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*")}
    words = {"scene": load_scene("annulus"), "method": "tension-field", "nodes": 900, "seed": 3} | change
    sentence = f"{out} holds a result of another scene, mesh or setting (annulus by tension-field)"
    with pytest.raises(FolderRefused, match=re.escape(sentence)):
        run(**words, out=out)
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*")} == before


def test_force_replaces_another_result(tmp_path: Path) -> None:
    scene, out = load_scene("strip-tension"), tmp_path / "out"
    run(scene, method="exact", nodes=400, out=out)
    found = run(scene, method="exact", nodes=900, out=out, force=True)
    assert load_result(out).grid.nodes == found.grid.nodes
    assert found.grid.nodes == pytest.approx(900, rel=0.05)


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_of_something_else_is_never_replaced(force: bool, tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(FolderRefused, match="is no result folder; choose another place"):
        run(load_scene("strip-tension"), method="exact", nodes=400, out=tmp_path, force=force)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.write_text("a file")
    with pytest.raises(FolderRefused, match="is no result folder"):
        run(load_scene("strip-tension"), method="exact", nodes=400, out=out, force=True)
    assert out.read_text() == "a file"


def test_an_empty_folder_is_filled(tmp_path: Path) -> None:
    run(load_scene("strip-tension"), method="exact", nodes=400, out=tmp_path)
    assert load_result(tmp_path).status is Status.CONVERGED


def interrupted(task: Task) -> Solution:
    """A solver that is interrupted once, after a checkpoint, and ends at the next call."""
    assert task.checkpoint is not None
    solution = made_solution(meshes.rectangle(100.0, 50.0, 400))
    saved = task.checkpoint.load()
    if saved is None:
        task.checkpoint.save({"step": 10})
        return replace(solution, status=Status.INTERRUPTED, steps=10)
    return replace(solution, steps=10 + int(saved["step"]))


@pytest.mark.parametrize("resume", [False, True])
def test_an_interrupted_run_goes_on_from_its_checkpoint(resume: bool, tmp_path: Path, faked: Fake) -> None:
    faked(interrupted)
    scene, out = load_scene("strip-tension"), tmp_path / "out"
    assert run(scene, method="tension-field", out=out).status is Status.INTERRUPTED
    assert load_result(out).status is Status.INTERRUPTED
    assert (out / "checkpoint.npz").exists()
    assert run(scene, method="tension-field", out=out, resume=resume).steps == 20
    assert load_result(out).status is Status.CONVERGED
    assert not (out / "checkpoint.npz").exists()


def test_force_begins_an_interrupted_run_anew(tmp_path: Path, faked: Fake) -> None:
    faked(interrupted)
    scene, out = load_scene("strip-tension"), tmp_path / "out"
    run(scene, method="tension-field", out=out)
    assert run(scene, method="tension-field", out=out, force=True).status is Status.INTERRUPTED
    assert run(scene, method="tension-field", out=out, force=True, resume=True).steps == 20


def test_an_interrupted_run_takes_no_finished_results_place(tmp_path: Path, faked: Fake) -> None:
    scene, out = load_scene("strip-tension"), tmp_path / "out"
    old = run(scene, method="exact", nodes=400, out=out)
    faked(interrupted)
    run(scene, method="tension-field", out=out, force=True)
    assert_same(load_result(out), old)
    assert run(scene, method="tension-field", out=out, force=True, resume=True).steps == 20
    assert load_result(out).method == "koiter"  # as the made-up solution says


def test_the_checkpoint_of_another_run_is_refused(tmp_path: Path, faked: Fake) -> None:
    faked(interrupted)
    scene, out = load_scene("strip-tension"), tmp_path / "out"
    run(scene, method="tension-field", out=out)
    (out / "result.json").unlink()
    with pytest.raises(FolderRefused, match="unfinished run of something else"):
        run(scene, method="tension-field", nodes=500, out=out)
    with pytest.raises(CheckpointError, match="belongs to another run"):
        run(scene, method="tension-field", seed=1, out=out)
    assert run(scene, method="tension-field", out=out).steps == 20


def test_a_damaged_checkpoint_is_refused_before_anything_is_solved(tmp_path: Path, faked: Fake) -> None:
    faked(interrupted)
    scene, out = load_scene("strip-tension"), tmp_path / "out"
    run(scene, method="tension-field", out=out)
    path = out / "checkpoint.npz"
    path.write_bytes(path.read_bytes()[:-40])
    faked(never)
    with pytest.raises(CheckpointError, match="damaged"):
        run(scene, method="tension-field", out=out, resume=True)


def test_a_step_limit_can_be_raised_by_resume(tmp_path: Path) -> None:
    """The same run with a larger limit goes on and ends in the same bits as one that never stopped."""
    out = tmp_path / "out"
    whole = run(load_scene("annulus"), method="tension-field", nodes=900)
    assert whole.steps > 300
    short = load_scene("annulus", {"solver.max_steps": 200})
    first = run(short, method="tension-field", nodes=900, out=out)
    assert (first.status, first.steps) == (Status.STEP_LIMIT, 200)
    assert run(short, method="tension-field", nodes=900, out=out).steps == 200
    longer = run(load_scene("annulus"), method="tension-field", nodes=900, out=out, resume=True)
    assert longer.status is Status.CONVERGED
    assert longer.r.tobytes() == whole.r.tobytes()


KILLED_RUN = """
import sys
from fdsolver import multilevel
multilevel.SAVE_SECONDS = 0.05
from cases import load_scene, run
run(load_scene("annulus"), method="tension-field", nodes=20000, tolerance=1e-12, out=sys.argv[1])
"""


def test_a_killed_run_goes_on_to_the_same_bits(tmp_path: Path, project: Path) -> None:
    out = tmp_path / "out"
    process = subprocess.Popen([sys.executable, "-c", KILLED_RUN, str(out)], cwd=project)
    deadline = time.monotonic() + 120.0
    while not (out / "checkpoint.npz").exists() and time.monotonic() < deadline:
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    assert {path.name for path in out.iterdir()} >= {"scene.toml", "checkpoint.npz"}
    words = {"method": "tension-field", "nodes": 20000, "tolerance": 1e-12}
    resumed = run(load_scene("annulus"), **words, out=out, resume=True)
    assert resumed.status is Status.CONVERGED
    assert_same(resumed, run(load_scene("annulus"), **words))


def test_a_full_disk_at_the_end_leaves_the_old_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, out = load_scene("strip-tension"), tmp_path / "out"
    old = run(scene, method="exact", nodes=400, out=out)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("cases.results.write_vtu", full)
    with pytest.raises(StorageError, match=r"Could not write .*out: No space left on device\."):
        run(scene, method="exact", nodes=900, out=out, force=True)
    assert_same(load_result(out), old)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(StorageError, match="Could not write .*: Not a directory"):
        run(load_scene("strip-tension"), method="exact", nodes=400, out=tmp_path / "file" / "out")


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


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"nodes": 1}, "nodes must be a whole number from 400 to 50000000, not 1."),
        ({"nodes": 10**9}, "nodes must be a whole number from 400 to 50000000, not 1000000000."),
        ({"nodes": 500.0}, "nodes must be a whole number from 400 to 50000000, not 500.0."),
        ({"seed": -1}, "seed must be a whole number from 0 to 2^63 - 1, not -1."),
        ({"seed": True}, "seed must be a whole number from 0 to 2^63 - 1, not True."),
        ({"threads": 0}, "threads must be a whole number from 1 to 1024, not 0."),
        ({"tolerance": 0.0}, "tolerance must be a residual from 1e-14 to 0.1, not 0.0."),
        ({"tolerance": float("nan")}, "tolerance must be a residual from 1e-14 to 0.1, not nan."),
        ({"method": "tension"}, "There is no method 'tension'; there are auto, tension-field"),
    ],
    ids=str,
)
def test_bad_numbers_and_names_write_nothing(words: dict, sentence: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with pytest.raises(MethodError, match=re.escape(sentence)):
        run(load_scene("strip-tension"), **({"method": "exact", "out": out} | words))
    assert not out.exists()


@pytest.mark.parametrize("name", LATER)
def test_methods_of_later_versions_say_so(name: str) -> None:
    with pytest.raises(MethodError, match=f"The method {name} comes with a later version"):
        choose(load_scene("annulus"), name)


@pytest.mark.parametrize(
    ("method", "key", "value"),
    [
        ("tension-field", "symmetry.reduce", "half-x"),
        ("tension-field", "start.from", "runs/other"),
        ("koiter", "effects.kinematics", "moderate"),
        ("koiter", "effects.out_of_plane", "off"),
        ("koiter", "effects.bending", "off"),
        ("koiter", "effects.strain_gradient", "off"),
    ],
)
def test_keys_that_would_be_dropped_are_refused(method: str, key: str, value: str) -> None:
    with pytest.raises(MethodError, match=re.escape(f"{key} = '{value}'")):
        choose(load_scene("annulus", {key: value}), method)


def test_what_a_membrane_lacks_anyway_may_be_off() -> None:
    scene = load_scene("annulus", {"effects.bending": "off", "effects.strain_gradient": "off"})
    assert choose(scene, "tension-field")[0].name == "tension-field"


def test_auto_says_what_it_chose_and_why() -> None:
    """Thin sheets wrinkle too finely for a coarse mesh; thick ones do not."""
    thin = load_scene("annulus", {"mesh.nodes": 2000, "sheet.thickness_mm": 0.001})
    thick = load_scene("annulus", {"mesh.nodes": 2000, "sheet.thickness_mm": 20.0})
    for scene, name, reason in ((thin, "tension-field", "cannot resolve"), (thick, "koiter", "resolves")):
        method, why = choose(scene, "auto")
        assert method.name == name
        assert reason in why
    still = load_scene("annulus", {"edges.inner.move_mm": [0, 0, 0], "edges.inner.rotate_deg": 0})
    assert choose(still, "auto")[0].name == "koiter"


def test_the_reason_of_auto_is_in_the_warnings(faked: Fake) -> None:
    faked(lambda task: made_solution(meshes.annulus(62.5, 250.0, 400)))
    scene = load_scene("annulus", {"mesh.nodes": 2000, "sheet.thickness_mm": 0.001})
    assert run(scene).warnings[0].startswith("auto chose tension-field: the mesh cannot resolve")


def test_defaults_that_a_scene_left_open_are_named(faked: Fake, tmp_path: Path) -> None:
    faked(lambda task: made_solution(meshes.rectangle(100.0, 50.0, 400)))
    path = tmp_path / "scene.toml"
    path.write_text(
        '[sheet]\nshape = "rectangle"\nwidth_mm = 100.0\nheight_mm = 50.0\n[edges.left]\nsupport = "pinned"\n'
    )
    warnings = run(load_scene(path), method="tension-field").warnings
    assert any("sheet.thickness_mm" in warning and "material.poisson" in warning for warning in warnings)


@pytest.mark.parametrize(
    ("status", "strict", "expected"),
    [
        (Status.CONVERGED, False, Status.CONVERGED),
        (Status.CONVERGED, True, Status.UNDER_RESOLVED),
        (Status.STEP_LIMIT, True, Status.UNDER_RESOLVED),
        (Status.HOURGLASS, True, Status.HOURGLASS),
        (Status.INTERRUPTED, True, Status.INTERRUPTED),
    ],
)
def test_coarse_wrinkles_are_warned_of_and_strictly_a_status(
    status: Status, strict: bool, expected: Status, faked: Fake
) -> None:
    grid = meshes.rectangle(100.0, 50.0, 2000)
    spacing = 100.0 / (grid.ni - 1)
    wave = made_solution(grid, lambda x, y: np.cos(2.0 * np.pi * x / (5.0 * spacing)))
    faked(lambda task: replace(wave, status=status))
    solution = run(load_scene("strip-tension"), method="tension-field", strict=strict)
    assert solution.status is expected
    assert any("5.0 nodes each, fewer than 6" in warning for warning in solution.warnings)


def test_wrinkles_of_enough_nodes_are_not_warned_of(faked: Fake) -> None:
    grid = meshes.rectangle(100.0, 50.0, 2000)
    spacing = 100.0 / (grid.ni - 1)
    faked(lambda task: made_solution(grid, lambda x, y: np.cos(2.0 * np.pi * x / (7.0 * spacing))))
    solution = run(load_scene("strip-tension"), method="tension-field", strict=True)
    assert solution.status is Status.CONVERGED
    assert not any("nodes each" in warning for warning in solution.warnings)


def test_progress_reaches_the_engine() -> None:
    seen = []
    run(load_scene("annulus"), method="tension-field", nodes=900, progress=seen.append)
    assert seen
    assert seen[-1].tolerance == 1e-8
    assert seen[-1].nodes == pytest.approx(900, rel=0.05)


def test_the_default_tolerance_is_the_methods_and_the_scenes_wins(faked: Fake) -> None:
    seen = []

    def record(task: Task) -> Solution:
        seen.append(task.scene.solver.tolerance)
        return made_solution(meshes.rectangle(100.0, 50.0, 400))

    faked(record)
    run(load_scene("strip-tension"), method="tension-field")
    run(load_scene("strip-tension", {"solver.tolerance": 1e-5}), method="tension-field")
    run(load_scene("strip-tension", {"solver.tolerance": 1e-5}), method="tension-field", tolerance=1e-4)
    assert seen == [1e-8, 1e-5, 1e-4]
    assert METHODS["koiter"].tolerance == 1e-6
    assert METHODS["membrane"].tolerance == 1e-8


def test_only_plates_start_from_a_perturbation() -> None:
    scene = load_scene("hole", {"start.perturbation": 1e-4})
    problem = methods_module.problem_of
    assert problem(scene, methods_module.KOITER, seed=2).perturbation == 1e-4
    assert problem(scene, methods_module.KOITER, seed=2).seed == 2
    assert problem(scene, methods_module.MEMBRANE, seed=2).perturbation == 0.0


def test_scenes_with_a_closed_form_have_the_method_exact() -> None:
    assert methods_of(load_scene("annulus")) == ("tension-field", "membrane", "koiter", "exact")
    assert "exact" in methods_of(load_scene("shear-rails"))
    for name in ("hole", "stretch", "shear"):
        assert "exact" not in methods_of(load_scene(name))


@pytest.mark.parametrize("missing", ["fields.npz", "scene.toml", "history.csv"])
def test_a_folder_that_lost_a_file_is_damaged(
    missing: str, tmp_path: Path, solved: tuple[Solution, Path]
) -> None:
    for path in solved[1].iterdir():
        if path.is_file() and path.name != missing:
            (tmp_path / path.name).write_bytes(path.read_bytes())
    with pytest.raises(ResultError, match=f"The result folder .* is damaged: .*{missing}"):
        load_result(tmp_path)


def test_tampered_folders_are_refused(tmp_path: Path, solved: tuple[Solution, Path]) -> None:
    for path in solved[1].iterdir():
        if path.is_file():
            (tmp_path / path.name).write_bytes(path.read_bytes())
    document = json.loads((tmp_path / "result.json").read_text())
    for text, sentence in (
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
