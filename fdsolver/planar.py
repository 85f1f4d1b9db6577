"""Stability of planar equilibria: the lowest eigenvalue of the exact out-of-plane tangent.

A planar sheet moves out of its plane independently of its motion in the plane, so its tangent K is a sparse matrix with
one unknown per node. It is measured against B, the tangent of the same sheet with so much all-round tension added that
no zone is compressed: K v = t B v. Bending has its full share in both, so t is near one for modes that bend, and the
sheet buckles where t falls below zero. However fine the mesh, t has the same meaning and separates well, which
eigenvalues against nodal masses do not: those of long waves sink with the fourth power of the cell.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigsh, splu

from fdsolver.effects import Force

REACH = 2  # a node's force depends on nodes at most two mesh lines away
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
    matrix, evaluations = out_of_plane_tangent(force, flat)
    metric, more = out_of_plane_tangent(force, _all_tense(force, flat))
    matrix, metric = matrix[loose][:, loose], metric[loose][:, loose]
    start = np.random.default_rng(seed).standard_normal(loose.size)
    try:
        inverse = LinearOperator(metric.shape, matvec=splu(metric, permc_spec="MMD_AT_PLUS_A").solve)
        values, vectors = eigsh(matrix, 1, metric, which="SA", Minv=inverse, v0=start, tol=ACCURACY)
    except (RuntimeError, ArpackError, ArpackNoConvergence):
        return None
    mode = np.zeros(free.size)
    mode[loose] = vectors[:, 0]
    mode /= mode[np.argmax(np.abs(mode))]
    return float(values[0]), mode.reshape(free.shape), evaluations + more


def out_of_plane_tangent(force: Force, flat: np.ndarray) -> tuple[csc_matrix, int]:
    """-df_z/dz at a planar state, sparse over all nodes (rows of the mesh one after another), and evaluations spent.

    flat : (3, ni, nj) float64 with z = 0. Nodes so far apart that no force depends on two of them move together.
    """
    ni, nj = flat.shape[1:]
    place, f = flat.copy(), np.empty_like(flat)
    number = np.arange(ni * nj).reshape(ni, nj)
    rows, columns, values = [], [], []
    for owner_i in _owners(ni, force.closed):
        for owner_j in _owners(nj, False):
            touched = np.ix_(owner_i >= 0, owner_j >= 0)
            owner = number[owner_i][:, owner_j][touched]
            place[2] = 0.0
            place[2].ravel()[np.unique(owner)] = STEP
            force(place, f)
            rows.append(number[touched].ravel())
            columns.append(owner.ravel())
            values.append(f[2][touched].ravel() / -STEP)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    matrix = coo_matrix(entries, (ni * nj, ni * nj)).tocsc()
    return (0.5 * (matrix + matrix.T)).tocsc(), len(values)


def _owners(count: int, closed: bool) -> Iterator[np.ndarray]:
    """For each group of lines that may move together: (count,) the line of the group within reach of a line, or -1."""
    period = 2 * REACH + 1
    whole = count - count % period if closed else count
    groups = [np.arange(first, whole, period) for first in range(min(period, whole))]
    groups += [np.array([line]) for line in range(whole, count)]  # what is left over of a closed direction
    for group in groups:
        owner = np.full(count, -1)
        for shift in range(-REACH, REACH + 1):
            near = (group + shift) % count if closed else group + shift
            inside = (near >= 0) & (near < count)
            owner[near[inside]] = group[inside]
        yield owner


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
