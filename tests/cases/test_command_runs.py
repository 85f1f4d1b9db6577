"""What the commands do: folders, exit codes, interruption, and failures that are not the user's."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
import time

import pytest

import cases
from cases import __main__ as command_line
from cases import runner
from cases.__main__ import main
from fdsolver.checkpoint import StorageError
from fdsolver.result import Status

EXIT_CODES = {
    "converged": 0,
    **dict.fromkeys(["step_limit", "time_limit", "stalled", "diverged", "not_finite"], 3),
    **dict.fromkeys(["unstable_flat", "hourglass", "zone_inverted", "outside_validity"], 4),
    **dict.fromkeys(["under_resolved", "not_justified"], 4),
    "interrupted": 130,
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def wrinkle(project, *words, **options):
    """The command in a process of its own."""
    environment = {**os.environ, "PYTHONPATH": str(project)}
    return subprocess.run(
        [sys.executable, "-m", "cases", *words], env=environment, capture_output=True, text=True, **options
    )


def test_compare_prints_methods_side_by_side_and_their_differences(here, capsys):
    words = [
        "compare",
        "annulus-shrink",
        "--methods",
        "tension-field,exact",
        "--nodes",
        "400",
        "--out",
        "both",
    ]
    assert main(words) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["method", "tension-field", "exact"]
    assert next(line for line in lines if line.startswith("status")).split()[1:] == ["converged", "converged"]
    assert "differences from exact" in lines and lines[-1] == "both"
    assert {path.name for path in (here / "both").iterdir()} >= {"compare.csv", "tension-field", "exact"}


def test_compare_says_which_method_it_left_out(here, capsys):
    words = ["compare", "hole", "--methods", "exact,tension-field", "--nodes", "400", "--out", "both"]
    assert main(words) == 0
    assert "warning: exact was left out: The scene hole has no closed form" in capsys.readouterr().err


def test_folder_that_is_a_file_is_refused_before_the_solve(here, capsys):
    (here / "taken").write_text("mine")
    assert main(["run", "annulus", "--method", "tension-field", "--out", "taken/deeper"]) == 2
    assert "is a file" in capsys.readouterr().err
    assert (here / "taken").read_text() == "mine"


def test_run_solves_into_its_folder_and_refuses_to_replace_another_result(here, capsys):
    words = ["run", "strip-tension", "--method", "tension-field"]
    assert main([*words, "--nodes", "400"]) == 0
    output = capsys.readouterr()
    assert output.out.startswith("runs/strip-tension-tension-field: converged; ")
    stored = (here / "runs" / "strip-tension-tension-field" / "result.json").read_bytes()
    # the same run is not solved again, another one is refused
    assert main([*words, "--nodes", "400"]) == 0
    assert main([*words, "--nodes", "500"]) == 2
    assert "--force replaces it" in capsys.readouterr().err
    assert (here / "runs" / "strip-tension-tension-field" / "result.json").read_bytes() == stored
    assert main([*words, "--nodes", "500", "--force"]) == 0


def test_resolved_scene_runs_again_to_the_same_answer(here):
    assert (
        main(["run", "strip-tension", "--method", "tension-field", "--nodes", "400", "--out", "first"]) == 0
    )
    assert main(["run", "first/scene.toml", "--method", "tension-field", "--out", "second"]) == 0
    first, second = cases.load_result(here / "first"), cases.load_result(here / "second")
    assert (first.r == second.r).all()
    assert (here / "first" / "scene.toml").read_text() == (here / "second" / "scene.toml").read_text()


@pytest.mark.parametrize("status", Status)
def test_exit_code_of_a_run_is_that_of_its_status(here, monkeypatch, capsys, status):
    solution = cases.run(cases.load_scene("strip-tension"), "tension-field", nodes=400)
    ended = dataclasses.replace(solution, status=status, message=status.sentence)
    monkeypatch.setattr(runner, "run", lambda *args, **options: ended)
    code = main(["run", "strip-tension", "--method", "tension-field"])
    output = capsys.readouterr()
    assert code == status.exit_code == EXIT_CODES[status.value]
    assert f": {status.value};" in output.out
    assert (status.sentence in output.err) == (code != 0)
    assert ("--resume" in output.err) == (status is Status.INTERRUPTED)


@pytest.mark.parametrize(
    ("error", "code", "sentence"),
    [
        (KeyboardInterrupt(), 130, "goes on"),
        (MemoryError(), 1, "not enough memory; ask for fewer nodes"),
        (StorageError("Could not write runs: No space left on device."), 1, "No space left on device."),
        (OSError(28, "No space left on device", "runs"), 1, "runs: No space left on device"),
    ],
)
def test_failures_of_the_machine_are_sentences_too(here, monkeypatch, capsys, error, code, sentence):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(runner, "run", fail)
    assert main(["run", "strip-tension", "--method", "tension-field"]) == code
    assert sentence in capsys.readouterr().err


def test_errors_of_our_own_keep_their_traceback(here, monkeypatch):
    monkeypatch.setattr(command_line, "_command", lambda *_: {}["no such key"])
    with pytest.raises(KeyError):
        main(["list"])


def test_reader_that_goes_away_is_no_error(project):
    environment = {**os.environ, "PYTHONPATH": str(project)}
    process = subprocess.Popen(
        [sys.executable, "-m", "cases", "list"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    process.stdout.close()
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 0 and errors == b""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_run_exits_130_and_goes_on(project, here, number):
    # a tolerance that is never reached: the run is still going when it is interrupted
    words = [
        "run",
        "annulus",
        "--method",
        "tension-field",
        "--nodes",
        "40000",
        "--tol",
        "1e-14",
        "--out",
        "it",
    ]
    environment = {**os.environ, "PYTHONPATH": str(project)}
    process = subprocess.Popen(
        [sys.executable, "-m", "cases", *words],
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        # a shell starts background jobs with SIGINT ignored, and children inherit that
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 200.0
    while not (here / "it" / "scene.toml").exists():
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < deadline, "the run never began"
        time.sleep(0.05)
    time.sleep(1.0)
    process.send_signal(number)
    _, errors = process.communicate(timeout=200)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    assert "--resume" in errors or "goes on" in errors
    ended = wrinkle(project, *words, "--set", "solver.max_seconds=0.2", "--resume", cwd=here)
    assert ended.returncode == 3, ended.stderr  # it goes on, to the new time limit
    assert ended.stdout.startswith("it: time_limit; ")
