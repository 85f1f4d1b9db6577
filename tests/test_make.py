"""The Makefile's sentence for an old Python, and the script of continuous integration."""

from __future__ import annotations

import os
import shutil
import subprocess

import pytest

pytestmark = pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")


def program(path, text):
    path.write_text("#!/usr/bin/env bash\n" + text)
    path.chmod(0o755)
    return path


def test_old_python_is_refused_in_a_sentence(project, tmp_path):
    for name in ["Makefile", "pyproject.toml", "constraints.txt"]:
        shutil.copy(project / name, tmp_path)
    old = program(tmp_path / "python3.9", '[ "$1" = -V ] && echo "Python 3.9.1" && exit 0; exit 1\n')
    for python, sentence in [(old, "python3.9 is Python 3.9.1"), (tmp_path / "absent", "no ")]:
        done = subprocess.run(
            ["make", "test", f"PYTHON={python}"], cwd=tmp_path, capture_output=True, text=True, timeout=60
        )
        assert done.returncode != 0
        assert "wrinklebench needs Python 3.11 or newer" in done.stdout and sentence in done.stdout
        assert not (tmp_path / ".venv").exists()


@pytest.mark.parametrize(
    ("output", "code", "closing"),
    [
        ("===== 3 passed, 1 deselected in 75.02s (0:01:15) =====", 0, "===== 3 passed, 1 deselected in"),
        ("===== 1 failed, 2 passed in 1.02s =====", 2, "===== 1 failed, 2 passed in 1.02s ====="),
        ("Traceback: no module", 1, "pytest did not finish"),
    ],
)
def test_continuous_integration_ends_with_the_closing_line(project, tmp_path, output, code, closing):
    (tmp_path / ".ci").mkdir()
    shutil.copy(project / ".ci" / "run", tmp_path / ".ci")
    tools = tmp_path / "tools"
    tools.mkdir()
    program(tools / "make", f'echo "$@"; echo "{output}"; echo "make: the end"; exit {code}\n')
    path = f"{tools}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        [tmp_path / ".ci" / "run"],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        timeout=60,
    )
    lines = done.stdout.splitlines()
    assert done.returncode == code
    assert lines[0].split()[-2:] == ["lint", "test"]
    assert lines[-1].startswith(closing)
