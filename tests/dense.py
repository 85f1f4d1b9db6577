"""Dense tangent stiffness and mass matrices of small meshes, to hold the matrix-free engine against."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from fdsolver.effects import Force

STEP = 1e-6  # scaled displacement: curvature of the energy costs its square, rounding 1e-16 / 1e-6


def tangent(force: Force, r: np.ndarray) -> np.ndarray:
    """-df/dr at r (c, ni, nj), symmetric (c n, c n), by central differences, one column at a time."""
    matrix = np.empty((r.size, r.size))
    up, down, place = np.empty_like(r), np.empty_like(r), r.copy()
    for k in range(r.size):
        for f, sign in ((up, 1.0), (down, -1.0)):
            place.flat[k] = r.flat[k] + sign * STEP
            force(place, f)
        place.flat[k] = r.flat[k]
        matrix[:, k] = (down - up).ravel() / (2.0 * STEP)
    return (matrix + matrix.T) / 2.0


def mass_matrix(mass: np.ndarray) -> np.ndarray:
    """The (3 n, 3 n) matrix of nodal masses (6, ni, nj): xx, yy, zz, xy, xz, yz.

    In the plane (2 n, 2 n) of (3, ni, nj): xx, yy, xy.
    """
    if len(mass) == 3:
        xx, yy, xy = (np.diag(part.ravel()) for part in mass)
        return np.block([[xx, xy], [xy, yy]])
    xx, yy, zz, xy, xz, yz = (np.diag(part.ravel()) for part in mass)
    return np.block([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def node_matrices(mass: np.ndarray) -> np.ndarray:
    """The 3 x 3 matrix of every node, (n, 3, 3), from masses (6, ni, nj)."""
    xx, yy, zz, xy, xz, yz = mass.reshape(6, -1)
    return np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), -1, 0)


def frequencies(force: Force, r: np.ndarray, mass: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Ascending eigenvalues w of K v = w m v with the nodes outside `free` (ni, nj) held."""
    loose = np.tile(free.ravel(), len(r))
    pair = (matrix[np.ix_(loose, loose)] for matrix in (tangent(force, r), mass_matrix(mass)))
    return eigh(*pair, eigvals_only=True)
