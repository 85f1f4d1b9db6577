"""Nodal masses from a bound on the local stiffness, so that a unit time step is stable.

The mass in dynamic relaxation is free, only equilibria matter; the nearer it is to the stiffness, the fewer the steps.
A node gets a symmetric 3 x 3 mass, because a thin sheet is stiff along its tensions and soft across them. A zone's
energy changes by at most A tr(dF^T B dF) / 2 with

    tense       B = M l_1^2 (1 - n (x) n) + s_1 1,     M = 1 / (1 - nu^2), s_1 the largest size of a stress / Y,
    wrinkled    B = l_1^2 m (x) m + s_1 1,             m the direction of tension (relaxed laws only),

since the strain changes by sym F^T dF, which sees no motion along the normal n. With dF = d1 (x) g1 + d2 (x) g2 and
G the largest eigenvalue of the Gram matrix of g1, g2, the form is at most G (d1 B d1 + d2 B d2), and that at most
2 G sum of dr B dr over the four corners. The bending stencils give 16 times their moduli.
"""

from __future__ import annotations

import numpy as np

from fdsolver import plane_motion
from fdsolver.effects import Force
from fdsolver.membrane import strain, stress
from fdsolver.rows import compiled

SAFETY = 1.4  # over the bound m >= k / 4 of central differences; covers the growth of k between two updates
SLOPE = 0.05  # rotations up to this between two updates are covered
TURN = 1.0
FLOOR = 0.03  # least stiffness / Y counted on in any direction: a slack zone must not let its nodes fly
MARGIN = (
    2e-2  # strain within which a wrinkled zone may become tense, or a slack one taut, before the next update
)


@compiled
def _principal(c11, c22, c12):
    """Largest and smallest eigenvalue of a symmetric 2 x 2 matrix and the eigenvector (unit) of the largest."""
    mean, half = 0.5 * (c11 + c22), 0.5 * (c11 - c22)
    radius = np.sqrt(half * half + c12 * c12)
    angle = 0.5 * np.arctan2(c12, half)
    return mean + radius, mean - radius, np.cos(angle), np.sin(angle)


@compiled
def _gradient(r, i, k, j, zone, f):
    """Deformation gradient of zone (i, j), whose far node row is k, into f (3, 2); in the plane f[2] stays as it is."""
    g1x, g1y, g2x, g2y = zone[0, i, j], zone[1, i, j], zone[2, i, j], zone[3, i, j]
    for axis in range(r.shape[0]):
        d1, d2 = r[axis, k, j + 1] - r[axis, i, j], r[axis, i, j + 1] - r[axis, k, j]
        f[axis, 0], f[axis, 1] = d1 * g1x + d2 * g2x, d1 * g1y + d2 * g2y


@compiled
def _membrane_stiffness(law, r, ahead, zone, closed, relaxed, floor, margin, stiffness):
    """Add the zones' share of the stiffness bound to their corners; `ahead` is where r will be at the next call.

    r, ahead : (components, ni, nj). stiffness : (6, ni, nj), or (3, ni, nj) in the plane (xx, yy, xy).
    """
    rows, columns = r.shape[1], r.shape[2]
    space = r.shape[0] == 3
    xy = 3 if space else 2
    nu = law.poisson
    modulus = 1.0 / (1.0 - nu * nu)
    f, g = np.zeros((3, 2)), np.zeros((3, 2))
    for i in range(rows if closed else rows - 1):
        k = (i + 1) % rows
        for j in range(columns - 1):
            g1x, g1y, g2x, g2y = zone[0, i, j], zone[1, i, j], zone[2, i, j], zone[3, i, j]
            _gradient(r, i, k, j, zone, f)
            _gradient(ahead, i, k, j, zone, g)
            turn = ((f - g) ** 2).sum()
            e11, e22, e12 = strain(law, f)
            major, minor, cosine, sine = _principal(e11, e22, e12)
            s11, s22, s12, _ = stress(law, e11, e22, e12)
            e11, e22, e12 = strain(law, g)
            next_major, next_minor, _, _ = _principal(e11, e22, e12)
            # the strain changes by sym f^T dF, f being what `strain` has left of it
            c11, c22 = f[0, 0] ** 2 + f[1, 0] ** 2 + f[2, 0] ** 2, f[0, 1] ** 2 + f[1, 1] ** 2 + f[2, 1] ** 2
            c12 = f[0, 0] * f[0, 1] + f[1, 0] * f[1, 1] + f[2, 0] * f[2, 1]
            largest = _principal(c11, c22, c12)[0]
            most, least, _, _ = _principal(s11, s22, s12)
            # Compression counts as well: what it makes unstable must grow slowly, over many steps.
            tension = max(abs(most), abs(least)) + floor + TURN * turn
            lateral = minor + nu * major
            change = abs(next_minor + nu * next_major - lateral)
            a, b, c = g1x * g1x + g1y * g1y, g2x * g2x + g2y * g2y, g1x * g2x + g1y * g2y
            weight = 2.0 * zone[4, i, j] * _principal(a, b, c)[0]
            if relaxed and lateral + 2.0 * change + margin < 0.0:
                px, py, pz = (
                    f[0, 0] * cosine + f[0, 1] * sine,
                    f[1, 0] * cosine + f[1, 1] * sine,
                    f[2, 0] * cosine + f[2, 1] * sine,
                )
                shear = max(major, 0.0) / (major - minor + 1e-300) * largest
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
                stiffness[xy, row, column] += along * wx * wy
                if space:
                    stiffness[2, row, column] += across + along * wz * wz
                    stiffness[4, row, column] += along * wx * wz
                    stiffness[5, row, column] += along * wy * wz


