"""Stability of planar equilibria: the lowest eigenvalue of the exact out-of-plane tangent.

A planar sheet moves out of its plane independently of its motion in the plane, so its tangent K is a sparse matrix with
one unknown per node. It is measured against B, the tangent of the same sheet with so much all-round tension added that
no zone is compressed: K v = t B v. Bending has its full share in both, so t is near one for modes that bend, and the
sheet buckles where t falls below zero. However fine the mesh, t has the same meaning and separates well, which
eigenvalues against nodal masses do not: those of long waves sink with the fourth power of the cell.

Shifted and inverted, 1 / (t + s), the lowest values lie far apart and a few iterations find them. That needs a factor
of K + s B, which exists if and only if all t are above -s: a stable sheet is known by it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigsh
from threadpoolctl import threadpool_limits

from fdsolver.cholesky import Cholesky, NotPositiveDefinite, Pattern
from fdsolver.dissection import dissect
from fdsolver.effects import Force
from fdsolver.tangent import Tangent, reach_of, tangent

STEP = 1e-9  # displacement, L: the force is odd in it, so differences neither round nor bend at this size
TENSION = 1.5  # of the largest compressive strain, added all round: more than none is left
LEAST_TENSION = 1e-9  # strain that keeps B definite on a sheet that is neither bent nor stressed
MOST_NODES = 200_000  # beyond, the factors of B do not fit the memory of a small machine
ACCURACY = 1e-4  # of the eigenvalue: of t + s
# Shifts s: for sheets that are stable but for rounding, and for all. With c the largest compression, K lacks at
# most c of tension and B keeps at least (TENSION - 1) c, so t is above -1 / (TENSION - 1) where strains are small.
SHIFTS = (1e-6, 4.0)
BASIS = 8  # vectors of the iteration: more would take longer to build than to restart


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
    start = np.random.default_rng(seed).standard_normal(int(free.sum()))
    with threadpool_limits(1, user_api="blas"):  # the same bits on any number of cores
        tried = (_lowest(stiffness, metric, pattern, free, shift, start) for shift in SHIFTS)
        found = next((one for one in tried if one is not None), None)
    if found is None:
        return None
    value, vector = found
    mode = np.zeros(free.shape)
    mode[free] = vector
    mode /= mode.ravel()[np.argmax(np.abs(mode))]
    return value, mode, stiffness.evaluations + metric.evaluations


def _lowest(
    stiffness: Tangent, metric: Tangent, pattern: Pattern, free: np.ndarray, shift: float, start: np.ndarray
) -> tuple[float, np.ndarray] | None:
    """Lowest t of K v = t B v and its v over the free nodes; None where t is below -shift and no iteration finds it."""
    loose = np.flatnonzero(free)
    try:
        factor = Cholesky(replace(stiffness, values=stiffness.values + shift * metric.values), pattern)
    except NotPositiveDefinite:
        return None

    def inverse(right: np.ndarray) -> np.ndarray:
        field = np.zeros((1, *free.shape))
        field[0, free] = right.ravel()
        return factor.solve(field)[0, free]

    k, b = (part.matrix()[loose][:, loose] for part in (stiffness, metric))
    operator = LinearOperator(k.shape, matvec=inverse, dtype=float)
    basis = min(BASIS, loose.size)
    try:
        values, vectors = eigsh(k, 1, b, -shift, OPinv=operator, v0=start, tol=ACCURACY, ncv=basis)
    except (RuntimeError, ArpackError, ArpackNoConvergence):
        return None
    return float(values[0]), vectors[:, 0]


def _all_tense(force: Force, flat: np.ndarray) -> np.ndarray:
    """The planar state scaled up until every zone is tense in every direction."""
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
    needed = max(float(stress_free.max()) - 1.0, 0.0)
    return flat * np.sqrt(1.0 + TENSION * needed + LEAST_TENSION)
