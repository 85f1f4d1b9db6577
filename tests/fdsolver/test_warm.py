"""Kernels are compiled before the seconds of a solve begin to count."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOLVE = """
import sys
from numba.core import event
from cases import load_scene
from cases.boundary import problem_of, settings_of
from cases.methods import METHODS
from cases import effects
from fdsolver import multilevel

late, warming = [], [False]
compile_kernels = multilevel.compile_kernels


def warm(*words):
    warming[0] = True
    seconds = compile_kernels(*words)
    warming[0] = False
    return seconds


class Listener(event.Listener):
    def on_start(self, found):
        pass

    def on_end(self, found):
        if not warming[0]:
            late.append(found.data["dispatcher"].py_func.__name__)


multilevel.compile_kernels = warm
name, nodes = sys.argv[2], int(sys.argv[3])
scene = load_scene(sys.argv[1], {"mesh.nodes": nodes})
model, _ = effects.decide(scene, METHODS[name].model())
problem, settings = problem_of(scene, model, seed=0), settings_of(scene, 1e-8)
event.register("numba:compile", Listener())
solution = multilevel.solve(problem, model, settings)
print(solution.status.value, sorted(set(late)))
"""


@pytest.mark.parametrize(
    ("scene", "method"), [("hole", "tension-field"), ("annulus", "tension-field"), ("stretch", "koiter")]
)
def test_nothing_is_compiled_during_a_solve(scene: str, method: str, project: Path, tmp_path: Path) -> None:
    """With an empty cache, where the finisher is needed and where one ray is solved."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", SOLVE, scene, method, "1000"]
    found = subprocess.run(command, cwd=project, env=environment, capture_output=True, text=True, check=True)
    assert found.stdout.strip().splitlines()[-1] == "converged []"
