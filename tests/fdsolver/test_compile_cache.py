"""The compile cache belongs to one state of the sources."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fdsolver import compile_cache


def test_an_edit_of_any_kernel_source_moves_the_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for package in compile_cache.PACKAGES:
        (tmp_path / package).mkdir()
        (tmp_path / package / "kernel.py").write_text("one = 1\n")
    monkeypatch.setattr(compile_cache, "__file__", str(tmp_path / "fdsolver" / "compile_cache.py"))
    before = compile_cache.folder()
    assert compile_cache.folder() == before
    for package in compile_cache.PACKAGES:
        (tmp_path / package / "kernel.py").write_text(f"one = 2  # {package}\n")
        after = compile_cache.folder()
        assert after != before
        before = after


@pytest.mark.parametrize("given", [None, "elsewhere"])
def test_numba_uses_the_cache_unless_told_otherwise(given: str | None, tmp_path: Path) -> None:
    environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
    environment["XDG_CACHE_HOME"] = str(tmp_path)
    if given is not None:
        environment["NUMBA_CACHE_DIR"] = str(tmp_path / given)
    code = "import fdsolver, numba; print(numba.config.CACHE_DIR)"
    root = Path(compile_cache.__file__).parent.parent
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, cwd=root, capture_output=True, text=True
    )
    expected = tmp_path / given if given else tmp_path / "wrinklebench" / compile_cache.folder().name
    assert run.stdout.strip() == str(expected), run.stderr
