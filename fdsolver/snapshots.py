"""Shapes of the sheet on its way from the uniform start to equilibrium (paper Fig. 3).

A recorder looks at the run between blocks of steps. With kinetic damping it keeps the shape at peaks of the kinetic
energy [72], as sampled by these looks; other damping has no such marks, and it keeps the shape every so often. Wrinkles
grow and coarsen ever more slowly, so the shapes kept are at least the factor `SPREAD` of steps apart, counted over all
nested meshes: some dozens for any run. What is recorded depends on the state of the run alone and goes into its
checkpoints, so a resumed run has the snapshots of an uninterrupted one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fdsolver.damping import twice_kinetic
from fdsolver.grid import Grid
from fdsolver.level import Level
from fdsolver.relax import State
from fdsolver.transfer import prolong

SPREAD = 1.2


@dataclass(frozen=True)
class Shape:
    """The sheet at one moment.

    level, step : index of the nested mesh and step on it, as in the run's history. total : step over all meshes.
    kinetic_N_mm : kinetic energy, as in the history. r : (ni, nj, 3) float64, mm, on that mesh.
    """

    level: int
    step: int
    total: int
    kinetic_N_mm: float
    r: np.ndarray


@dataclass
class Recorder:
    """Collects the shapes of one run; `count` of them are kept in the end, none of 0.

    peaks : keep the shapes at peaks of the kinetic energy. kept : the shapes so far. last : what the last look saw.
    rising : whether the kinetic energy had risen to it.
    """

    count: int
    peaks: bool
    kept: list[Shape] = field(default_factory=list)
    last: Shape | None = None
    rising: bool = False

    def look(self, index: int, before: int, level: Level, state: State) -> None:
        """See a state. index : of the nested mesh. before : steps on the coarser ones."""
        if not self.count:
            return
        now = _shape(index, before, level, state)
        if not self.kept:
            self.kept.append(now)
        if self.last is not None and (now.level, now.step) <= (self.last.level, self.last.step):
            return  # a block that is repeated after an interrupt
        if not self.peaks:
            self._keep(now)
        elif self.last is not None and self.last.level == now.level:
            if self.rising and now.kinetic_N_mm < self.last.kinetic_N_mm:
                self._keep(self.last)
            self.rising = now.kinetic_N_mm > self.last.kinetic_N_mm
        else:
            self.rising = True
        self.last = now

    def _keep(self, shape: Shape) -> None:
        if shape.total >= SPREAD * self.kept[-1].total and shape.total > 0:
            self.kept.append(shape)

    def arrays(self, grids: Sequence[Grid], end: Shape) -> dict[str, np.ndarray]:
        """The snapshots, first to last in time, all on the mesh of the result.

        grids : the nested meshes. end : the final state. Returns `step` (m,) and `level` (m,), as in the history,
        `kinetic_N_mm` (m,) and `r` (m, ni, nj, 3) float64 mm: the start, the end, and between them shapes evenly spread
        over the ones kept; m is `count`, or less where the run was too short for so many.
        """
        before = [shape for shape in self.kept if shape.total < end.total]
        wanted = min(self.count - 1, len(before))
        chosen = [before[k] for k in np.rint(np.linspace(0, len(before) - 1, wanted)).astype(int)] + [end]
        return {
            "step": np.array([shape.step for shape in chosen], dtype=np.int64),
            "level": np.array([shape.level for shape in chosen], dtype=np.int64),
            "kinetic_N_mm": np.array([shape.kinetic_N_mm for shape in chosen]),
            "r": np.stack([_on_mesh(shape.r, grids[shape.level], grids[end.level]) for shape in chosen]),
        }

    def as_arrays(self) -> dict[str, Any]:
        """The recorder as named arrays, for a checkpoint."""
        shapes = [*self.kept, *([] if self.last is None else [self.last])]
        rows = [(shape.level, shape.step, shape.total, shape.kinetic_N_mm) for shape in shapes]
        table = np.array(rows, dtype=float).reshape(-1, 4)
        state = {"snapshot_table": table, "snapshot_rising": self.rising, "snapshot_kept": len(self.kept)}
        return {**state, **{f"snapshot_r_{k}": shape.r for k, shape in enumerate(shapes)}}

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Take over what `as_arrays` gave."""
        shapes = [
            Shape(int(level), int(step), int(total), float(kinetic), np.asarray(saved[f"snapshot_r_{k}"]))
            for k, (level, step, total, kinetic) in enumerate(np.asarray(saved["snapshot_table"]).tolist())
        ]
        kept = int(saved["snapshot_kept"])
        self.kept, self.last = shapes[:kept], shapes[-1] if len(shapes) > kept else None
        self.rising = bool(saved["snapshot_rising"])


def final_shape(index: int, before: int, level: Level, state: State) -> Shape:
    """The end of a run, with the kinetic energy that the history ends with."""
    kinetic = state.history[-1][2] * level.energy_unit
    return Shape(index, state.step, before + state.step, kinetic, level.unscaled(state.r))


def _shape(index: int, before: int, level: Level, state: State) -> Shape:
    nodes = level.weight.size
    v, mass = (field.reshape(len(field), nodes) for field in (state.v, state.mass))
    twice = twice_kinetic(v, mass)
    energy = 0.5 * float(twice) * level.energy_unit
    return Shape(index, state.step, before + state.step, energy, level.unscaled(state.r))


def _on_mesh(r: np.ndarray, grid: Grid, fine: Grid) -> np.ndarray:
    """Positions r on `grid`, carried to the mesh `fine` by their displacement."""
    if (grid.ni, grid.nj) == (fine.ni, fine.nj):
        return r
    displacement = r.copy()
    displacement[..., :2] -= grid.u
    carried = prolong(displacement, grid, fine)
    carried[..., :2] += fine.u
    return carried
