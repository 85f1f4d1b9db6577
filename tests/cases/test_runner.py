"""Folders of runs: returned, resumed, refused, never damaged."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cases import load_result, load_scene, run
from cases.folders import FolderRefused
from cases.methods import Task
from cases.results import ResultError
from fdsolver import meshes
from fdsolver.checkpoint import CheckpointError, StorageError
from fdsolver.result import Solution, Status
from tests.cases.made import Fake, assert_same, made_solution


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
scene = load_scene("annulus", {"symmetry.reduce": "none"})
run(scene, method="tension-field", nodes=20000, tolerance=1e-12, out=sys.argv[1])
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
    whole = load_scene("annulus", {"symmetry.reduce": "none"})
    resumed = run(whole, **words, out=out, resume=True)
    assert resumed.status is Status.CONVERGED
    assert_same(resumed, run(whole, **words))


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


def test_a_run_starts_from_a_result_folder_and_is_another_run_than_one_from_elsewhere(tmp_path: Path) -> None:
    scene = load_scene("annulus-lift", {"mesh.nodes": 500})
    first = run(scene, method="tension-field", out=tmp_path / "first")
    start = load_scene("annulus-lift", {"mesh.nodes": 500, "start.from": str(tmp_path / "first")})
    again = run(start, method="tension-field", out=tmp_path / "again")
    assert again.steps == 0 and first.steps > 0
    np.testing.assert_allclose(again.r, first.r, rtol=0.0, atol=1e-12)
    # the start is part of what names a run: another state in the same folder is another run
    assert run(start, method="tension-field", out=tmp_path / "again").steps == 0
    run(scene, method="tension-field", tolerance=1e-3, out=tmp_path / "first", force=True)
    with pytest.raises(FolderRefused, match="another scene, mesh or setting"):
        run(start, method="tension-field", out=tmp_path / "again")


def test_a_start_that_is_no_result_folder_is_refused(tmp_path: Path) -> None:
    scene = load_scene("strip-tension", {"start.from": str(tmp_path)})
    with pytest.raises(ResultError, match="holds no result"):
        run(scene, method="tension-field", out=tmp_path / "out")
    assert not (tmp_path / "out").exists()
