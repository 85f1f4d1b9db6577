"""A level that solves one part of a symmetric sheet, and the force that keeps the part's ghost lines.

Before the kernel the ghost lines are filled with the images of the nodes inside; after it their forces are folded back
onto these. With the energy of `reduction` that is its exact gradient. Any kernel will do.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from fdsolver.effects import Force
from fdsolver.grid import Grid
from fdsolver.level import Level, make_level
from fdsolver.model import Model
from fdsolver.plate_linear import stiffness_bound
from fdsolver.problem import Problem
from fdsolver.reduction import Reduction, reduction
from fdsolver.relax import State, residual
from fdsolver.rows import compiled
from fdsolver.symmetry import Symmetry, refuse_unsymmetric, rigid_shift

MODULI = (
    (0, 1, 2, 3, 4, 5),
    (0, 1, 2, 7, 8, 9),
)  # fields of `Force.node` that are stiffnesses: full, linear curvature


@compiled
def fill(r, lines, turns):
    """Put the images on the ghost lines.

    r : (components, ni, nj). lines : (m, 3) axis, ghost line, image line. turns : (m, 3, 3).
    """
    axes = r.shape[0]
    for m in range(lines.shape[0]):
        axis, ghost, image = lines[m, 0], lines[m, 1], lines[m, 2]
        for k in range(r.shape[2] if axis == 0 else r.shape[1]):
            i, j = (image, k) if axis == 0 else (k, image)
            at_i, at_j = (ghost, k) if axis == 0 else (k, ghost)
            for a in range(axes):
                value = 0.0
                for b in range(axes):
                    value += turns[m, a, b] * r[b, i, j]
                r[a, at_i, at_j] = value


@compiled
def fold(f, lines, turns, held):
    """Give the forces on the ghost lines back to their images, the last line first; none where a mirror line holds."""
    axes = f.shape[0]
    for m in range(lines.shape[0] - 1, -1, -1):
        axis, ghost, image = lines[m, 0], lines[m, 1], lines[m, 2]
        for k in range(f.shape[2] if axis == 0 else f.shape[1]):
            i, j = (image, k) if axis == 0 else (k, image)
            at_i, at_j = (ghost, k) if axis == 0 else (k, ghost)
            for b in range(axes):
                for a in range(axes):
                    f[b, i, j] += turns[m, a, b] * f[a, at_i, at_j]
            for a in range(axes):
                f[a, at_i, at_j] = 0.0
    for m in range(held.shape[0]):
        if held[m, 2] < axes:
            if held[m, 0] == 0:
                f[held[m, 2], held[m, 1], :] = 0.0
            else:
                f[held[m, 2], :, held[m, 1]] = 0.0


@dataclass(frozen=True)
class ReducedForce(Force):
    """The force on the part's nodes. lines, turns, held : the ghost lines and what mirror lines hold, see `fill`."""

    lines: np.ndarray
    turns: np.ndarray
    held: np.ndarray

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        """As `Force`; the ghost lines of r are overwritten. The energies are the part's."""
        self.complete(r)
        energy = super().__call__(r, f)
        fold(f, self.lines, self.turns, self.held)
        return energy

    @property
    def local(self) -> bool:
        """Whether every ghost line is the one beyond a mirror line, and follows the line on its other side."""
        return bool(np.all(np.abs(self.lines[:, 1] - self.lines[:, 2]) == 2))

    def hold(self, field: np.ndarray) -> None:
        """Put zero where a mirror line holds a component."""
        for axis, line, component in self.held:
            if component < min(self.components, len(field)):
                (field[component] if axis == 0 else field[component].T)[line] = 0.0

    def complete(self, field: np.ndarray) -> None:
        """Put the images of a field on the ghost lines."""
        fill(field, self.lines, self.turns)

    def fold_stiffness(self, stiffness: np.ndarray) -> None:
        """Add the stiffness bounds of ghost nodes to their images, in place; see `mass.nodal_masses`."""
        axes = self.components
        upper = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)) if axes == 3 else ((0, 0), (1, 1), (0, 1))
        for (axis, ghost, image), turn in zip(self.lines[::-1], self.turns[::-1], strict=True):
            moved = stiffness if axis == 0 else np.swapaxes(stiffness, 1, 2)
            block = np.empty((axes, axes, moved.shape[2]))
            for field, (a, b) in zip(moved, upper, strict=True):
                block[a, b] = block[b, a] = field[ghost]
            block = np.einsum("ab,acn,cd->bdn", turn[:axes, :axes], block, turn[:axes, :axes])
            for field, (a, b) in zip(moved, upper, strict=True):
                field[image] += block[a, b]
        for axis, line, component in self.held:
            moved = stiffness if axis == 0 else np.swapaxes(stiffness, 1, 2)
            for field, (a, b) in zip(moved, upper, strict=True):
                if a != b and component in (a, b):
                    field[line] = 0.0


