"""Nodal masses from a bound on the local stiffness, so that a unit time step is stable.

The mass in dynamic relaxation is free, only equilibria matter; the nearer it is to the stiffness, the fewer the steps.
A node gets a symmetric 3 x 3 mass, because a thin sheet is stiff along its tensions and soft across them. A zone's
energy changes by at most A tr(dF^T B dF) / 2 with

    tense       B = M l_1^2 (1 - n (x) n) + s_1 1,     M = 1 / (1 - nu^2), s_1 the largest stress / Y,
    wrinkled    B = l_1^2 m (x) m + s_1 1,             m the direction of tension (relaxed laws only),

since the strain changes by sym F^T dF, which sees no motion along the normal n. With dF = d1 (x) g1 + d2 (x) g2 and
G the largest eigenvalue of the Gram matrix of g1, g2, the form is at most G (d1 B d1 + d2 B d2), and that at most
2 G sum of dr B dr over the four corners. The bending stencils give 16 times their moduli.
"""

from __future__ import annotations

import numpy as np

from fdsolver.effects import Force
from fdsolver.membrane import stress
from fdsolver.rows import compiled

SAFETY = 1.4  # over the bound m >= k / 4 of central differences; covers the growth of k between two updates
SLOPE = 0.05  # rotations up to this between two updates are covered
TURN = 1.0
FLOOR = 0.03  # least stiffness / Y counted on in any direction: a slack zone must not let its nodes fly
MARGIN = 2e-2  # strain within which a wrinkled zone may become tense, or a slack one taut, before the next update


@compiled
def _principal(c11, c22, c12):
    """Largest and smallest eigenvalue of a symmetric 2 x 2 matrix and the eigenvector (unit) of the largest."""
    mean, half = 0.5 * (c11 + c22), 0.5 * (c11 - c22)
    radius = np.sqrt(half * half + c12 * c12)
    angle = 0.5 * np.arctan2(c12, half)
    return mean + radius, mean - radius, np.cos(angle), np.sin(angle)


@compiled
def _membrane_stiffness(law, r, ahead, zone, closed, relaxed, floor, margin, stiffness):
    """Add the zones' share of the stiffness bound to their corners; `ahead` is where r is heading until the next call."""
    rows, columns = r.shape[1], r.shape[2]
    nu = law.poisson
    modulus = 1.0 / (1.0 - nu * nu)
    f, g = np.zeros((3, 2)), np.zeros((3, 2))
    for i in range(rows if closed else rows - 1):
        k = (i + 1) % rows
        for j in range(columns - 1):
            g1x, g1y, g2x, g2y = zone[0, i, j], zone[1, i, j], zone[2, i, j], zone[3, i, j]
            for axis in range(3):
                d1, d2 = r[axis, k, j + 1] - r[axis, i, j], r[axis, i, j + 1] - r[axis, k, j]
                f[axis, 0], f[axis, 1] = d1 * g1x + d2 * g2x, d1 * g1y + d2 * g2y
                d1, d2 = ahead[axis, k, j + 1] - ahead[axis, i, j], ahead[axis, i, j + 1] - ahead[axis, k, j]
                g[axis, 0], g[axis, 1] = d1 * g1x + d2 * g2x, d1 * g1y + d2 * g2y
            c11, c22 = f[0, 0] ** 2 + f[1, 0] ** 2 + f[2, 0] ** 2, f[0, 1] ** 2 + f[1, 1] ** 2 + f[2, 1] ** 2
            c12 = f[0, 0] * f[0, 1] + f[1, 0] * f[1, 1] + f[2, 0] * f[2, 1]
            largest, smallest, cosine, sine = _principal(c11, c22, c12)
            s11, s22, s12, _ = stress(law, 0.5 * (c11 - 1.0), 0.5 * (c22 - 1.0), 0.5 * c12)
            turn = ((f - g) ** 2).sum()
            tension = max(_principal(s11, s22, s12)[0], 0.0) + floor + TURN * turn
            b11, b22 = g[0, 0] ** 2 + g[1, 0] ** 2 + g[2, 0] ** 2, g[0, 1] ** 2 + g[1, 1] ** 2 + g[2, 1] ** 2
            b12 = g[0, 0] * g[0, 1] + g[1, 0] * g[1, 1] + g[2, 0] * g[2, 1]
            next_largest, next_smallest, _, _ = _principal(b11, b22, b12)
            lateral = 0.5 * (smallest - 1.0 + nu * (largest - 1.0))
            change = abs(0.5 * (next_smallest - 1.0 + nu * (next_largest - 1.0)) - lateral)
            a, b, c = g1x * g1x + g1y * g1y, g2x * g2x + g2y * g2y, g1x * g2x + g1y * g2y
            weight = 2.0 * zone[4, i, j] * _principal(a, b, c)[0]
            if relaxed and lateral + 2.0 * change + margin < 0.0:
                px, py, pz = f[0, 0] * cosine + f[0, 1] * sine, f[1, 0] * cosine + f[1, 1] * sine, f[2, 0] * cosine + f[2, 1] * sine
                shear = max(largest - 1.0, 0.0) / (largest - smallest + 1e-300) * largest
                along, across = weight * largest, weight * (tension + shear)
                size = np.sqrt(px * px + py * py + pz * pz)
                wx, wy, wz = px / size, py / size, pz / size
            else:
                nx = f[1, 0] * f[2, 1] - f[2, 0] * f[1, 1]
                ny = f[2, 0] * f[0, 1] - f[0, 0] * f[2, 1]
                nz = f[0, 0] * f[1, 1] - f[1, 0] * f[0, 1]
                size = np.sqrt(nx * nx + ny * ny + nz * nz) + 1e-300
                wx, wy, wz = nx / size, ny / size, nz / size
                along = -weight * modulus * largest * (1.0 - floor)
                across = weight * (modulus * largest + tension)
            for row, column in ((i, j), (k, j), (k, j + 1), (i, j + 1)):
                stiffness[0, row, column] += across + along * wx * wx
                stiffness[1, row, column] += across + along * wy * wy
                stiffness[2, row, column] += across + along * wz * wz
                stiffness[3, row, column] += along * wx * wy
                stiffness[4, row, column] += along * wx * wz
                stiffness[5, row, column] += along * wy * wz


