"""Stability of equilibria in space: bounded by a Cholesky factor of the tangent.

The tangent K is measured as that of planar states is (`planar`), against the bending of the displacement: K v = t B v,
where v . B v is twice the bending energy of the flat sheet displaced by v, for each component alike. A column in its
second wave has t = -3 for the first, whatever its mesh and thickness. Eigenvalues against nodal masses sink with the
fourth power of the cell, and an iteration that searches for them hardly moves such long waves.

Wrinkles slide almost freely: with them the energy changes only because some phases suit the mesh better than others.
Such t are 1e-4 and less where wrinkles are resolved. So a state counts as stable where K + NEUTRAL B has a factor.
"""

from __future__ import annotations

import numpy as np

from fdsolver.cholesky import Pattern
from fdsolver.dissection import dissect
from fdsolver.effects import Force
from fdsolver.pencil import Pencil
from fdsolver.planar import STEP
from fdsolver.tangent import reach_of, tangent

NEUTRAL = 0.01  # above minus this an eigenvalue is zero
BED = 1e-7  # of a bed of springs in B, in Y h / L^2: with NEUTRAL, eigenvalues that rounding of the tangent makes
# tried for the mode of an unstable state; those beyond are found by other ways as well
SHIFTS = (1.0, 1e2, 1e4)
MOST_NODES = 25_000  # a factor takes 1.5 s there, as long as 3 000 steps


def examinable(force: Force) -> bool:
    """Whether a state of this force can be examined here: that of a whole plate in space."""
    return (
        type(force) is Force
        and force.components == 3
        and force.node is not None
        and force.rows * force.columns <= MOST_NODES
    )


def lowest_in_space(
    force: Force, r: np.ndarray, flat: np.ndarray, weight: np.ndarray, seed: int
) -> tuple[float, np.ndarray | None, int] | None:
    """Bound or value of the lowest t of K v = t B v, the mode (3, ni, nj), and the force evaluations spent.

    r, flat : (3, ni, nj) float64, scaled: the state and the undeformed sheet. weight : (ni, nj) float64, see
    `residual.residual`; zero at fixed nodes. seed : of the start.

    A stable state gives the bound -NEUTRAL and no mode. None where an unstable one's mode is not found.
    """
    pencil = _pencil(force, r, flat, weight)
    if pencil.factor(NEUTRAL) is not None:
        return -NEUTRAL, None, pencil.evaluations
    for shift in SHIFTS:
        if (factor := pencil.factor(shift)) is not None:
            found = pencil.lowest(factor, shift, seed)
            return None if found is None else (*found, pencil.evaluations)
    return None


def _pencil(force: Force, r: np.ndarray, flat: np.ndarray, weight: np.ndarray) -> Pencil:
    free = weight > 0.0
    stiffness, bending = tangent(force, r, (0, 1, 2)), tangent(force, flat, (2,), STEP)
    bending.values[:, :, bending.reach, bending.reach, 0, 0][free] += BED / weight[free] ** 2
    pattern = Pattern(dissect(free, reach_of(force), force.closed), force.closed, 3)
    return Pencil(stiffness, bending, pattern, free)
