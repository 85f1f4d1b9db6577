"""The command line: what starts at once, exit codes, sentences, and that nothing is written by a mistake."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest

from cases.__main__ import main
from cases.scene import scene_names


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
            ["run", "annulus", "--method", "koiter", "--accuracy", "1%", "--nodes", "900"],
            "--nodes = 900: --accuracy chooses the nodes; give one of the two",
        ),
        (
            ["run", "annulus", "--method", "koiter", "--accuracy", "most"],
            '--accuracy = "most": must be a relative error from 0.0001% to 50%, as 1% or 0.01',
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
            "is not loaded symmetrically",
        ),
        (
            ["run", "annulus", "--method", "koiter", "--set", "start.from=mode:1"],
            "has no mode to start from: an edge of the scene annulus moves along z",
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
        ("--tol", "0", '--tol = "0": must be a residual from 1e-14 to 0.1'),
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