def reduced_force(force: Force, cut: Reduction) -> ReducedForce:
    """The force of a model on a part, from that on the whole mesh: the same constants, those of the part."""
    rows, columns = cut.rows, cut.columns
    zone = force.zone[:, rows[:-1]][:, :, columns[:-1]]
    zone[4] *= cut.zone_share
    node, twist, bound = force.node, force.twist, force.bound
    if twist is not None:
        twist = np.ascontiguousarray(twist[:, rows[:-1]][:, :, columns[:-1]])
        twist[:-2] *= cut.zone_share
    if node is not None and twist is not None:
        node = np.ascontiguousarray(node[:, rows][:, :, columns])
        node[[k for k in MODULI[bound is not None] if k < len(node)]] *= cut.node_share
        bound = None if bound is None else stiffness_bound(node, twist, closed=False)
    values = {field.name: getattr(force, field.name) for field in fields(Force)}
    values.update(rows=len(rows), columns=len(columns), closed=False, zone=np.ascontiguousarray(zone))
    values.update(node=node, twist=twist, bound=bound, row_energy=np.zeros((3, len(rows))))
    return ReducedForce(
        **values,
        lines=np.array([(link.axis, link.ghost, link.image) for link in cut.links], dtype=np.int64),
        turns=np.array([link.turn for link in cut.links]),
        held=np.array(cut.held, dtype=np.int64).reshape(-1, 3),
    )


class ReducedLevel(Level):
    """A problem on the part of a mesh that its symmetry leaves; positions go in and come out on the whole mesh.

    shift : (3,) mm, between the symmetric sheet that is solved and the sheet as it is held (`rigid_shift`).
    """

    force: ReducedForce

    def __init__(self, problem: Problem, model: Model, grid: Grid, threads: int) -> None:
        assert problem.symmetry is not None
        self.problem, self.model, self.project = problem, model, None
        self.cut = reduction(grid, problem.symmetry)
        self.shift = rigid_shift(problem.symmetry, problem.edges)
        self.whole = Level(replace(problem, symmetry=None), model, grid, threads)
        self.grid = self.cut.part
        self.force = self.examined = reduced_force(self.whole.force, self.cut)
        inside = self.cut.node_share > 0.0
        self.fixed = self.cut.restrict(self.whole.fixed) | ~inside
        # a node on a mirror line bears its share of the force on the whole sheet's node
        self.weight = np.where(inside, self.cut.restrict(self.whole.weight), 0.0)
        self.weight[inside] /= self.cut.node_share[inside]

    @property
    def energy_unit(self) -> float:
        """N mm of the whole sheet."""
        return self.whole.energy_unit * self.cut.copies

    @property
    def flat(self) -> np.ndarray:
        """(ni, nj, 3), mm, of the whole sheet."""
        return self.whole.flat

    def scaled(self, r: np.ndarray) -> np.ndarray:
        """The engine's positions (components, ni, nj) on the part, of (ni, nj, 3) in mm on the whole mesh."""
        place = super().scaled(self.cut.restrict(r - self.shift))
        self.force.hold(place)
        self.force.complete(place)
        return place

    def unscaled(self, r: np.ndarray) -> np.ndarray:
        """Positions (ni, nj, 3) in mm on the whole mesh."""
        return self.cut.unfold(super().unscaled(r)) + self.shift

    def start(self) -> np.ndarray:
        """The whole sheet's start, made symmetric by leaving out all but the part."""
        return self.scaled(self.whole.unscaled(self.whole.start()))

    def start_from(self, coarse: Level, r: np.ndarray) -> np.ndarray:
        """The state r of a coarser level, carried over on the whole meshes."""
        whole = coarse.whole if isinstance(coarse, ReducedLevel) else coarse
        return self.scaled(
            self.whole.unscaled(self.whole.start_from(whole, whole.scaled(coarse.unscaled(r))))
        )


def level_on(problem: Problem, model: Model, grid: Grid, threads: int) -> Level:
    """The level of a problem on a mesh, reduced where the problem has a symmetry."""
    return (make_level if problem.symmetry is None else ReducedLevel)(problem, model, grid, threads)


def mirrored_part(level: Level) -> Level:
    """A relaxed level on a quarter or half of its sheet, where mesh and loads are mirror images; else the level itself.

    Nothing is assumed by that: the relaxed energy is convex, so an equilibrium of the whole sheet is the answer. Plates
    have others that break the symmetry.
    """
    problem, grid = level.problem, level.grid
    if problem.symmetry is not None or not level.model.relaxed:
        return level
    for reduce in ("quarter", "half-x", "half-y"):
        symmetry = Symmetry(reduce)
        try:
            refuse_unsymmetric(symmetry, problem.edges, grid.shape, grid.length_mm)
            return ReducedLevel(replace(problem, symmetry=symmetry), level.model, grid, level.force.threads)
        except ValueError:  # loads or mesh without this symmetry
            continue
    return level


def on_the_whole(level: Level, r: np.ndarray) -> tuple[Level, np.ndarray]:
    """The level of the whole sheet and the positions (components, ni, nj), scaled, on its mesh."""
    if not isinstance(level, ReducedLevel):
        return level, r
    return level.whole, level.whole.scaled(level.unscaled(r))


def unfolded(level: Level, state: State) -> tuple[Level, State]:
    """The level and the state of the whole sheet, with its own residual: what to show of the end of a run."""
    whole, r = on_the_whole(level, state.r)
    if whole is level:
        return level, state
    f = np.zeros_like(r)
    whole.force(r, f)
    return whole, replace(state, r=r, v=0.0 * r, residual=residual(f, whole.weight))
