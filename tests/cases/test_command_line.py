"""The command line: what starts at once, exit codes, sentences, and that nothing is written by a mistake."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

from cases import __main__ as command_line
from cases.__main__ import main
from cases.arguments import LATER
from cases.progress import display, fraction_done, orders, time_left
from cases.scene import scene_names
from fdsolver.checkpoint import StorageError
from fdsolver.relax import Progress
from fdsolver.result import Status


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


def test_help_comes_before_anything_heavy_is_imported(project):
    script = (
        "import sys, cases.__main__ as c\n"
        "try: c.main(['--help'])\n"
        "except SystemExit as end: assert end.code == 0\n"
        "print(sorted({'numpy', 'numba', 'pydantic', 'rich', 'matplotlib'} & set(sys.modules)), file=sys.stderr)"
    )
    environment = {**os.environ, "PYTHONPATH": str(project)}
    ended = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True
    )
    assert ended.stderr.strip() == "[]"
    for command in ("list", "run", "compare", "report", "doctor", "plan", "cost", "hard", "study"):
        assert f"    {command} " in ended.stdout


def test_help_answers_within_half_a_second(project):
    def seconds():
        started = time.perf_counter()
        assert wrinkle(project, "--help").returncode == 0
        return time.perf_counter() - started

    # the best of three: the contract is about the command, not about what else the machine does
    assert min(seconds() for _ in range(3)) < 0.5


def test_list_has_every_scene_with_methods_and_nodes(capsys):
    assert main(["list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["scene", *scene_names()]
    annulus = next(line for line in lines if line.startswith("annulus "))
    assert "Twist and pull-out" in annulus and "tension-field" in annulus and annulus.endswith(" 20000")


@pytest.mark.parametrize("command", LATER)
def test_commands_of_later_versions_say_so(here, capsys, command):
    assert main([command, "annulus", "--accuracy", "1%"]) == 2
    assert (
        capsys.readouterr().err
        == f"wrinkle: `wrinkle {command}` ({LATER[command]}) is not part of this version yet\n"
    )


@pytest.mark.parametrize("method", ["koiter-published", "buckling", "postbuckling"])
def test_methods_of_later_versions_say_so(here, capsys, method):
    assert main(["run", "annulus", "--method", method]) == 2
    assert f"--method = {method}: is not part of this version yet" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([""], 'there is no command ""; there are list, run'),
        (["rnu"], 'there is no command "rnu"; did you mean "run"?; there are list, run'),
        (["run"], "the following arguments are required: SCENE, --method"),
        (["run", "annulus"], "the following arguments are required: --method"),
        (
            ["run", "annulus", "--metod", "koiter"],
            'wrinkle run has no option "--metod"; did you mean "--method"?',
        ),
        (["run", "annulus", "--method"], "argument --method: expected one argument"),
        (["run", "annulus", "more", "--method", "koiter"], "unrecognized arguments: more"),
        (["run", "annulus", "--method", "koitr"], '"exact"; did you mean "koiter"?'),
        (
            ["run", "annulus", "--method", "koiter", "--accuracy", "1%"],
            "not part of this version yet: --accuracy",
        ),
        (
            ["run", "anulus", "--method", "koiter"],
            'anulus: there is no scene or file of this name; did you mean "annulus"?',
        ),
        (["report", "--quick", "--full"], "argument --full: not allowed with argument --quick"),
        (["report", "--scenes", ","], '--scenes = ",": must be names separated by commas'),
        (["report", "--scenes", "nowhere"], "nowhere"),
        (["compare", "annulus", "--methods", "koiter,membrne"], '--method = "membrne": must be'),
        (
            ["run", "annulus", "--method", "koiter", "--out", ""],
            '--out = "": must be a folder that can be made',
        ),
        (
            ["run", "annulus", "--method", "koiter", "--set", "symmetry.reduce=half-x"],
            "comes with a later version",
        ),
        (
            ["run", "annulus", "--method", "koiter", "--set", "start.from=mode:1"],
            "comes with a later version",
        ),
        (["run", "hole", "--method", "exact"], "has no closed form"),
    ],
)
def test_mistakes_exit_2_with_a_sentence_and_write_nothing(here, capsys, words, sentence):
    assert main(words) == 2
    output = capsys.readouterr()
    assert sentence in output.err
    assert all(line.startswith("wrinkle: ") for line in output.err.splitlines())
    assert list(here.iterdir()) == []


@pytest.mark.parametrize(
    ("option", "value", "sentence"),
    [
        ("--nodes", "1", "--nodes = 1: must be a whole number from 400 to 50000000; the nearest is 400"),
        (
            "--nodes",
            "1000000000",
            "--nodes = 1000000000: must be a whole number from 400 to 50000000; the nearest is 50000000",
        ),
        ("--nodes", "many", '--nodes = "many": must be a whole number from 400 to 50000000'),
        ("--nodes", "9" * 30, '--nodes = "' + "9" * 30 + '": must be a whole number from 400 to 50000000'),
        ("--nodes", "1e4", '--nodes = "1e4": must be a whole number from 400 to 50000000'),
        (
            "--seed",
            "-1",
            "--seed = -1: must be a whole number from 0 to 9223372036854775807; the nearest is 0",
        ),
        ("--threads", "0", "--threads = 0: must be a whole number from 1 to 1024; the nearest is 1"),
        ("--tol", "nan", '--tol = "nan": must be a residual from 1e-14 to 0.1'),
        ("--tol", "small", '--tol = "small": must be a residual from 1e-14 to 0.1'),
    ],
)
def test_wrong_numbers_earn_their_sentences(here, capsys, option, value, sentence):
    assert main(["run", "annulus", "--method", "membrane", option, value]) == 2
    assert capsys.readouterr().err == f"wrinkle: {sentence}\n"
    assert list(here.iterdir()) == []


def test_all_mistakes_of_a_command_line_are_reported_at_once(here, capsys):
    words = [
        "--nodes",
        "1",
        "--seed",
        "x",
        "--threads",
        "0",
        "--tol",
        "2",
        "--set",
        "mesh.bias=9",
        "--set",
        "a.b=1",
    ]
    assert main(["run", "annulus", "--method", "koitr", *words]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 7


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
    import cases

    first, second = cases.load_result(here / "first"), cases.load_result(here / "second")
    assert (first.r == second.r).all()
    assert (here / "first" / "scene.toml").read_text() == (here / "second" / "scene.toml").read_text()


@pytest.mark.parametrize("status", Status)
def test_exit_code_of_a_run_is_that_of_its_status(here, monkeypatch, capsys, status):
    import dataclasses

    from cases import load_scene, run, runner

    solution = run(load_scene("strip-tension"), "tension-field", nodes=400)
    ended = dataclasses.replace(solution, status=status, message=status.sentence)
    monkeypatch.setattr(runner, "run", lambda *args, **options: ended)
    code = main(["run", "strip-tension", "--method", "tension-field"])
    output = capsys.readouterr()
    assert code == status.exit_code == EXIT_CODES[status.value]
    assert f": {status.value};" in output.out
    assert (status.sentence in output.err) == (code != 0)
    assert ("--resume" in output.err) == (status is Status.INTERRUPTED)


EXIT_CODES = {
    "converged": 0,
    **dict.fromkeys(["step_limit", "time_limit", "stalled", "diverged", "not_finite"], 3),
    **dict.fromkeys(["unstable_flat", "hourglass", "zone_inverted", "outside_validity"], 4),
    **dict.fromkeys(["under_resolved", "not_justified"], 4),
    "interrupted": 130,
}


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
    from cases import runner

    def fail(*_, **__):
        raise error

    monkeypatch.setattr(runner, "run", fail)
    assert main(["run", "strip-tension", "--method", "tension-field"]) == code
    assert sentence in capsys.readouterr().err


def test_errors_of_our_own_keep_their_traceback(here, monkeypatch):
    monkeypatch.setattr(command_line, "_command", lambda arguments: {}["no such key"])
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
        "80000",
        "--tol",
        "1e-14",
        "--out",
        "it",
    ]
    environment = {**os.environ, "PYTHONPATH": str(project)}
    process = subprocess.Popen(
        [sys.executable, "-m", "cases", *words], env=environment, stderr=subprocess.PIPE, text=True
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


def test_doctor_reports_versions_cores_and_cache(capsys):
    assert main(["doctor"]) == 0
    output = capsys.readouterr().out
    for word in ("numpy", "numba", "cores", "threads", "cache", "nothing is missing"):
        assert word in output


def test_doctor_names_what_is_missing(monkeypatch, capsys):
    from cases import doctor

    monkeypatch.setattr(doctor, "NEEDED", ("numpy", "no_such_package"))
    assert main(["doctor"]) == 1
    assert "missing: no_such_package is not installed" in capsys.readouterr().out


def test_no_progress_is_shown_where_nobody_watches(capsys):
    with display() as progress:
        assert progress is None


def test_progress_is_shown_on_a_terminal(monkeypatch, capsys):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    with display() as progress:
        progress(report(0, 1e-2, 0.0))
        progress(report(100, 1e-4, 2.0))
        task = progress._bars.tasks[0]
        assert task.completed == pytest.approx(1 / 3)  # two of six orders of magnitude
        assert task.fields["left"] == "4 s left on this mesh"


def report(step: int, residual: float, seconds: float) -> Progress:
    return Progress(1, 2, 1000, step, residual, 1e-8, 50.0, seconds)


def test_progress_is_measured_in_orders_of_magnitude():
    first = report(0, 1e-2, 0.0)
    assert fraction_done(first, report(1, 1e-5, 1.0)) == pytest.approx(0.5)
    assert fraction_done(first, report(1, 1.0, 1.0)) == 0.0
    assert fraction_done(first, report(1, 1e-9, 1.0)) == 1.0
    assert fraction_done(report(0, 1e-9, 0.0), report(1, 1e-9, 1.0)) == 1.0
    assert time_left(first, report(1, 1e-5, 3.0)) == "3 s left on this mesh"
    assert time_left(first, report(1, 1e-5, 300.0)) == "5 min left on this mesh"
    assert time_left(first, report(1, 0.9e-2, 3.0)) == "time left unknown"
    assert orders(float("nan"), 1.0) == orders(0.0, 1.0) == 0.0
