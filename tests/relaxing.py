"""A small strip to relax, shared by the tests of the relaxation loop."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from fdsolver import meshes, relax
from fdsolver.edges import EdgeCondition
from fdsolver.level import Level
from fdsolver.material import Sheet
from fdsolver.model import Model
from fdsolver.problem import Problem
from fdsolver.relax import Settings, State, begin
from fdsolver.result import Status

# thick enough that a strip pulled by 10 % stays flat, so that there is one state to find
SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=1.0)
EDGES = {"left": EdgeCondition("pinned"), "right": EdgeCondition("pinned", move_mm=(2.0, 0.5, 0.0))}
FINE = Settings(tolerance=1e-10)


def strip(model: Model) -> Level:
    """A strip of 20 mm x 12 mm, its right edge pulled and sheared."""
    grid = meshes.rectangle(20.0, 12.0, 400)
    problem = Problem(SHEET, EDGES, grid, lambda nodes: grid, perturbation=1e-3, seed=2)
    return Level(problem, model, grid, threads=1)


def relaxed(
    level: Level,
    state: State,
    settings: Settings,
    on_block: Callable[[State], None] | None = None,
    force: Any = None,
) -> Status:
    return relax.relax(force or level.force, ~level.fixed, level.weight, state, settings, on_block)


def solved(model: Model) -> tuple[Level, State]:
    level = strip(model)
    state = begin(level.start())
    assert relaxed(level, state, FINE) is Status.CONVERGED
    return level, state


@dataclasses.dataclass
class Failing:
    """A force that does something else from its n-th call on."""

    inner: Any
    call: int
    fault: Callable[[np.ndarray], None]
    calls: int = 0

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        self.calls += 1
        energy = self.inner(r, f)
        if self.calls >= self.call:
            self.fault(f)
        return energy

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)
