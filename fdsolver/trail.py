"""States that a nested run passed through, kept to estimate the error of its last one.

The equilibria of the coarser meshes tell what the mesh still changes; a state of the last mesh shortly before its
residual was small enough tells what further iterations would change.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fdsolver.fields import reactions, zone_fields
from fdsolver.level import Level
from fdsolver.relax import State, residual
from fdsolver.result import Solution

EARLY = 30.0  # times the residual wanted: late enough for the slow modes to rule, early enough to have moved since


@dataclass
class Trail:
    """Positions (ni, nj, 3) in mm, of the whole sheet.

    coarse : equilibria of the finished meshes, coarsest first. early : the first state of the present mesh with a
    residual below `EARLY` times the one wanted; None before.
    """

    coarse: list[np.ndarray] = field(default_factory=list)
    early: np.ndarray | None = None

    def look(self, level: Level, state: State) -> None:
        """Keep the state if it is the early one; forget an old one after a jump away from equilibrium."""
        if state.residual > EARLY * state.wanted:
            self.early = None
        elif self.early is None:
            self.early = level.unscaled(state.r)

    def finish_mesh(self, level: Level, state: State) -> None:
        """The present mesh is at equilibrium, a finer one follows."""
        self.coarse.append(level.unscaled(state.r))
        self.early = None

    def as_arrays(self) -> dict[str, Any]:
        """The trail as named arrays, for a checkpoint."""
        arrays: dict[str, Any] = {f"trail_{k}": r for k, r in enumerate(self.coarse)}
        if self.early is not None:
            arrays["trail_early"] = self.early
        return arrays

    @classmethod
    def from_arrays(cls, saved: Mapping[str, Any]) -> Trail:
        """The trail that `as_arrays` gave."""
        coarse = [np.array(saved[f"trail_{k}"]) for k in range(len(saved)) if f"trail_{k}" in saved]
        early = saved.get("trail_early")
        return cls(coarse, None if early is None else np.array(early))


def with_trail(solution: Solution, trail: Trail, levels: Sequence[Level]) -> Solution:
    """The solution with the states on its way.

    levels : of the meshes, coarsest first, each of the whole sheet; as many as the run has been on.
    """
    coarser = tuple(_as_state(solution, level, r) for level, r in zip(levels, trail.coarse, strict=False))
    earlier = None if trail.early is None else _as_state(solution, levels[-1], trail.early)
    return replace(solution, coarser=coarser, earlier=earlier)


def _as_state(solution: Solution, level: Level, positions: np.ndarray) -> Solution:
    """The solution's form for another state of its problem: positions, residual, energies, reactions, zone fields."""
    r = level.scaled(positions)
    f = np.zeros_like(r)
    membrane, bending, control = (level.force(r, f) * level.energy_unit).tolist()
    problem = level.problem
    force = level.unscaled(f) * (level.force_unit / level.grid.length_mm)
    parts = {"membrane": membrane, "bending": bending, "hourglass": control}
    return replace(
        solution,
        grid=level.grid,
        sheet=problem.sheet,
        r=positions,
        residual=residual(f, level.weight),
        energy_N_mm={"total": membrane + bending + control, **parts},
        reactions=reactions(level.grid, problem.edges, positions, force),
        zone=zone_fields(level.grid, problem.sheet, positions, level.model.relaxed, level.model.moderate),
        snapshots={},
    )