def _bending_stiffness(force: Force) -> np.ndarray:
    """Row-sum bound of the bending stiffness at every node, (ni, nj), scaled."""
    assert force.node is not None and force.c33 is not None
    k11, k12, k22, k13, k23, k33 = np.abs(force.node[:6])
    first, second, mixed = k11 + k12 + k13, k12 + k22 + k23, k13 + k23 + np.abs(k33)
    stiffness = 16.0 * (first + second) + 4.0 * mixed
    corner = 4.0 * force.c33
    around = np.roll(corner, 1, axis=0) if force.closed else corner
    near, far = (slice(None), slice(None)) if force.closed else (slice(None, -1), slice(1, None))
    for columns in (slice(None, -1), slice(1, None)):
        stiffness[near, columns] += corner
        stiffness[far, columns] += around
    return stiffness


def nodal_masses(force: Force, r: np.ndarray, ahead: np.ndarray, relaxed: bool, kind: str = "nodal") -> np.ndarray:
    """Masses that make a unit time step stable at the state r.

    r, ahead : (3, ni, nj) float64, scaled positions now and as they will be at the next update if nothing slows them.
    relaxed : whether the law carries no compression.
    kind : "nodal" (3 x 3), "isotropic" (its largest eigenvalue) or "uniform" (the maximum over the mesh, as published).

    Returns (6, ni, nj) float64: xx, yy, zz, xy, xz, yz of every node's mass, scaled (time step 1).
    """
    stiffness = np.zeros((6, force.rows, force.columns))
    _membrane_stiffness(force.law, r, ahead, force.zone, force.closed, relaxed, FLOOR, MARGIN, stiffness)
    if force.node is not None:
        stiffness[:3] += _bending_stiffness(force)
    if kind in ("isotropic", "uniform"):
        trace = stiffness[:3].sum(axis=0)
        stiffness[:3] = trace if kind == "isotropic" else trace.max()
        stiffness[3:] = 0.0
    elif kind != "nodal":
        raise ValueError(f"mass must be nodal, isotropic or uniform, not {kind!r}")
    return 0.25 * SAFETY * stiffness


@compiled
def invert(mass, free, inverse):
    """Inverse of every node's symmetric mass; zero at fixed nodes, which then never move. Arrays (6, ...) flat."""
    for k in range(free.size):
        if not free[k]:
            for m in range(6):
                inverse[m, k] = 0.0
            continue
        a, b, c, d, e, f = mass[0, k], mass[1, k], mass[2, k], mass[3, k], mass[4, k], mass[5, k]
        xx, yy, zz = b * c - f * f, a * c - e * e, a * b - d * d
        xy, xz, yz = e * f - c * d, d * f - b * e, d * e - a * f
        determinant = a * xx + d * xy + e * xz
        inverse[0, k], inverse[1, k], inverse[2, k] = xx / determinant, yy / determinant, zz / determinant
        inverse[3, k], inverse[4, k], inverse[5, k] = xy / determinant, xz / determinant, yz / determinant
