"""Equilibrium of a relaxed membrane by an interior-point method in its stress and its wrinkling strain (`wrinkling`).

Newton's method on the relaxed energy fails: its tangent jumps where zones become slack, and is singular where they
are. Here every zone keeps a little stress and a little wrinkling strain, whose product m falls to nothing. The last
states are equilibria of the relaxed energy itself: no artificial stiffness is left, and none was ever in the nodes.

Beside a slack region the tension falls by a factor of about ten from one row of zones to the next, so each decade of m
loosens another row. That is why the iteration converges linearly at the end.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fdsolver import wrinkling
from fdsolver.cholesky import Cholesky, NotPositiveDefinite, Pattern
from fdsolver.level import Level
from fdsolver.residual import residual
from fdsolver.tangent import Tangent

FIRST = 1e-4  # m of the first state: stresses of a hundredth count as hardly taut
LAST = 3e-18  # smallest m aimed at: a stress of 2e-9 where a zone is neither taut nor slack
MOST_STEPS = 70
INSIDE = 0.95  # part of the way to where S or B turns singular
CORRECTIONS = 2  # second-order corrections of a step at most; each costs a fourth of a factor
GAIN = 1.05  # a correction is kept if the step may be longer by this
LONGEST = 0.05  # largest displacement of a node in one step, L
SHIFT = 1e-13  # part of the diagonal added to the matrix: rounding
HELD = 1e30  # stiffness that holds what a mirror line holds
LARGEST_SHIFT = 1e-8  # beyond, the step is no Newton step any more


def follow(
    level: Level,
    r: np.ndarray,
    pattern: Pattern,
    record: Callable[[float, float, int], bool],
) -> bool:
    """Take the positions r (components, ni, nj) to the equilibrium of the relaxed energy in place; False if it fails.

    level : of the sheet, or of one part of a mirrored one. pattern : of the factors, with 2 unknowns a node where the
    sheet stays in its plane. record : called before every step with energy, residual and evaluations of the force since
    the last time; returns whether that is the equilibrium. Raises NotPositiveDefinite where a step has no factor.
    """
    components = pattern.axes
    path = _Path(level, np.ascontiguousarray(r[:components]), pattern)
    pure = np.zeros_like(r)
    for _ in range(MOST_STEPS):
        energy = float(level.force(r, pure).sum())
        size = residual(pure, level.weight)
        if record(energy, size, 1 + path.evaluations):
            return True
        path.evaluations = 0
        path.advance()
        if not np.isfinite(path.r).all():
            return False
        r[:components] = path.r
    return False


class _Path:
    """A state near the central path.

    r : (components, ni, nj). S, B : stress and wrinkling strain of the zones. evaluations : passes over the zones that
    made a force.
    """

    def __init__(self, level: Level, r: np.ndarray, pattern: Pattern) -> None:
        self.level, self.zone, self.pattern = level, level.force.zone, pattern
        self.nu = level.force.law.poisson  # type: ignore[attr-defined]  # the relaxed law has one
        self.r, self.force, self.evaluations = r, np.zeros_like(r), 0
        self.S, self.B, self.dS, self.dB, self.c, self.q = np.zeros((6, 3, *self.zone.shape[1:]))
        self.values = np.zeros((*level.fixed.shape, 3, 3, len(r), len(r)))
        free = np.ones_like(r)
        level.force.hold(free)
        self.held = np.argwhere(np.moveaxis(free, 0, -1) == 0.0)
        wrinkling.centre(r, self.zone, self.nu, FIRST, self.S, self.B)

    def advance(self) -> None:
        """One predictor-corrector step (Mehrotra 1992); raises NotPositiveDefinite."""
        factor = self._factor()
        m = wrinkling.duality(self.zone, self.S, self.B)
        self.c[:], self.q[:] = 0.0, 0.0
        p, most = self._solve(factor, 0.0)
        aim = max((1.0 - min(most, 1.0)) ** 3 * m, LAST)
        most = 0.0
        for _ in range(CORRECTIONS):
            wrinkling.second_order(p, self.zone, self.S, self.B, self.dS, self.dB, self.c, self.q)
            kept = p, self.dS.copy(), self.dB.copy(), most
            p, most = self._solve(factor, aim)
            if most < GAIN * kept[-1]:
                p, self.dS, self.dB, most = kept
                break
            if most > 1.0:
                break
        share = min(1.0, INSIDE * most, LONGEST / float(np.abs(p).max()))
        self.r = self.r + share * p
        self.S += share * self.dS
        self.B += share * self.dB

    def _factor(self) -> Cholesky:
        """The factor of the step's matrix; raises NotPositiveDefinite where even a large shift gives none."""
        wrinkling.newton_matrix(self.r, self.zone, self.nu, self.S, self.B, self.values)
        for i, j, c in self.held:
            self.values[i, j, 1, 1, c, c] = HELD
        shift = SHIFT
        while True:
            try:
                return Cholesky(Tangent(self.values, self.level.force.closed, 0), self.pattern, shift)
            except NotPositiveDefinite:
                shift *= 100.0
                if shift > LARGEST_SHIFT:
                    raise

    def _solve(self, factor: Cholesky, m: float) -> tuple[np.ndarray, float]:
        """The step towards m with the present second-order terms; how much of it leaves S and B definite."""
        place = self.r, self.zone, self.nu, m, self.S, self.B, self.c, self.q
        wrinkling.newton_force(*place, self.force)
        self.evaluations += 1
        self.force[:, self.level.fixed] = 0.0
        p = factor.solve(self.force)
        self.level.force.complete(p)
        r, *rest = place
        return p, float(wrinkling.changes(r, p, *rest, self.dS, self.dB))
