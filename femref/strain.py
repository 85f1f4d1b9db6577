"""Membrane strain of a bicubic sheet, averaged over each element."""

from __future__ import annotations

import numpy as np

from femref.bicubic import Mesh


def mean_strain(mesh: Mesh, values: np.ndarray) -> np.ndarray:
    """Green strain (elements along x, along y, 2, 2), area means of each element, in the mesh's orthonormal directions.

    values : (ni, nj, 4, 3) nodal values of the deformed positions, mm.
    """
    along_x, along_y = mesh.axis_tables
    local = _local(mesh, values)
    radius = along_y.place[None, :, None, :, None] if mesh.polar else 1.0
    first = _derivative(along_x.values[:, :, 1], along_y.values[:, :, 0], local) / radius
    second = _derivative(along_x.values[:, :, 0], along_y.values[:, :, 1], local)
    tangents = np.stack([first, second])
    metric = np.einsum("aegstk,begstk->egstab", tangents, tangents)
    weight = along_x.weight[:, None, :, None] * along_y.weight[None, :, None, :]
    if mesh.polar:
        weight = weight * along_y.place[None, :, None, :]
    mean = np.einsum("egst,egstab->egab", weight, metric) / weight.sum(axis=(2, 3))[..., None, None]
    return 0.5 * (mean - np.eye(2))


def _local(mesh: Mesh, values: np.ndarray) -> np.ndarray:
    """(ex, ey, 4, 4, 3): nodal values of each element by function along x and along y."""
    if mesh.polar:
        values = np.concatenate([values, values[:1]])
    # kinds are slope along x, then slope along y
    by_slope = values.reshape(*values.shape[:2], 2, 2, -1)
    ends_x = np.concatenate([by_slope[:-1], by_slope[1:]], axis=2)
    return np.concatenate([ends_x[:, :-1], ends_x[:, 1:]], axis=3)


def _derivative(along_x: np.ndarray, along_y: np.ndarray, local: np.ndarray) -> np.ndarray:
    """(ex, ey, points, points, k) from functions (ex, points, 4) and (ey, points, 4)."""
    return np.einsum("esp,gtq,egpqk->egstk", along_x, along_y, local, optimize=True)
