"""One mesh of a nested run: its force, its free nodes, its scale, and how a run starts on it."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np

from fdsolver.axisymmetry import is_axisymmetric, mean_round
from fdsolver.effects import Force, build_force
from fdsolver.grid import Grid
from fdsolver.model import Model
from fdsolver.problem import Problem
from fdsolver.result import Status
from fdsolver.start import carried_start, fixed_nodes, held_positions, perturb, smooth_start
from fdsolver.transfer import prolong

Projection = Callable[[np.ndarray], np.ndarray]


class Level:
    """A problem on one mesh, in the engine's scaled units.

    fixed : (ni, nj) bool, supported nodes.
    weight : (ni, nj) float64, L / L_n at free nodes and 0 at fixed ones (`relax.residual`).
    project : what keeps forces to the problem's symmetry, or None.
    examined : the force whose tangent tells whether an equilibrium is stable.
    """

    def __init__(self, problem: Problem, model: Model, grid: Grid, threads: int) -> None:
        self.problem = problem
        self.model = model
        self.grid = grid
        self.fixed = fixed_nodes(grid, problem.edges)
        supports = {name: condition.support for name, condition in problem.edges.items()}
        self.force: Force = build_force(grid, problem.sheet, model, supports, threads)
        self.examined: Force = self.force
        self.project: Projection | None = None
        if is_axisymmetric(problem, model):
            self.project = functools.partial(mean_round, grid)
        self.weight = ~self.fixed * (grid.length_mm / np.sqrt(grid.node_area))

    @property
    def force_unit(self) -> float:
        """Y h L, N: the engine's unit of force."""
        return self.problem.sheet.young_MPa * self.problem.sheet.thickness_mm * self.grid.length_mm

    @property
    def energy_unit(self) -> float:
        """Y h L^2, N mm: the engine's unit of energy."""
        return self.force_unit * self.grid.length_mm

    @property
    def flat(self) -> np.ndarray:
        """(ni, nj, 3), mm. The undeformed sheet."""
        return np.concatenate([self.grid.u, np.zeros((self.grid.ni, self.grid.nj, 1))], axis=-1)

    def scaled(self, r: np.ndarray) -> np.ndarray:
        """Positions (ni, nj, 3) in mm as the engine's (components, ni, nj) in lengths L."""
        return np.ascontiguousarray(np.moveaxis(r, -1, 0)[: self.model.components]) / self.grid.length_mm

    def unscaled(self, r: np.ndarray) -> np.ndarray:
        """The engine's positions (components, ni, nj) as (ni, nj, 3) in mm."""
        return in_space(r) * self.grid.length_mm

    def start(self) -> np.ndarray:
        """The interpolated start with its perturbation, (components, ni, nj) scaled."""
        grid, edges, initial = self.grid, self.problem.edges, self.problem.initial
        r = smooth_start(grid, edges) if initial is None else carried_start(grid, edges, *initial)
        return self.scaled(self._perturbed(r))

    def start_from(self, coarse: Level, r: np.ndarray) -> np.ndarray:
        """The state r of a coarser level on this mesh, with this mesh's edge positions; (components, ni, nj) scaled."""
        carried = prolong(coarse.unscaled(r) - coarse.flat, coarse.grid, self.grid) + self.flat
        carried[self.fixed] = held_positions(self.grid, self.problem.edges)[self.fixed]
        return self.scaled(self._perturbed(carried))

    def _perturbed(self, r: np.ndarray) -> np.ndarray:
        amplitude = self.problem.perturbation if self.model.buckles else 0.0
        return perturb(r, self.grid, self.fixed, amplitude, self.problem.seed)

    def verdict(self, status: Status, r: np.ndarray) -> tuple[Status, str]:
        """Status and sentence of a run that was judged `status` at the engine's state r."""
        return status, status.sentence


def make_level(problem: Problem, model: Model, grid: Grid, threads: int) -> Level:
    """The level that a model has on a mesh."""
    return (model.level or Level)(problem, model, grid, threads)


def in_space(field: np.ndarray) -> np.ndarray:
    """A field (components, ni, nj) as (ni, nj, 3); what the plane lacks is zero."""
    space = np.zeros((*field.shape[1:], 3))
    space[..., : len(field)] = np.moveaxis(field, 0, -1)
    return space
