from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import cases
import reports.command as command
from fdsolver.result import Status
from reports.plan import report_runs
from reports.run import ReportRun
from reports.stored import refusal_path
from tests.reports.synthetic import write_synthetic

RUN = ReportRun("hole-x", "hole", "tension-field", 400, 800)


def test_report_without_solver_draws_what_is_there(monkeypatch, tmp_path, capsys):
    def solve(scene, method, nodes, out, **_):
        if method == "koiter":
            raise ValueError("no plate today")
        run = next(r for r in report_runs(scenes=["strip-tension"]) if r.method == method)
        write_synthetic(out, run, 400)
        return SimpleNamespace(status=Status.CONVERGED)

    monkeypatch.setattr(cases, "run", solve, raising=False)
    assert command.report(tmp_path, scenes=["strip-tension"]) == 0
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "strip-tension-koiter. refused: no plate today" in page
    assert "2 of 3" in page  # converged
    assert (tmp_path / "report.pdf").stat().st_size > 10_000  # an empty document has about 1 kB
    assert str(tmp_path / "index.html") in capsys.readouterr().out


def test_quick_and_full_results_do_not_meet(monkeypatch, tmp_path):
    ran, drawn = [], []
    monkeypatch.setattr(command, "report_runs", lambda full, scenes: [RUN])
    monkeypatch.setattr(command, "run_case", lambda run, folder, nodes, *_: ran.append((folder, nodes)))
    monkeypatch.setattr(command, "render", lambda out, runs, folder, *_: drawn.append(folder / "hole-x"))
    for full in (False, True):
        command.report(tmp_path, full)
    assert [nodes for _, nodes in ran] == [400, 800]
    assert [folder for folder, _ in ran] == drawn
    assert drawn[0] != drawn[1]


def test_older_result_of_the_reports_own_folder_is_replaced(monkeypatch, tmp_path):
    calls = []

    def solve(scene, method, force, **_):
        calls.append(force)
        if not force:
            raise ValueError("the folder holds a result of another scene")
        return SimpleNamespace(status=Status.CONVERGED)

    monkeypatch.setattr(cases, "run", solve, raising=False)
    folder = tmp_path / "hole-x"
    folder.mkdir()
    command.run_case(RUN, folder, 400, 10.0)
    assert calls == [False, True]
    assert not refusal_path(folder).exists()


def test_refusal_goes_when_the_run_succeeds(monkeypatch, tmp_path):
    folder = tmp_path / "hole-x"
    command.note_refusal(folder, "refused", "earlier")
    monkeypatch.setattr(cases, "run", lambda *a, **k: SimpleNamespace(status=Status.CONVERGED), raising=False)
    command.run_case(RUN, folder, 400, 10.0)
    assert not refusal_path(folder).exists()


def test_interrupted_run_ends_the_report(monkeypatch, tmp_path):
    monkeypatch.setattr(
        cases, "run", lambda *a, **k: SimpleNamespace(status=Status.INTERRUPTED), raising=False
    )
    with pytest.raises(KeyboardInterrupt):
        command.run_case(RUN, tmp_path / "hole-x", 400, 10.0)


def test_run_that_found_no_time_is_noted(monkeypatch, tmp_path):
    monkeypatch.setattr(cases, "run", lambda *a, **k: pytest.fail("was run"), raising=False)
    command.run_case(RUN, tmp_path / "hole-x", 400, 0.5)
    note = json.loads(refusal_path(tmp_path / "hole-x").read_text(encoding="utf-8"))
    assert note == {
        "status": "not run",
        "message": "The time of the report was used up before this run began.",
    }


def test_limit_of_a_run_is_what_is_left_of_the_report(monkeypatch, tmp_path):
    limits = []
    monkeypatch.setattr(command, "run_case", lambda run, folder, nodes, limit, progress: limits.append(limit))
    monkeypatch.setattr(command, "QUICK_SECONDS", 15.0)
    command.run_cases([RUN], tmp_path, False)
    assert 14.0 < limits[0] <= 15.0


def test_wrong_override_is_a_refusal(tmp_path):
    run = ReportRun("x", "hole", "koiter", 400, 400, {"edges.top.mvoe_mm": [0.0, 1.0, 0.0]})
    command.run_case(run, tmp_path / "x", 400, 10.0)
    assert "mvoe_mm" in refusal_path(tmp_path / "x").read_text(encoding="utf-8")


def test_every_planned_scene_and_override_loads():
    for run in report_runs(True):
        assert cases.load_scene(run.scene, run.overrides).name == run.scene


def test_report_has_every_scene_of_this_version():
    verified = {"annulus-lift", "annulus-twist", "annulus-shrink", "strip-tension", "shear-rails"}
    for full in (False, True):
        assert {run.scene for run in report_runs(full)} == {"annulus", "hole", "stretch", "shear"} | verified
    assert {run.scene for run in report_runs(scenes=["hole"])} == {"hole"}
    with pytest.raises(ValueError, match="no scene wormhole; it has annulus"):
        report_runs(scenes=["wormhole"])


def test_drawing_library_is_loaded_only_to_draw():
    code = "import sys, reports.command, reports.build; sys.exit('matplotlib' in sys.modules)"
    project = Path(__file__).parents[2]
    assert subprocess.run([sys.executable, "-c", code], cwd=project).returncode == 0


def test_only_the_running_step_names_the_solver():
    for path in (Path(__file__).parents[2] / "reports").glob("*.py"):
        names = {
            alias.name
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Import)
            for alias in node.names
        }
        assert "cases" not in names or path.name == "command.py"
