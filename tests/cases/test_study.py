"""Studies as they run: every point in a process of its own, dead ones noted, finished ones kept, one table."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pandas as pd
import pytest

from cases.__main__ import main
from cases.scene import load_scene, scene_toml
from cases.study import run_study
from cases.study_file import load_study
from cases.study_worker import LOGS, note_path

# a plate that is not finished before it is killed, beside a point that needs no iteration
STUDY = '[study]\nscene = "scene.toml"\nmethods = ["koiter", "exact"]\nnodes = [40000]\n'
PATIENCE = 200.0  # seconds: a worker may have to compile its kernels on a busy machine


def make_scene(folder, max_seconds):
    endless = {
        "solver.tolerance": 1e-14,
        "start.perturbation": 1e-3,
    }  # below what rounding lets the residual fall to
    scene = load_scene("strip-tension", {"solver.max_seconds": max_seconds, **endless})
    (folder / "scene.toml").write_text(scene_toml(scene), encoding="utf-8")


@pytest.fixture
def study(tmp_path):
    """A study of one long and one short point, and its folder of results."""
    make_scene(tmp_path, 1800.0)
    (tmp_path / "made.toml").write_text(STUDY, encoding="utf-8")
    return tmp_path / "made.toml", tmp_path / "results"


def wait_for(what):
    """What `what` returns once it is true."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = what()
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError("waited in vain")


def worker_of(out, method):
    """The process that solves the point of a method, as its lock says; None before it has begun its iteration."""
    for lock in (out / LOGS).glob(f"{method}*.lock"):
        words = lock.read_text().split()
        begun = (out / lock.stem / "scene.toml").exists()
        return int(words[0]) if words and begun else None
    return None


def gone(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


def begin(project, path, out):
    """`wrinkle study` in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "cases", "study", str(path), "--jobs", "2", "--out", str(out)],
        env={**os.environ, "PYTHONPATH": str(project)},
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_a_killed_worker_takes_nothing_with_it_and_its_point_goes_on(study):
    path, out = study
    found = load_study(path)
    koiter = next(point for point in found.points if point.method == "koiter")
    lines = []

    def say(line):
        lines.append(line)
        if "exact" in line:
            os.kill(wait_for(lambda: worker_of(out, "koiter")), signal.SIGKILL)

    table = run_study(found, out, jobs=2, say=say).set_index("method")
    assert table.loc["exact", "status"] == "converged"
    assert table.loc["koiter", "status"] == "died"
    assert "signal 9 (SIGKILL)" in table.loc["koiter", "message"]
    assert len(lines) == 2

    make_scene(path.parent, 1.0)  # a limit is not part of a point's identity: it goes on in the same folder
    again = load_study(path)
    assert {point.name for point in again.points} == {point.name for point in found.points}
    before = (out / again.points[1].name / "result.json").stat().st_mtime_ns
    table = run_study(again, out, jobs=1).set_index("method")
    assert table.loc["koiter", "status"] == "time_limit"
    assert not note_path(out, koiter.name).exists()
    assert (out / again.points[1].name / "result.json").stat().st_mtime_ns == before, (
        "a finished point was solved again"
    )
    stored = pd.read_csv(out / "study.csv").set_index("method")
    assert stored.loc["exact", "energy_N_mm.total"] == pytest.approx(
        table.loc["exact", "energy_N_mm.total"], rel=1e-15
    )
    assert stored["stretch.major_max"].notna().all()


def test_workers_end_with_a_killed_study(study, project):
    path, out = study
    running = begin(project, path, out)
    try:
        worker = wait_for(lambda: worker_of(out, "koiter"))
        running.kill()
        running.communicate()
        assert wait_for(lambda: gone(worker))
    finally:
        running.kill()
        running.communicate()


def test_an_interrupted_study_leaves_no_worker_and_says_how_to_go_on(study, project):
    path, out = study
    running = begin(project, path, out)
    try:
        worker = wait_for(lambda: worker_of(out, "koiter"))
        running.send_signal(signal.SIGINT)
        said = running.communicate(timeout=PATIENCE)[1]
    finally:
        running.kill()
        running.communicate()
    assert running.returncode == 130
    assert "interrupted; finished results are kept" in said and f"wrinkle study {path}" in said
    assert gone(worker)
    table = pd.read_csv(out / "study.csv").set_index("method")
    assert table.loc["koiter", "status"] in ("interrupted", "not run")


def test_a_refused_point_and_a_finished_one_stand_in_one_table(tmp_path, capsys):
    path = tmp_path / "made.toml"
    path.write_text(
        '[study]\nscene = "annulus"\nmethods = ["exact"]\nnodes = [900]\n'
        "[[point]]\nedges.inner.rotate_deg = 90\n"
        "[[point]]\nedges.inner.rotate_deg = 90\nedges.outer.support = 'free'\n",
        encoding="utf-8",
    )
    assert main(["study", str(path), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    said = capsys.readouterr()
    assert "2 points; " in said.out and "1 converged" in said.out and "1 refused" in said.out
    table = pd.read_csv(tmp_path / "out" / "study.csv")
    assert list(table["status"]) == ["converged", "refused"]
    assert list(table["edges.inner.rotate_deg"]) == [90, 90]
    # the annulus at 90 degrees is wrinkled somewhere between its circles
    assert 62.5 < table["paths.radius.wrinkled_from_mm"][0] < table["paths.radius.wrinkled_to_mm"][0] < 250.0


def test_slurm_is_refused_where_it_is_not_installed(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "submitit", None)  # as if it were not installed
    path = tmp_path / "made.toml"
    path.write_text('[study]\nscene = "annulus"\nmethods = ["exact"]\nnodes = [900]\n', encoding="utf-8")
    assert main(["study", str(path), "--cluster", "slurm", "--out", str(tmp_path / "out")]) == 2
    assert (
        "--cluster slurm needs submitit; install it with: pip install 'wrinklebench[cluster]'"
        in capsys.readouterr().err
    )


def test_mistakes_of_file_and_options_are_reported_together(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["study", "nowhere.toml", "--jobs", "0", "--cluster", "slrm"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 3
    assert said[2] == 'wrinkle: --cluster = "slrm": must be "slurm"; did you mean "slurm"?'
    assert list(tmp_path.iterdir()) == []
