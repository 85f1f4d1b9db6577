"""Bending only where a tension field on the same mesh says that the sheet can wrinkle: an experiment, not an effect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fdsolver.fields import TENSE
from fdsolver.grid import Grid
from fdsolver.level import Level
from fdsolver.model import KOITER, Model
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.relax import Settings
from tensionfield.relaxed import TENSION_FIELD

TOLERANCE = 1e-6  # of the tension field, which only says where the sheet is tense


def tense_zones(problem: Problem, grid: Grid) -> np.ndarray:
    """(zone rows, nj - 1) bool: tense in the tension field of a problem on a mesh."""
    flat = all(edge.move_mm[2] == 0.0 for edge in problem.edges.values())
    field = replace(TENSION_FIELD, out_of_plane=not flat)
    found = solve(
        replace(problem, grid=grid, perturbation=0.0), field, Settings(tolerance=TOLERANCE, levels=1)
    )
    return found.zone.state == TENSE


class RestrictedLevel(Level):
    """A level of the plate without bending stiffness at nodes all of whose zones are tense, and in these zones."""

    def __init__(self, problem: Problem, model: Model, grid: Grid, threads: int) -> None:
        super().__init__(problem, model, grid, threads)
        tense = tense_zones(problem, grid)
        bent = np.zeros((grid.ni, grid.nj), dtype=bool)
        for i, j in np.argwhere(~tense):
            bent[np.ix_([i, (i + 1) % grid.ni], [j, j + 1])] = True
        node, twist = self.force.node, self.force.twist
        assert node is not None and twist is not None, "the plate has bending"
        node[:6] *= bent
        twist[0] *= ~tense


RESTRICTED = replace(KOITER, level=RestrictedLevel)
