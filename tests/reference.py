"""Membrane and bending energy as plain array formulas: slow, independent of the kernels, real or complex.

Written from the definitions (Taylor et al. 2014, Eqs. 24 to 64) so that the kernels can be held against it. All is
scaled: lengths by grid.length_mm = L, energies by Y h L^2. Nothing here takes an absolute value or a
conjugate, so an imaginary step in r gives the gradient to rounding: dE/dr = Im E(r + i s) / s.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fdsolver.curvature import CurvatureConstants
from fdsolver.grid import Grid

# (E11, E22, E12) of all zones -> energy per unit volume / Y of all zones
Law = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]

UP = np.array([0.0, 0.0, 1.0])


def koiter_law(poisson: float) -> Law:
    """The quadratic plane-stress law (c (tr E)^2 + 2 mu E:E) / (2 Y) of Eq. 24."""
    c = poisson / (1 - poisson**2)
    two_mu = 1 / (1 + poisson)

    def energy(e11: np.ndarray, e22: np.ndarray, e12: np.ndarray) -> np.ndarray:
        return (c * (e11 + e22) ** 2 + two_mu * (e11**2 + e22**2 + 2 * e12**2)) / 2

    return energy


def tension_field_law(poisson: float) -> Law:
    """The relaxed law of Pipkin 1986, by its three cases."""
    tense_law = koiter_law(poisson)

    def energy(e11: np.ndarray, e22: np.ndarray, e12: np.ndarray) -> np.ndarray:
        mean = (e11 + e22) / 2
        radius = np.sqrt(((e11 - e22) / 2) ** 2 + e12**2)
        major, minor = mean + radius, mean - radius
        wrinkled = np.where(major.real > 0, major**2 / 2, 0 * major)
        tense = (minor.real > -poisson * major.real) & (major.real > 0)
        return np.where(tense, tense_law(e11, e22, e12), wrinkled)

    return energy


def zones(field: np.ndarray, closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Values of a node field at the corners a, b, c, d of every zone."""
    if closed:
        field = np.concatenate([field, field[:1]], axis=0)
    return field[:-1, :-1], field[1:, :-1], field[1:, 1:], field[:-1, 1:]


def zone_diagonals(grid: Grid) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """p = u_c - u_a, q = u_d - u_b and the area of every zone [58], scaled."""
    u_a, u_b, u_c, u_d = zones(grid.u / grid.length_mm, grid.closed)
    p, q = u_c - u_a, u_d - u_b
    return p, q, (p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]) / 2


