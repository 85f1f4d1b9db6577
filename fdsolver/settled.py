"""Have the waves settled? How far their height still is from its equilibrium.

Near the loads at which wrinkles begin and end their height is so soft that any tolerance leaves it open: the strip
pulled by 2.5 % came to rest at a residual of 1e-6 with waves of 1.8 thicknesses, at 1e-8 with a quarter of one, and
the truth is flat. No eigenvalue tells such waves from wrinkles, since they are as stable. What tells is Newton's step
for their height alone, the sheet following in its plane: of all displacements (w, s z) the share

    s = f . d / (d . K d),    d = (w, z),    K_uu w = -K_uz z,

with f the force, K the tangent, u the plane. For an energy a z^2 / 2 + b z^4 / 4 it is 0 at an equilibrium, -1 for low
waves of a sheet that is stable flat (a > 0), and below -1/3 for all of them. The sheet has to follow: at rest in its
plane it resists its waves up to fifty times as much, and the step is as much too short.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fdsolver.effects import Force
from fdsolver.relax import State

SETTLED = 0.1  # share of their height that waves may still be away from where they belong
HINT = 0.001  # the same, of the sheet at rest in its plane, below which it is settled whatever follows
DYING = -1.0 / 3.0  # share below which waves are on their way to nothing, and are taken there
LARGEST_GROWTH = 0.5  # in one step: Newton's overshoots where the waves have just begun
PROBE = 1e-7  # size of the displacement, in L, whose change of force gives K v, as in `stability`
MOST_STEPS = 200
LOOK_EVERY = 10
CLOSE = 0.02  # change of the stiffness in that many steps, relative, at which it is known


@dataclass(frozen=True)
class Growth:
    """The step that takes waves to their height.

    share : of their height, -1 (they vanish) to LARGEST_GROWTH. displacement : (3, ni, nj), scaled; the sheet follows
    in its plane with the square of the height.
    evaluations : of the force.
    """

    share: float
    displacement: np.ndarray
    evaluations: int

    @property
    def settled(self) -> bool:
        """Whether the waves are as high as they are going to be."""
        return abs(self.share) <= SETTLED


def growth_to_come(force: Force, examined: Force, state: State) -> Growth:
    """How the waves of a state in space would still grow.

    force : whose equilibrium is sought. examined : whose tangent counts, see `Level`. The state is only read.
    """
    free = state.inverse_mass[:3] > 0.0
    waves = np.zeros_like(state.r)
    waves[2] = np.where(free[2], state.r[2] - _support(state.r[2], ~free[2]), 0.0)
    tangent = _Tangent(examined, state.r, free)
    f = np.zeros_like(state.r)
    force(state.r.copy(), f)
    pushed = tangent(waves)
    work, stiffness = float(np.vdot(f, waves)), float(np.vdot(waves, pushed))
    if abs(work) <= HINT * stiffness:
        return Growth(work / stiffness if stiffness else 0.0, 0.0 * waves, 1 + tangent.evaluations)
    follow, stiffness = _follow(tangent, state.inverse_mass, pushed, stiffness)
    work = float(np.vdot(f, waves + follow))
    share = work / stiffness if stiffness > 0.0 else np.copysign(LARGEST_GROWTH, work)
    share = -1.0 if share < DYING else min(float(share), LARGEST_GROWTH)
    return Growth(share, share * waves + share * (1.0 + 0.5 * share) * follow, 1 + tangent.evaluations)


def _support(z: np.ndarray, fixed: np.ndarray) -> float:
    """Mean height of what is fixed, above which waves rise; 0 where nothing is."""
    return float(z[fixed].mean()) if fixed.any() else 0.0


class _Tangent:
    """Products K v at a state by differences of the force; counts its evaluations."""

    def __init__(self, force: Force, r: np.ndarray, free: np.ndarray) -> None:
        self.force, self.r, self.free = force, r.copy(), free
        self.at_rest, self.moved = np.zeros_like(r), np.zeros_like(r)
        self.force(self.r, self.at_rest)
        self.evaluations = 1

    def __call__(self, v: np.ndarray) -> np.ndarray:
        """K v, zero where nothing is free."""
        probe = PROBE / max(float(np.abs(v).max()), 1e-300)
        self.force(self.r + probe * v, self.moved)
        self.evaluations += 1
        return np.where(self.free, (self.at_rest - self.moved) / probe, 0.0)


def _follow(
    tangent: _Tangent, inverse_mass: np.ndarray, pushed: np.ndarray, stiffness: float
) -> tuple[np.ndarray, float]:
    """The w of K_uu w = -K_uz z by conjugate gradients, and the stiffness d . K d that it leaves of z . K z.

    pushed : K z. Every step lowers the stiffness by a known amount, which tells when to stop.
    """
    w, left = np.zeros_like(pushed), -pushed
    left[2] = 0.0
    scale = np.zeros_like(pushed)
    scale[:2] = inverse_mass[:2]
    scaled = scale * left
    p, square, before = scaled, float(np.vdot(left, scaled)), stiffness
    for k in range(MOST_STEPS):
        image = tangent(p)
        image[2] = 0.0
        curvature = float(np.vdot(p, image))
        if not curvature > 0.0:
            break  # compressed in its plane beyond what it bears: what has been found counts
        share = square / curvature
        w += share * p
        left -= share * image
        stiffness -= share * square
        if (k + 1) % LOOK_EVERY == 0:
            if stiffness <= 0.0 or before - stiffness < CLOSE * stiffness:
                break
            before = stiffness
        scaled = scale * left
        new = float(np.vdot(left, scaled))
        p, square = scaled + new / square * p, new
    return w, stiffness
