"""Stability of planar equilibria: the lowest eigenvalue of the exact out-of-plane tangent.

A planar sheet moves out of its plane independently of its motion in the plane, so its tangent K is a sparse matrix with
one unknown per node. It is measured against B, the tangent of the same sheet with so much all-round tension added that
no zone is compressed: K v = t B v. Bending has its full share in both, so t is near one for modes that bend, and the
sheet buckles where t falls below zero. However fine the mesh, t has the same meaning and separates well, which
eigenvalues against nodal masses do not: those of long waves sink with the fourth power of the cell.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigsh, splu

from fdsolver.effects import Force
from fdsolver.tangent import tangent

STEP = 1e-9  # displacement, L: the force is odd in it, so differences neither round nor bend at this size
TENSION = 1.5  # of the largest compressive strain, added all round: more than none is left
LEAST_TENSION = 1e-9  # strain that keeps B definite on a sheet that is neither bent nor stressed
MOST_NODES = 200_000  # beyond, the factors of B do not fit the memory of a small machine
ACCURACY = 1e-4  # of the eigenvalue, relative to B


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
    loose = np.flatnonzero(free)
    tangents = [tangent(force, state, (2,), STEP) for state in (flat, _all_tense(force, flat))]
    matrix, metric = (part.matrix()[loose][:, loose] for part in tangents)
    start = np.random.default_rng(seed).standard_normal(loose.size)
    try:
        inverse = LinearOperator(metric.shape, matvec=splu(metric, permc_spec="MMD_AT_PLUS_A").solve)
        values, vectors = eigsh(matrix, 1, metric, which="SA", Minv=inverse, v0=start, tol=ACCURACY)
    except (RuntimeError, ArpackError, ArpackNoConvergence):
        return None
    mode = np.zeros(free.size)
    mode[loose] = vectors[:, 0]
    mode /= mode[np.argmax(np.abs(mode))]
    return float(values[0]), mode.reshape(free.shape), sum(part.evaluations for part in tangents)


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
