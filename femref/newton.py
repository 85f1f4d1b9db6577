"""Newton's method for a least energy: shifted until positive definite, with a line search on the energy.

Wrinkles can slide at almost no cost, so the Hessian of a wrinkled state is singular to many digits. A shift of
1e-8 of its diagonal keeps the step from following that direction and does not change the equilibrium.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from scipy.sparse import bsr_array, csc_array, csr_array, diags_array

from femref.assembly import SheetEnergy
from femref.inertia import Factorisation, NotCertified, factorise

NEUTRAL_SHIFT = 1e-8
# A shift s times the mass matrix: the first tried is this part of the stiffest entry, then it grows by steps; after a
# success it falls.
_FIRST_SHIFT, _SHIFT_STEP, _SHIFT_FALL = 1e-10, 3.0, 10.0
_ARMIJO = 1e-4
_SHORTEST_STEP = 1e-10
# An energy of this many digits cannot rank two states any more; the residual does.
_ROUNDING = 1e-13


class Outcome(Enum):
    """How a solve ended; the value is its sentence."""

    CONVERGED = "The residual fell below the tolerance."
    ITERATION_LIMIT = "The iterations ran out before the residual fell below the tolerance."
    STALLED = "No step lowers the energy any more, though the residual is above the tolerance."
    SINGULAR = "The Hessian could not be made positive definite, however large the shift."
    NOT_FINITE = "The energy is not finite: a zone is turned over or folded."
    STOPPED = "The time ran out or the user interrupted."


@dataclass(frozen=True)
class NewtonSettings:
    """tolerance : residual, |dE/dq| / (Y h L) with L the root of a node's area, largest over the free unknowns.

    iterations : most of one solve. proceed : called before each iteration with its residual; False stops the solve.
    """

    tolerance: float = 1e-9
    iterations: int = 200
    proceed: Callable[[float], bool] = field(default=lambda residual: True)


@dataclass(frozen=True)
class Equilibrium:
    """Where Newton's method ended.

    q : (ni, nj, 4, 3) mm. residual : see NewtonSettings. history : per iteration the value (N mm), the residual, the
    shift of the Hessian (N/mm^3, in units of the mass matrix) and the part of the step taken.
    """

    q: np.ndarray
    outcome: Outcome
    residual: float
    iterations: int
    history: list[tuple[float, float, float, float]]


def residual_of(energy: SheetEnergy, gradient: np.ndarray, free: np.ndarray) -> float:
    """Largest |dE/dq| over the free unknowns / (Y h L_n), L_n the root of the node's area. NaN if not finite."""
    x, y = energy.mesh.lengths
    circle = energy.mesh.y[None, :] if energy.mesh.polar else 1.0
    size = energy.young_MPa * energy.thickness_mm * np.sqrt(x[:, None] * circle * y[None, :])
    scaled = np.abs(gradient / size[:, :, None, None])[free]
    return float(scaled.max(initial=0.0)) if np.isfinite(gradient).all() else float("nan")


def free_part(matrix: bsr_array | csr_array | csc_array, free: np.ndarray) -> csc_array:
    """Rows and columns of the free unknowns (ni, nj, 4, 3 bool)."""
    chosen = np.flatnonzero(free)
    return matrix.tocsr()[chosen].tocsc()[:, chosen]


def free_hessian(energy: SheetEnergy, q: np.ndarray, free: np.ndarray) -> csc_array:
    """Hessian of the free unknowns."""
    return free_part(energy.hessian(q), free)


def minimise(energy: SheetEnergy, q: np.ndarray, free: np.ndarray, settings: NewtonSettings) -> Equilibrium:
    """Lower the energy from q over the free unknowns (ni, nj, 4, 3 bool) until it is stationary."""
    q = q.copy()
    mass, shift = free_part(energy.mass, free), 0.0
    value, gradient = energy.value(q), energy.gradient(q)
    history: list[tuple[float, float, float, float]] = []
    for iteration in range(settings.iterations + 1):
        residual = residual_of(energy, gradient, free)
        if not (np.isfinite(value) and np.isfinite(residual)):
            return Equilibrium(q, Outcome.NOT_FINITE, residual, iteration, history)
        if residual <= settings.tolerance:
            return Equilibrium(q, Outcome.CONVERGED, residual, iteration, history)
        if iteration == settings.iterations:
            break
        if not settings.proceed(residual):
            return Equilibrium(q, Outcome.STOPPED, residual, iteration, history)
        found = definite(free_hessian(energy, q, free), mass, shift)
        if found is None:
            return Equilibrium(q, Outcome.SINGULAR, residual, iteration, history)
        factors, used = found
        step = np.zeros_like(q)
        step[free] = -factors.solve(gradient[free])
        length = _line_search(energy, q, step, value, gradient, residual, free)
        history.append((value, residual, used, length))
        if length == 0.0:
            return Equilibrium(q, Outcome.STALLED, residual, iteration, history)
        shift = used / _SHIFT_FALL if used > 0.0 else 0.0
        q += length * step
        value, gradient = energy.value(q), energy.gradient(q)
    return Equilibrium(q, Outcome.ITERATION_LIMIT, residual, settings.iterations, history)


def definite(hessian: csc_array, mass: csc_array, shift: float) -> tuple[Factorisation, float] | None:
    """Factors of hessian + s mass, positive definite, and s >= `shift` (N/mm^3), the first tried that makes it so.

    The neutral shift is always added. None if no s does up to the stiffest entry of the Hessian.
    """
    diagonal, weight = np.abs(hessian.diagonal()), mass.diagonal()
    stiffest = float((diagonal / weight).max(initial=0.0))
    neutral = hessian + diags_array(NEUTRAL_SHIFT * np.maximum(diagonal, 1e-12 * diagonal.max(initial=0.0)))
    while shift <= stiffest:
        try:
            factors = factorise((neutral + shift * mass).tocsc())
        except NotCertified:
            factors = None
        if factors is not None and factors.negative == 0:
            return factors, shift
        shift = max(_SHIFT_STEP * shift, _FIRST_SHIFT * stiffest)
    return None


def _line_search(
    energy: SheetEnergy,
    q: np.ndarray,
    step: np.ndarray,
    value: float,
    gradient: np.ndarray,
    residual: float,
    free: np.ndarray,
) -> float:
    """Part of the step that lowers the energy enough; 0 if none does."""
    slope = float((gradient * step).sum())
    rounding = _ROUNDING * float(np.abs(energy.energy(q)).sum())
    if -slope <= rounding:
        # The promised gain is below rounding: only the residual can tell.
        after = residual_of(energy, energy.gradient(q + step), free)
        return 1.0 if after < residual else 0.0
    length = 1.0
    while length >= _SHORTEST_STEP:
        reached = energy.value(q + length * step)
        if np.isfinite(reached) and reached <= value + _ARMIJO * length * slope + rounding:
            return length
        length *= 0.5
    return 0.0