def zone_gradient(field: np.ndarray, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """(f,1, f,2) of a node field (ni, nj, components) in every zone [57]."""
    p, q, area = zone_diagonals(grid)
    f_a, f_b, f_c, f_d = zones(field, grid.closed)
    ac, bd = f_c - f_a, f_d - f_b
    twice = 2 * area[..., None]
    return (ac * q[..., 1:] - bd * p[..., 1:]) / twice, (bd * p[..., :1] - ac * q[..., :1]) / twice


def zone_strain(r: np.ndarray, grid: Grid) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Green strains (E11, E22, E12) of every zone."""
    r_1, r_2 = zone_gradient(r, grid)
    return (dot(r_1, r_1) - 1) / 2, (dot(r_2, r_2) - 1) / 2, dot(r_1, r_2) / 2


def membrane_energy(r: np.ndarray, grid: Grid, law: Law) -> np.ndarray:
    """Sum over the zones of A_z W(F_z). r : (ni, nj, 3), scaled positions."""
    area = zone_diagonals(grid)[2]
    return np.sum(area * law(*zone_strain(r, grid)))


def neighbours(r: np.ndarray, axis: int, closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Next and previous node along an axis (the node itself past an end); index steps between them."""
    count = r.shape[axis]
    index = np.arange(count)
    if closed:
        after, before, step = (index + 1) % count, (index - 1) % count, np.full(count, 2.0)
    else:
        after, before = np.minimum(index + 1, count - 1), np.maximum(index - 1, 0)
        step = (after - before).astype(float)
    return np.take(r, after, axis), np.take(r, before, axis), step


def node_curvatures(
    r: np.ndarray, grid: Grid, constants: CurvatureConstants, clamped_normal: np.ndarray = UP
) -> tuple[np.ndarray, np.ndarray]:
    """b1 and b2 at every node. clamped_normal : (3,) or (ni, nj, 3), used at clamped nodes only."""
    east, west, step1 = neighbours(r, 0, grid.closed)
    north, south, step2 = neighbours(r, 1, False)
    normal = unit(cross((east - west) / step1[:, None, None], (north - south) / step2[:, None]))
    given = constants.clamped1 | constants.clamped2
    normal = np.where(given[..., None], clamped_normal, normal)
    across1, across2 = dot(normal, east - 2 * r + west), dot(normal, north - 2 * r + south)
    # At an end of the mesh the difference above is the step to the node inside; its mirror doubles it.
    return np.where(constants.clamped1, 2 * across1, across1), np.where(
        constants.clamped2, 2 * across2, across2
    )


def zone_twist(r: np.ndarray, grid: Grid) -> np.ndarray:
    """b12 of every zone."""
    r_a, r_b, r_c, r_d = zones(r, grid.closed)
    normal = unit(cross((r_b - r_a + r_c - r_d) / 2, (r_d - r_a + r_c - r_b) / 2))
    return dot(normal, r_c - r_b - r_d + r_a)


def node_twist(b12: np.ndarray, grid: Grid) -> np.ndarray:
    """Mean of b12 over the zones at every node."""
    ni, nj = grid.u.shape[:2]
    mean = np.zeros((ni, nj), b12.dtype)
    for i in range(ni):
        rows = [(i - 1) % ni, i] if grid.closed else [k for k in (i - 1, i) if 0 <= k < ni - 1]
        for j in range(nj):
            around = b12[rows][:, max(j - 1, 0) : j + 1]
            mean[i, j] = around.sum() / around.size
    return mean


def bending_energy(
    r: np.ndarray, grid: Grid, constants: CurvatureConstants, clamped_normal: np.ndarray = UP
) -> np.ndarray:
    """Bending energy of the conservative scheme. r : (ni, nj, 3), scaled positions."""
    k = constants
    b1, b2 = node_curvatures(r, grid, k, clamped_normal)
    b12 = zone_twist(r, grid)
    b3 = node_twist(b12, grid)
    node = k.K11 * b1**2 / 2 + k.K12 * b1 * b2 + k.K22 * b2**2 / 2
    node = node + (k.K13 * b1 + k.K23 * b2) * b3 + k.K33_rest * b3**2 / 2
    return np.sum(node) + np.sum(k.C33 * b12**2) / 2


def hourglass_energy(r: np.ndarray, grid: Grid, strength: float) -> np.ndarray:
    """Sum over the zones of k (|g|^2 - b12^2) / 2, g the part of r_c - r_b - r_d + r_a that F does not explain.

    k is the share `strength` of A (|g1|^2 + |g2|^2) / 12, where f,a = (f_c - f_a) g1_a + (f_d - f_b) g2_a.
    """
    p, q, area = zone_diagonals(grid)
    u_a, u_b, u_c, u_d = zones(grid.u / grid.length_mm, grid.closed)
    r_a, r_b, r_c, r_d = zones(r, grid.closed)
    r_1, r_2 = zone_gradient(r, grid)
    skew = u_c - u_b - u_d + u_a
    g = r_c - r_b - r_d + r_a - r_1 * skew[..., :1] - r_2 * skew[..., 1:]
    k = strength * (dot(p, p) + dot(q, q)) / (48 * area)
    return np.sum(k * (dot(g, g) - zone_twist(r, grid) ** 2)) / 2


def gradient(energy: Callable[[np.ndarray], np.ndarray], r: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """dE/dr at the given nodes (m, 2), shape (m, 3), by imaginary steps: no cancellation."""
    step = 1e-30
    result = np.empty((len(nodes), 3))
    for row, (i, j) in zip(result, nodes, strict=True):
        for k in range(3):
            moved = r.astype(complex)
            moved[i, j, k] += 1j * step
            row[k] = energy(moved).imag / step
    return result


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar product over the last axis, without conjugation."""
    return np.sum(a * b, axis=-1)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Vector product over the last axis."""
    return np.cross(a, b)


def unit(a: np.ndarray) -> np.ndarray:
    """Vectors of length one along a, without conjugation."""
    return a / np.sqrt(dot(a, a))[..., None]
