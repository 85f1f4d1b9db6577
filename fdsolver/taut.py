"""Equilibrium of a relaxed membrane by following its central path (`slack`) down to the relaxed energy itself.

Newton's method on the relaxed energy fails: its tangent jumps where zones become slack, and is singular where they
are. On the central path the energy is smooth, so each of its points is found by a few primal-dual steps from the one
before, with a tenth of m. The last ones are equilibria of the relaxed energy itself: no artificial stiffness is left.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fdsolver import slack
from fdsolver.cholesky import Cholesky, NotPositiveDefinite
from fdsolver.dissection import Ordering
from fdsolver.level import Level
from fdsolver.relax import Settings, State
from fdsolver.residual import residual
from fdsolver.result import Status
from fdsolver.tangent import Tangent

FIRST = 1e-4  # m of the first point: strains of a hundredth count as hardly taut or slack
NEXT = 0.1  # m of a point over that of the point before
PATIENCE = 12  # steps at one m before the next one is tried from where they led
LAST = 1e-19  # smallest m: a stress of 3e-10 where a zone is neither taut nor slack
SHIFT = (
    1e-4  # part of the diagonal, over the residual, added to the matrix: it holds back what is free to move
)
LEAST_SHIFT = 1e-13
LARGEST_SHIFT = 1e-2  # beyond, the step is no Newton step any more
LONGEST = 0.05  # largest displacement of a node in one step, L
MOST_STEPS = 150
MOST_TRIALS = 12  # along a step
ROUNDING = 1e-13  # part of the energy below which its changes are rounding


def follow(
    level: Level,
    state: State,
    settings: Settings,
    ordering: Ordering,
    components: int,
    record: Callable[[State, float, float], None],
) -> Status | None:
    """Take `state` to the equilibrium of the relaxed energy in place: CONVERGED, or None where that fails.

    components : 2 where the sheet stays in its plane. record : called with energy and residual after every step.
    """
    path = _Path(level, components)
    m, partners = FIRST, np.zeros((2, *level.force.zone.shape[1:]))
    tries = 0
    pure, free = np.zeros_like(state.r), ~level.fixed
    for _ in range(MOST_STEPS):
        energy = float(level.force(state.r, pure).sum())
        state.evaluations += 1
        size = residual(pure, level.weight)
        record(state, energy, size)
        if size < settings.tolerance:
            return Status.CONVERGED
        r = np.ascontiguousarray(state.r[:components])
        p, found = path.step(r, m, partners, ordering)
        state.evaluations += path.evaluations
        path.evaluations = 0
        if p is None or found is None:
            return None
        share, rest = found
        slack.advance(r, p, path.zone, path.poisson, m, share, partners)
        state.r[:components][:, free] += share * p[:, free]
        tries += 1
        if (share > 0.4 and rest < np.sqrt(m)) or tries == PATIENCE:
            m, tries = max(NEXT * m, LAST), 0
    return None


class _Path:
    """The central path on one mesh; evaluations : of its force so far. rest : residual where it was last evaluated."""

    def __init__(self, level: Level, components: int) -> None:
        self.level, self.zone, self.evaluations = level, level.force.zone, 0
        self.poisson = level.force.law.poisson  # type: ignore[attr-defined]  # the relaxed law has one
        shape = (components, *level.fixed.shape)
        self.rest = 1.0
        self.values = np.zeros((*level.fixed.shape, 3, 3, components, components))
        self.force = np.zeros(shape)

    def step(
        self, r: np.ndarray, m: float, partners: np.ndarray, ordering: Ordering
    ) -> tuple[np.ndarray | None, tuple[float, float] | None]:
        """A step (components, ni, nj), and `along` it; None where there is none that leads down.

        Partners far from the central path may send it uphill; put back on the path, they give Newton's own step.
        """
        for _ in range(2):
            slack.recentre(r, self.zone, self.poisson, m, partners)
            p = self._newton(r, m, partners, ordering)
            found = None if p is None else self.along(r, p, m)
            if found is not None:
                break
            partners[:] = 0.0
        return p, found

    def _newton(self, r: np.ndarray, m: float, partners: np.ndarray, ordering: Ordering) -> np.ndarray | None:
        """The primal-dual step; None where even a large shift gives no factor."""
        slack.newton_system(r, self.zone, self.poisson, m, partners, self.values, self.force)
        self.evaluations += 1
        shift = max(SHIFT * self.rest, LEAST_SHIFT)
        while shift <= LARGEST_SHIFT:
            try:
                matrix = Tangent(self.values, self.level.force.closed, 0)
                return Cholesky(matrix, ordering, shift).solve(self.force)
            except NotPositiveDefinite:
                shift *= 100.0
        return None

    def at(self, r: np.ndarray, m: float) -> tuple[float, np.ndarray]:
        """Energy and force of the central path; no force at fixed nodes."""
        energy = slack.central_force(r, self.zone, self.poisson, m, self.force)
        self.evaluations += 1
        return energy, np.where(self.level.fixed, 0.0, self.force)

    def along(self, r: np.ndarray, p: np.ndarray, m: float) -> tuple[float, float] | None:
        """How far to go along p, and the residual there; None where no share leads down."""
        energy, f = self.at(r, m)
        slope = float(np.vdot(f, p))
        if not slope > 0.0:
            return None
        low, at_low, high = 0.0, slope, np.inf
        share = min(1.0, LONGEST / float(np.abs(p).max()))
        for _ in range(MOST_TRIALS):
            new_energy, f = self.at(r + share * p, m)
            left = float(np.vdot(f, p))
            down = new_energy <= energy + ROUNDING * abs(energy)
            self.rest = residual(f, self.level.weight)
            if down and (abs(left) <= 0.9 * slope or (left > 0.0 and high == np.inf)):
                return share, self.rest
            if down and left > 0.0:
                low, at_low, share = share, left, 0.5 * (share + high)
            elif left < 0.0:
                high = share
                share = low + (high - low) * float(np.clip(at_low / (at_low - left), 0.1, 0.7))
            else:
                high, share = share, 0.5 * (low + share)
        return None
