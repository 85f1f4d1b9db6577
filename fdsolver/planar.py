"""Stability of planar equilibria: the lowest eigenvalue of the exact out-of-plane tangent.

A planar sheet moves out of its plane independently of its motion in the plane, so its tangent K is a sparse matrix with
one unknown per node. It is measured against B, the tangent of the same sheet with so much all-round tension added that
no zone is compressed: K v = t B v. Bending has its full share in both, so t is near one for modes that bend, and the
sheet buckles where t falls below zero. However fine the mesh, t has the same meaning and separates well, which
eigenvalues against nodal masses do not: those of long waves sink with the fourth power of the cell.
"""

from __future__ import annotations

import numpy as np

from fdsolver.cholesky import Pattern
from fdsolver.dissection import dissect
from fdsolver.effects import Force
from fdsolver.membrane import OWN_KINEMATICS
from fdsolver.pencil import Pencil
from fdsolver.tangent import reach_of, tangent

STEP = 1e-9  # displacement, L: the force is odd in it, so differences neither round nor bend at this size
TENSION = 1.5  # of the largest compressive strain, added all round: more than none is left
ROUNDING = 1e-14  # strain below which compression is none
LEAST_TENSION = 1e-9  # strain that keeps B definite on a sheet that is neither bent nor stressed
MOST_NODES = 200_000  # beyond, the factors of B do not fit the memory of a small machine
# Shifts s: for sheets that are stable but for rounding, and for all. With c the largest compression, K lacks at
# most c of tension and B keeps at least (TENSION - 1) c, so t is above -1 / (TENSION - 1) where strains are small.
SHIFTS = (1e-6, 4.0)


def lowest_out_of_plane(
    force: Force, r: np.ndarray, free: np.ndarray, seed: int
) -> tuple[float, np.ndarray, int] | None:
    """Lowest t of K v = t B v, its mode (ni, nj) with largest component 1, and the force evaluations spent.

    force : of any model. r : (3, ni, nj) float64, scaled; its z is ignored. free : (ni, nj) bool. seed : of the start.

    Returns None where the iteration fails or the mesh is too large for it.
    """
    if not 0 < free.sum() <= MOST_NODES:
        return None
    flat = r.copy()
    flat[2] = 0.0
    stiffness, metric = (tangent(force, state, (2,), STEP) for state in (flat, _all_tense(force, flat)))
    pattern = Pattern(dissect(free, reach_of(force), force.closed), force.closed, 1)
    pencil = Pencil(stiffness, metric, pattern, free)
    for shift in SHIFTS:
        if (factor := pencil.factor(shift)) is not None and (found := pencil.lowest(factor, shift, seed)):
            return found[0], found[1][0], pencil.evaluations
    return None


def is_tense(force: Force, r: np.ndarray) -> bool:
    """Whether no zone of a planar state (2 or 3 components, ni, nj), scaled, is compressed in any direction.

    Then nothing needs to be solved: B is K itself, and t is one. Laws with a strain of their own are left to the
    eigenvalue.
    """
    return type(force.law) not in OWN_KINEMATICS and _compression(force, r) <= ROUNDING


def _all_tense(force: Force, flat: np.ndarray) -> np.ndarray:
    """The planar state scaled up until every zone is tense in every direction."""
    return flat * np.sqrt(1.0 + TENSION * _compression(force, flat) + LEAST_TENSION)


def _compression(force: Force, flat: np.ndarray) -> float:
    """How much larger squared lengths have to be for no zone to be compressed; 0 where none is."""
    g1x, g1y, g2x, g2y, _ = force.zone
    far = np.roll(flat, -1, axis=1) if force.closed else flat[:, 1:]
    near = flat if force.closed else flat[:, :-1]
    d1, d2 = far[:2, :, 1:] - near[:2, :, :-1], near[:2, :, 1:] - far[:2, :, :-1]
    f1, f2 = d1 * g1x + d2 * g2x, d1 * g1y + d2 * g2y
    c11, c22, c12 = (f1 * f1).sum(axis=0), (f2 * f2).sum(axis=0), (f1 * f2).sum(axis=0)
    mean, radius = 0.5 * (c11 + c22), np.hypot(0.5 * (c11 - c22), c12)
    nu = force.law.poisson  # type: ignore[attr-defined]  # every law has one
    # E2 + nu E1 of a state scaled by s is (s^2 ((1 + nu) mean - (1 - nu) radius) - (1 + nu)) / 2
    stress_free = (1.0 + nu) / np.maximum((1.0 + nu) * mean - (1.0 - nu) * radius, 1e-3)
    return max(float(stress_free.max()) - 1.0, 0.0)