@compiled
def _length(x, y, z):
    return np.sqrt(x * x + y * y + z * z)


@compiled
def _node_bending_stiffness(r, node, closed, stiffness):
    """Add the row-sum bound of the nodes' bending energy, (ni, nj), to the node and its four neighbours.

    b1 = n . s1 changes by n . d(s1), at most 4 |dr|, and by s1 . dn with |dn| <= (|t2| |d(t1)| + |t1| |d(t2)|) / |w|,
    w = t1 x t2. The second part is what counts in a sharp fold, where t1 and t2 become parallel.
    """
    rows, columns = r.shape[1], r.shape[2]
    for i in range(rows):
        west, east = i - 1, i + 1
        if closed:
            west, east = west % rows, east % rows
        west, east = max(west, 0), min(east, rows - 1)
        for j in range(columns):
            south, north = max(j - 1, 0), min(j + 1, columns - 1)
            t1x, t1y, t1z = (
                r[0, east, j] - r[0, west, j],
                r[1, east, j] - r[1, west, j],
                r[2, east, j] - r[2, west, j],
            )
            t2x, t2y, t2z = (
                r[0, i, north] - r[0, i, south],
                r[1, i, north] - r[1, i, south],
                r[2, i, north] - r[2, i, south],
            )
            x, y, z = 2.0 * r[0, i, j], 2.0 * r[1, i, j], 2.0 * r[2, i, j]
            s1 = _length(
                r[0, east, j] - x + r[0, west, j],
                r[1, east, j] - y + r[1, west, j],
                r[2, east, j] - z + r[2, west, j],
            )
            s2 = _length(
                r[0, i, north] - x + r[0, i, south],
                r[1, i, north] - y + r[1, i, south],
                r[2, i, north] - z + r[2, i, south],
            )
            w = _length(t1y * t2z - t1z * t2y, t1z * t2x - t1x * t2z, t1x * t2y - t1y * t2x) + 1e-300
            across1, across2 = _length(t2x, t2y, t2z) / w, _length(t1x, t1y, t1z) / w
            k11, k12, k22 = abs(node[0, i, j]), abs(node[1, i, j]), abs(node[2, i, j])
            k1, k2 = k11 + k12 + abs(node[3, i, j]), k12 + k22 + abs(node[4, i, j])
            along1, along2 = 1.0 + s1 * across1, s1 * across2  # |d b1 / d r| of E or W, of N or S
            other1, other2 = s2 * across1, 1.0 + s2 * across2
            sum1, sum2 = k1 * 2.0 * (1.0 + along1 + along2), k2 * 2.0 * (1.0 + other1 + other2)
            beside, above = along1 * sum1 + other1 * sum2, along2 * sum1 + other2 * sum2
            stiffness[i, j] += 2.0 * (sum1 + sum2)
            stiffness[east, j] += beside
            stiffness[west, j] += beside
            stiffness[i, north] += above
            stiffness[i, south] += above


