"""Compilation ahead of the solve, so that its seconds are not counted as the solver's."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from fdsolver.finish import finish, suits
from fdsolver.grid import Grid
from fdsolver.level import in_space, make_level
from fdsolver.model import Model
from fdsolver.planar import lowest_out_of_plane
from fdsolver.problem import Problem
from fdsolver.reduced import mirrored_part
from fdsolver.relax import Settings, begin, relax
from fdsolver.spatial import examinable, lowest_in_space
from fdsolver.stability import search


def compile_kernels(problem: Problem, model: Model, threads: int) -> float:
    """Run a few steps on a tiny mesh of the problem's kind; returns the seconds that took.

    On a machine that has compiled these kernels before they are loaded from the disk cache.
    """
    started = time.perf_counter()
    tiny = replace(problem, edges={}, symmetry=None)
    level = make_level(tiny, model, _square(7), threads)
    state = begin(level.scaled(1.01 * level.flat))
    relax(level.force, ~level.fixed, level.weight, state, Settings(max_steps=20, threads=threads))
    if suits(level, Settings()):
        # a quarter of it has more nodes than the smallest parts of a factor, so that parts are joined too
        larger = make_level(tiny, model, _square(19), threads)
        finish(
            larger, mirrored_part(larger), begin(larger.scaled(1.01 * larger.flat)), Settings(tolerance=1e-12)
        )
    if not model.relaxed:
        space = level
        if not model.out_of_plane:
            space = make_level(tiny, replace(model, out_of_plane=True), level.grid, 1)
        lowest_out_of_plane(
            space.examined, np.ascontiguousarray(np.moveaxis(in_space(state.r), -1, 0)), ~level.fixed, 0
        )
        if model.out_of_plane:
            search(level.force, state)
        if examinable(level.examined):
            lowest_in_space(level.examined, state.r, level.scaled(level.flat), level.weight, 0)
    return time.perf_counter() - started


def _square(lines: int) -> Grid:
    """A square of side 1 mm with this many mesh lines in each direction."""
    line = np.linspace(0.0, 1.0, lines)
    u = np.stack(np.meshgrid(line - 0.5, line - 0.5, indexing="ij"), axis=-1)
    left = np.stack([np.zeros(lines, dtype=np.int64), np.arange(lines)], axis=1)
    return Grid("rectangle", u, False, {"left": left}, line, line.copy(), 1.0)
