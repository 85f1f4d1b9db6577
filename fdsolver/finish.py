"""The last part of a relaxation: L-BFGS in the metric of the exact tangent.

Explicit relaxation needs more steps the finer the mesh. Once a few steps have smoothed what a coarser mesh handed
down, the state is so near to equilibrium that the exact tangent of the same energy, factorised once (`cholesky`), is an
almost perfect metric: 7 to 30 iterations of L-BFGS (Nocedal 1980) reach any tolerance, on any mesh. A state whose
tangent is not positive definite goes back to relaxation, which leaves it downhill.

The wrinkles of a long sheet slide almost freely. A small part of the diagonal, added to the metric alone, keeps the
iteration from sliding with them; it changes no force.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from fdsolver.cholesky import Cholesky, NotPositiveDefinite, Pattern
from fdsolver.dissection import dissect
from fdsolver.effects import Force
from fdsolver.level import Level
from fdsolver.reduced import mirrored_part
from fdsolver.relax import Settings, State, relax
from fdsolver.residual import residual, wanted
from fdsolver.result import Status
from fdsolver.tangent import Tangent, reach_of, tangent
from fdsolver.taut import follow

SHIFT = 1e-8  # part of the diagonal added to the metric
MOST_RELAXED = 200_000  # nodes of a relaxed membrane up to which finishing is tried unasked
HARD = 500  # steps of a relaxed membrane before the first look at how fast it comes to rest
WORTH = 5000  # steps of a relaxed membrane that take about as long as finishing all of it
PATIENCE = 3  # the steps before an attempt over those before the one that failed
MEMORY = 20  # pairs of L-BFGS
REFACTOR = 25  # iterations with one factor
MOST_ITERATIONS = 150
CURVATURE = 0.9  # the slope along the line falls at least to this part (Wolfe)
ROUNDING = 1e-13  # part of the energy below which its changes are rounding
MOST_TRIALS = 12  # along a line
FINISHED = -1.0  # in the restart column of the history: a row of the finisher
LARGEST_FACTOR = 6e8  # numbers, 4.8 GB: beyond, the factor does not fit the memory of a small machine


def suits(level: Level, settings: Settings) -> bool:
    """Whether a run may be finished: its model has a tangent that can be definite, and its factor fits the memory.

    The published schemes are the reference for steps and time: they are relaxed to the end.
    """
    if settings.finish == "off" or settings.damping == "kinetic-published" or level.project is not None:
        return False
    if level.examined is not level.force:
        return False  # the force is no gradient: no tangent is symmetric
    model = level.model
    if model.relaxed and (model.bending or model.moderate):
        return False  # a law that the finisher does not know
    if type(level.force) is not Force and not (model.relaxed and level.force.local):
        return False  # a sector, or a part of a plate
    if settings.finish == "on":
        return model.relaxed or model.bending
    return model.relaxed and level.grid.nodes <= MOST_RELAXED


def relax_or_finish(
    level: Level, state: State, settings: Settings, on_block: Callable[[State], None] | None = None
) -> Status:
    """Relax `state` in place, with attempts to finish on the way; everything else as `relax`.

    Whether an attempt is due depends on the state alone, so a run that was stopped and resumed makes the same ones.
    """
    place = (level.force, ~level.fixed, level.weight, state)
    if not suits(level, settings):
        return relax(*place, settings, on_block, level.project)
    part = None
    while True:
        asked = level.model.bending or settings.finish == "on"
        due = state.finish_at if asked else max(state.finish_at, HARD)
        pause = replace(settings, max_steps=min(settings.max_steps, due))
        status = relax(*place, pause, on_block, level.project)
        if status is not Status.STEP_LIMIT or state.step >= settings.max_steps:
            return status
        part = part or mirrored_part(level)
        worth = WORTH * part.fixed.size / level.fixed.size
        if not asked and steps_left(state, state.wanted) < worth:
            state.finish_at = 2 * state.step
            continue
        if (finished := finish(level, part, state, settings, on_block)) is not None:
            return finished
        state.finish_at = PATIENCE * state.step


def steps_left(state: State, tolerance: float) -> float:
    """Steps until the tolerance if the residual goes on falling as in the second half of the steps so far."""
    history = np.asarray(state.history)
    step, sizes = history[:, 0], history[:, 3]
    first, last = (float(sizes[step <= part * step[-1]].min()) for part in (0.5, 1.0))
    if not last < first:
        return np.inf
    return float(0.5 * step[-1] * np.log(last / tolerance) / np.log(first / last))


def axes_of(level: Level, r: np.ndarray) -> tuple[int, ...]:
    """The components that are solved for: a flat membrane that is not meant to buckle stays in its plane."""
    flat = len(r) == 2 or (not level.model.buckles and not r[2].any())
    return (0, 1) if flat else (0, 1, 2)


class Metric:
    """The factorised tangent at a state r (components, ni, nj); raises NotPositiveDefinite.

    evaluations : of the force that it took.
    """

    def __init__(self, level: Level, pattern: Pattern, r: np.ndarray, axes: tuple[int, ...]) -> None:
        matrix: Tangent = tangent(level.force, r, axes)
        self.evaluations = matrix.evaluations
        self.factor = Cholesky(matrix, pattern, SHIFT)

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """The displacement that a force f (axes, ni, nj) makes."""
        return self.factor.solve(f)


def finish(
    level: Level,
    part: Level,
    state: State,
    settings: Settings,
    on_step: Callable[[State], None] | None = None,
) -> Status | None:
    """Take `state` to its equilibrium in place; None where that fails and relaxation has to go on.

    part : what is factorised, the level itself or a part that its mirror images repeat.
    on_step : called after every iteration. On KeyboardInterrupt INTERRUPTED is returned and the state is as before.
    Each iteration counts as a step, and all evaluations of the force are counted, those of the tangent too.
    """
    # The rows and the arrays change in place; the rest is replaced.
    kept = {**vars(state), "r": state.r.copy(), "v": state.v.copy(), "history": list(state.history)}
    started, seconds = time.perf_counter(), state.seconds
    axes = axes_of(level, state.r)
    ordering = dissect(~part.fixed, reach_of(part.force), part.force.closed)
    if ordering.entries * len(axes) ** 2 > LARGEST_FACTOR:
        return None
    try:
        # One thread: the same bits whatever the machine is busy with, and no waiting for cores that others use.
        with threadpool_limits(1, user_api="blas"):
            state.v[:] = 0.0
            pattern = Pattern(ordering, part.force.closed, len(axes))
            if level.model.relaxed:
                return _follow(level, part, state, settings, pattern, on_step)
            for _ in range(MOST_ITERATIONS // REFACTOR):
                metric = Metric(level, pattern, state.r, axes)
                state.evaluations += metric.evaluations
                status = _descend(level, state, settings, metric, axes, on_step)
                if status is not None:
                    return status if status is Status.CONVERGED else None
    except NotPositiveDefinite:
        pass
    except KeyboardInterrupt:
        vars(state).update(kept)
        return Status.INTERRUPTED
    finally:
        state.seconds = seconds + time.perf_counter() - started
    return None


def _follow(
    level: Level,
    part: Level,
    state: State,
    settings: Settings,
    pattern: Pattern,
    on_step: Callable[[State], None] | None,
) -> Status | None:
    """Take a relaxed membrane to its equilibrium by a part of it (`mirrored_part`).

    Whether the part's equilibrium is one of the whole sheet, the force on that tells.
    """
    r = state.r if part is level else part.scaled(level.unscaled(state.r))

    def record(energy: float, size: float, evaluations: int) -> bool:
        if part is not level:
            state.r[:] = np.where(level.fixed, state.r, level.scaled(part.unscaled(r)))
        state.evaluations += evaluations
        _record(level, state, settings, energy * part.energy_unit / level.energy_unit, size)
        if on_step is not None:
            on_step(state)
        return size < state.wanted

    if not follow(part, r, pattern, record):
        return None
    f = np.zeros_like(state.r)
    level.force(state.r, f)
    return Status.CONVERGED if residual(f, level.weight) < state.wanted else None


def _descend(
    level: Level,
    state: State,
    settings: Settings,
    metric: Metric,
    axes: tuple[int, ...],
    on_step: Callable[[State], None] | None,
) -> Status | None:
    """L-BFGS with one factor: CONVERGED, STALLED where no step leads down, None where a new factor may pay."""
    place = _Place(level, axes)
    energy, f = place(state.r)
    pairs: list[tuple[np.ndarray, np.ndarray, float]] = []
    for _ in range(REFACTOR):
        if state.residual < state.wanted:
            return Status.CONVERGED
        p = _direction(metric, pairs, f)
        found = _along(place, state.r, p, energy, f)
        state.evaluations += place.evaluations
        place.evaluations = 0
        if found is None:
            return Status.STALLED
        share, energy, new = found
        change = f - new
        if (along := float(np.vdot(share * p, change))) > 0.0:
            pairs = [*pairs[1 - MEMORY :], (share * p, change, along)]
        state.r[list(axes)] += share * p
        f = new
        _record(level, state, settings, energy, residual(place.force, level.weight))
        if on_step is not None:
            on_step(state)
    return None


class _Place:
    """Energy and force at positions; keeps the force on all components and counts evaluations."""

    def __init__(self, level: Level, axes: tuple[int, ...]) -> None:
        self.level, self.axes, self.evaluations = level, list(axes), 0
        self.force = np.zeros((level.model.components, *level.fixed.shape))

    def __call__(self, r: np.ndarray) -> tuple[float, np.ndarray]:
        """The energy, and the force (axes, ni, nj), zero at fixed nodes."""
        energy = float(self.level.force(r, self.force).sum())
        self.evaluations += 1
        return energy, np.where(self.level.fixed, 0.0, self.force[self.axes])


def _direction(
    metric: Metric, pairs: list[tuple[np.ndarray, np.ndarray, float]], f: np.ndarray
) -> np.ndarray:
    """The two-loop recursion of L-BFGS (Nocedal 1980); pairs : (step, change of -force, their product)."""
    q, shares = f.copy(), []
    for step, change, along in reversed(pairs):
        shares.append(float(np.vdot(step, q)) / along)
        q -= shares[-1] * change
    p = metric(q)
    for (step, change, along), share in zip(pairs, reversed(shares), strict=True):
        p += (share - float(np.vdot(change, p)) / along) * step
    return p


def _along(
    place: _Place, r: np.ndarray, p: np.ndarray, energy: float, f: np.ndarray
) -> tuple[float, float, np.ndarray] | None:
    """How far to go along p: (share of p, energy there, force there), or None where no share leads down.

    The slope decides, not the energy, whose changes are rounding near the end: bisection between a share where the
    energy still falls and one where it rises.
    """
    slope, low, high, share = float(np.vdot(p, f)), 0.0, np.inf, 1.0
    if not slope > 0.0:
        return None
    there = r.copy()
    for _ in range(MOST_TRIALS):
        there[place.axes] = r[place.axes] + share * p
        new_energy, new = place(there)
        left = float(np.vdot(p, new))
        uphill = not np.isfinite(left) or new_energy > energy + ROUNDING * abs(energy)
        if not uphill and abs(left) <= CURVATURE * slope:
            return share, new_energy, new
        low, high = (low, share) if uphill or left < 0.0 else (share, high)
        share = 2.0 * share if high == np.inf else 0.5 * (low + high)
    return None


def _record(level: Level, state: State, settings: Settings, energy: float, size: float) -> None:
    """Count an iteration as a step and append it to the history."""
    state.step += 1
    state.wanted = wanted(settings.tolerance, energy, level.weight, level.model.relaxed)
    state.residual, state.total_energy = size, energy
    state.history.append((float(state.step), energy, 0.0, size, FINISHED))