@compiled
def _zone_bending_stiffness(r, node, c33, closed, stiffness):
    """Add the row-sum bound of the zones' twisting energy and their nodes' mixed moments to the corners."""
    rows, columns = r.shape[1], r.shape[2]
    for i in range(c33.shape[0]):
        k = (i + 1) % rows
        for j in range(columns - 1):
            d1x, d1y, d1z = (
                r[0, k, j + 1] - r[0, i, j],
                r[1, k, j + 1] - r[1, i, j],
                r[2, k, j + 1] - r[2, i, j],
            )
            d2x, d2y, d2z = (
                r[0, i, j + 1] - r[0, k, j],
                r[1, i, j + 1] - r[1, k, j],
                r[2, i, j + 1] - r[2, k, j],
            )
            sx = r[0, i, j] + r[0, k, j + 1] - r[0, k, j] - r[0, i, j + 1]
            sy = r[1, i, j] + r[1, k, j + 1] - r[1, k, j] - r[1, i, j + 1]
            sz = r[2, i, j] + r[2, k, j + 1] - r[2, k, j] - r[2, i, j + 1]
            w = _length(d1y * d2z - d1z * d2y, d1z * d2x - d1x * d2z, d1x * d2y - d1y * d2x) + 1e-300
            s, one, two = _length(sx, sy, sz) / w, _length(d1x, d1y, d1z), _length(d2x, d2y, d2z)
            mixed = 0.0
            for row, column in ((i, j), (k, j), (k, j + 1), (i, j + 1)):
                mixed += 0.25 * (
                    abs(node[3, row, column]) + abs(node[4, row, column]) + abs(node[5, row, column])
                )
            ac, bd = 1.0 + s * two, 1.0 + s * one
            total = (c33[i, j] + mixed) * 2.0 * (ac + bd)
            stiffness[i, j] += ac * total
            stiffness[k, j + 1] += ac * total
            stiffness[k, j] += bd * total
            stiffness[i, j + 1] += bd * total


def nodal_masses(
    force: Force, r: np.ndarray, ahead: np.ndarray, relaxed: bool, kind: str = "nodal"
) -> np.ndarray:
    """Masses that make a unit time step stable at the state r.

    r, ahead : (components, ni, nj) float64, scaled positions now and as they will be at the next update if nothing
        slows them.
    relaxed : whether the law carries no compression.
    kind : "nodal" (3 x 3), "isotropic" (its trace) or "uniform" (the maximum over the mesh, as published).

    Returns (6, ni, nj) float64: xx, yy, zz, xy, xz, yz of every node's mass, scaled (time step 1); in the plane
    (3, ni, nj): xx, yy, xy.
    """
    axes = force.components
    stiffness = np.zeros((axes * (axes + 1) // 2, force.rows, force.columns))
    _membrane_stiffness(force.law, r, ahead, force.zone, force.closed, relaxed, FLOOR, MARGIN, stiffness)
    if force.bound is not None:
        stiffness[2] += force.bound
    elif force.node is not None and force.twist is not None:
        bending = np.zeros((force.rows, force.columns))
        _node_bending_stiffness(r, force.node, force.closed, bending)
        _zone_bending_stiffness(r, force.node, force.twist[0], force.closed, bending)
        stiffness[:3] += bending
    force.fold_stiffness(stiffness)
    if kind in ("isotropic", "uniform"):
        trace = stiffness[:axes].sum(axis=0)
        stiffness[:axes] = trace if kind == "isotropic" else trace.max()
        stiffness[axes:] = 0.0
    elif kind != "nodal":
        raise ValueError(f"mass must be nodal, isotropic or uniform, not {kind!r}")
    return 0.25 * SAFETY * stiffness


def invert(mass: np.ndarray, free: np.ndarray, inverse: np.ndarray) -> None:
    """Inverse of every node's symmetric mass; zero at fixed nodes, which then never move.

    mass, inverse : (6, nodes), in the plane (3, nodes), float64. free : (nodes,) bool.
    """
    (_invert_in_space if len(mass) == 6 else plane_motion.invert)(mass, free, inverse)


@compiled
def _invert_in_space(mass, free, inverse):
    """`invert` of 3 x 3 masses."""
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
