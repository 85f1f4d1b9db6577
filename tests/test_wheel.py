"""The built wheel, installed on its own outside the checkout, has all that the command needs."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest


def run(*command: str | Path, cwd: Path) -> str:
    """Output of a command that has to succeed, run where nothing of the checkout can be imported."""
    clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
    done = subprocess.run(
        [*map(str, command)], cwd=cwd, env=clean, capture_output=True, text=True, timeout=240
    )
    assert done.returncode == 0, f"{command} exited {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def wheel(project, tmp_path_factory):
    """The wheel of a copy of the tracked source, so that no left-over build folder gets in."""
    pytest.importorskip("setuptools", minversion="77")
    source = tmp_path_factory.mktemp("source")
    for name in ["pyproject.toml", "README.md", "LICENSE"]:
        (source / name).write_bytes((project / name).read_bytes())
    for package in ["fdsolver", "tensionfield", "femref", "cases", "reports"]:
        for path in (project / package).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                target = source / path.relative_to(project)
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(path.read_bytes())
    build = "from setuptools import build_meta; print(build_meta.build_wheel('.'))"
    name = run(sys.executable, "-c", build, cwd=source).split()[-1]
    return source / name


def test_wheel_holds_every_source_and_data_file_and_nothing_else(project, wheel):
    packed = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    wanted = set()
    for package in ["fdsolver", "tensionfield", "femref", "cases", "reports"]:
        for path in (project / package).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                wanted.add(path.relative_to(project).as_posix())
    assert packed == wanted


def test_installed_wheel_lists_the_scenes(project, wheel, tmp_path):
    home = tmp_path / "environment"
    venv.create(home, with_pip=False)
    python = home / "bin" / "python"
    site = Path(
        run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=tmp_path).strip()
    )
    # the dependencies come from the running environment, ours only from the wheel
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    run(
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "--no-deps",
        "--no-index",
        wheel,
        cwd=tmp_path,
    )

    where = run(python, "-c", "import cases; print(cases.__file__)", cwd=tmp_path).strip()
    assert Path(where).is_relative_to(home), f"cases came from {where}"
    listing = run(home / "bin" / "wrinkle", "list", cwd=tmp_path)
    scenes = [path.stem for path in (project / "cases" / "data").glob("*.toml")]
    assert len(scenes) >= 8
    missing = [scene for scene in scenes if scene not in listing]
    assert not missing, f"`wrinkle list` does not name {missing}"
