"""Energies of the models with effects left out, by array formulas from the definitions; real or complex.

The linear curvature is written from what it is: second differences of the out-of-plane position less the slope times
those of the mesh, the slope being what fits the differences along the two tangents.
"""

from __future__ import annotations

import numpy as np

from fdsolver.curvature import CurvatureConstants
from fdsolver.grid import Grid
from tests import reference
from tests.reference import Law, dot, neighbours, zone_diagonals, zone_gradient, zones


def moderate_membrane_energy(r: np.ndarray, grid: Grid, law: Law) -> np.ndarray:
    """Sum of A W(E), E_ab = (u_a,b + u_b,a + w,a w,b) / 2. r : (ni, nj, 3), scaled positions; u = r - x."""
    flat = np.pad(grid.u / grid.length_mm, ((0, 0), (0, 0), (0, 1)))
    u_1, u_2 = zone_gradient(r - flat, grid)
    e11 = u_1[..., 0] + u_1[..., 2] ** 2 / 2
    e22 = u_2[..., 1] + u_2[..., 2] ** 2 / 2
    e12 = (u_2[..., 0] + u_1[..., 1] + u_1[..., 2] * u_2[..., 2]) / 2
    return np.sum(zone_diagonals(grid)[2] * law(e11, e22, e12))


def _differences(field: np.ndarray, closed: bool) -> list[np.ndarray]:
    """Differences of a node field along both mesh directions, per index step, and second differences."""
    found = []
    for axis, is_closed in ((0, closed), (1, False)):
        after, before, step = neighbours(field, axis, is_closed)
        shape = [1] * field.ndim
        shape[axis] = len(step)
        found += [(after - before) / step.reshape(shape), after - 2 * field + before]
    return [found[0], found[2], found[1], found[3]]


def _less_slope(
    t1: np.ndarray, t2: np.ndarray, w1: np.ndarray, w2: np.ndarray, s: np.ndarray, ws: np.ndarray
) -> np.ndarray:
    """ws - grad w . s with grad w from its differences w1, w2 along the vectors t1, t2."""
    slope = np.linalg.solve(
        np.stack([t1, t2], axis=-2).astype(w1.dtype), np.stack([w1, w2], axis=-1)[..., None]
    )
    return ws - dot(slope[..., 0], s)


def linear_bending_energy(r: np.ndarray, grid: Grid, k: CurvatureConstants) -> np.ndarray:
    """Bending energy of the curvatures w,ab. r : (ni, nj, 3), scaled positions, of which only w = r_3 counts."""
    u, w = grid.u / grid.length_mm, r[..., 2]
    t1, t2, s1, s2 = _differences(u, grid.closed)
    w1, w2, ws1, ws2 = _differences(w, grid.closed)
    b1, b2 = _less_slope(t1, t2, w1, w2, s1, ws1), _less_slope(t1, t2, w1, w2, s2, ws2)
    given = k.clamped1 | k.clamped2  # the slope is zero there, and the mirror node doubles the step inwards
    b1 = np.where(given, np.where(k.clamped1, 2 * ws1, ws1), b1)
    b2 = np.where(given, np.where(k.clamped2, 2 * ws2, ws2), b2)
    u_a, u_b, u_c, u_d = zones(u, grid.closed)
    w_a, w_b, w_c, w_d = zones(w, grid.closed)
    b12 = _less_slope(
        u_c - u_a, u_d - u_b, w_c - w_a, w_d - w_b, u_c - u_b - u_d + u_a, w_c - w_b - w_d + w_a
    )
    b3 = reference.node_twist(b12, grid)
    node = k.K11 * b1**2 / 2 + k.K12 * b1 * b2 + k.K22 * b2**2 / 2
    node = node + (k.K13 * b1 + k.K23 * b2) * b3 + k.K33_rest * b3**2 / 2
    return np.sum(node) + np.sum(k.C33 * b12**2) / 2


def plane_hourglass_energy(r: np.ndarray, grid: Grid, strength: float) -> np.ndarray:
    """The hourglass energy of `reference` for the in-plane part of a state alone: k |g|^2 / 2 without curvature."""
    p, q, area = zone_diagonals(grid)
    u_a, u_b, u_c, u_d = zones(grid.u / grid.length_mm, grid.closed)
    x_a, x_b, x_c, x_d = zones(r[..., :2], grid.closed)
    x_1, x_2 = zone_gradient(r[..., :2], grid)
    skew = u_c - u_b - u_d + u_a
    g = x_c - x_b - x_d + x_a - x_1 * skew[..., :1] - x_2 * skew[..., 1:]
    return np.sum(strength * (dot(p, p) + dot(q, q)) / (48 * area) * dot(g, g)) / 2
