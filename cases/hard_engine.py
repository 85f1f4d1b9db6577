"""Hard cases below the level of scenes: meshes and starts of one's own, relaxed by the same engine."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.level import Level
from fdsolver.material import Sheet
from fdsolver.meshes import rectangle
from fdsolver.model import Model
from fdsolver.multilevel import Run
from fdsolver.problem import Problem
from fdsolver.relax import Settings, begin
from fdsolver.result import Solution
from fdsolver.solution import assemble
from fdsolver.stability import relax_to_stable
from fdsolver.warm import compile_kernels

SILICONE = Sheet(young_MPa=1.0, poisson=0.5, thickness_mm=0.1)
WIDTH, HEIGHT = 101.6, 254.0  # mm, the silicone strip of the paper


def pulled_strip(pull: float, nodes: int, sheet: Sheet = SILICONE, perturbation: float = 1e-6) -> Problem:
    """The silicone strip, its top edge moved up by `pull` times its height."""
    edges = {
        "bottom": EdgeCondition("pinned"),
        "top": EdgeCondition("pinned", move_mm=(0.0, pull * HEIGHT, 0.0)),
    }

    def grid(count: int) -> Grid:
        return rectangle(WIDTH, HEIGHT, count, bias=1.0)

    return Problem(sheet, edges, grid(nodes), grid, perturbation=perturbation)


def relax_from(
    problem: Problem,
    model: Model,
    settings: Settings,
    start: Callable[[Level], np.ndarray] = Level.start,
    mass_factor: float = 1.0,
) -> Solution:
    """Relax on one mesh from a start of one's own; the driver of scenes always begins from the interpolated one.

    start : from the level to scaled positions (3, ni, nj). mass_factor : of all nodal masses.
    """
    seconds_compile = compile_kernels(problem, model, settings.threads)
    level = Level(problem, model, problem.grid, settings.threads)
    run = Run(state=begin(start(level)))
    run.state.mass_factor = mass_factor
    status, stability = relax_to_stable(level, run.state, settings)
    run.seconds = run.cpu_seconds = run.state.seconds
    run.finish_level(level)
    return assemble(model, settings, level, status, stability, run, seconds_compile)
