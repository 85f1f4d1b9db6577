"""What several tests of runs and comparisons start from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from cases import load_scene, run
from cases.methods import METHODS, Task
from fdsolver.result import Solution
from tests.cases.made import Fake


@pytest.fixture(scope="module", name="solved")
def _solved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Solution, Path]:
    """The turned annulus by tension field, coarse, in a folder."""
    out = tmp_path_factory.mktemp("runs") / "annulus"
    return run(load_scene("annulus"), method="tension-field", nodes=900, seed=3, out=out), out


@pytest.fixture(name="faked")
def _faked(monkeypatch: pytest.MonkeyPatch) -> Fake:
    """Put a function in the place of a solver."""

    def fake(solve: Callable[[Task], Solution], name: str = "tension-field") -> None:
        monkeypatch.setitem(METHODS, name, replace(METHODS[name], solve=solve))

    return fake
