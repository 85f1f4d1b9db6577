"""The way of a sheet to its full load: tangent predictors, Newton's method, shorter steps where one fails."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from femref.assembly import SheetEnergy
from femref.bicubic import flat
from femref.held import Support, given_values
from femref.newton import Equilibrium, NewtonSettings, Outcome, definite, free_part, minimise

# A step is halved up to this part of the way before the load is given up.
SMALLEST_STEP = 1.0 / 256.0


def follow(
    energy: SheetEnergy,
    supports: Mapping[str, Support],
    held: np.ndarray,
    free: np.ndarray,
    settings: NewtonSettings,
    first_step: float = 1.0,
) -> tuple[Equilibrium, float]:
    """Equilibrium of the free unknowns at full load, followed from the flat unloaded sheet.

    held : (ni, nj, 4, 3) bool, the unknowns that supports and symmetries give. free : those that may move, none of them
    held; the rest stay as in the flat sheet. first_step : part of the way to try first.

    Returns the last equilibrium and the part of the way that it reached; it has not converged if that is below one.
    """
    q = flat(energy.mesh)
    part, step = 0.0, first_step
    iterations = 0
    while True:
        target = min(1.0, part + step)
        moved = predicted(energy, q, given_values(energy.mesh, supports, target), held, free)
        found = minimise(energy, moved, free, settings)
        iterations += found.iterations
        if found.outcome is Outcome.CONVERGED:
            q, part, step = found.q, target, 2.0 * step
            if part >= 1.0:
                return _counted(found, iterations), part
        elif found.outcome is Outcome.STOPPED or step <= SMALLEST_STEP:
            return _counted(found, iterations), part
        else:
            step *= 0.5


def predicted(
    energy: SheetEnergy, q: np.ndarray, given: np.ndarray, held: np.ndarray, free: np.ndarray
) -> np.ndarray:
    """q with the held unknowns moved to their given values, the free ones along the tangent of the equilibrium path."""
    change = np.where(held, given - q, 0.0)
    hessian = energy.hessian(q).tocsr()
    chosen = np.flatnonzero(free)
    found = definite(free_part(hessian, free), free_part(energy.mass, free), 0.0)
    if found is not None:
        change.ravel()[chosen] = -found[0].solve((hessian @ change.ravel())[chosen])
    return q + change


def _counted(found: Equilibrium, iterations: int) -> Equilibrium:
    return Equilibrium(found.q, found.outcome, found.residual, iterations, found.history)
