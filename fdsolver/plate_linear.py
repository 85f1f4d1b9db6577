"""Kernel of the plate whose curvature is linear: b_ab = w,ab, the second derivatives of the out-of-plane position.

That is Koiter's plate without the strain-gradient effect (the normal stays e3, so its variation puts no couple on the
strain) and the bending of moderate rotations. In index coordinates, with second differences s1, s2 and tangents t1, t2
of `plate`, the flat mesh itself has s1 = a11 t1 + a12 t2 and s2 = a21 t1 + a22 t2 at a node and
s = alpha d1 + beta d2 in a zone, so that

    b1 = w_E - 2 w + w_W - a11 t1(w) - a12 t2(w),      b2 = w_N - 2 w + w_S - a21 t1(w) - a22 t2(w)
    b12 = w_c - w_b - w_d + w_a - alpha (w_c - w_a) - beta (w_d - w_b)

vanish where w is affine. They are what `plate` measures on a flat sheet to first order in w: the energy has the same
constants K, C33, and is quadratic in w. The force has only the out-of-plane component.
In the plane a zone carries the hourglass stiffness of `plate`, k (g_x^2 + g_y^2) / 2.
"""

from __future__ import annotations

import numpy as np

from fdsolver import membrane
from fdsolver.curvature import CurvatureConstants
from fdsolver.curvature_response import node_steps
from fdsolver.grid import Grid
from fdsolver.membrane import T1X, T1Y, T1Z, T2X, T2Y, T2Z, UPPER_X, UPPER_Y, UPPER_Z, XA, XB, YA, YB, ZA, ZB
from fdsolver.plate import node_constants
from fdsolver.plate_rows import gather_nodes, keep_upper, node_row
from fdsolver.rows import ONE, clear, compiled, load, move, slots

ZC = slots(1, membrane.SLOTS)[0]  # out-of-plane position of node row i + 2
K11, K12, K22, A11, A12, A21, A22, K13, K23, K33, SHARE = slots(11, membrane.SLOTS + 1)
OLD_B12, NEW_B12, OLD_M3, NEW_M3 = slots(4, membrane.SLOTS + 12)  # of zone rows and node rows i and i + 1
EAST, WEST, NORTH, SOUTH, SELF, PAST, SUM, BEND = slots(8, membrane.SLOTS + 16)  # as in `plate_rows`, of w
QX, QY, QZ, C33, HOURGLASS, ALPHA, BETA = slots(7, membrane.SLOTS + 24)
SLOTS = membrane.SLOTS + 31


def linear_constants(grid: Grid, k: CurvatureConstants) -> np.ndarray:
    """K11, K12, K22 of `plate.node_constants`, then c1 a11, c2 a12, c1 a21, c2 a22; (7, ni, nj), scaled.

    On meshes whose lines are not orthogonal K13, K23, K33 and the share follow: (11, ni, nj).
    """
    u = np.ascontiguousarray(np.moveaxis(grid.u, 2, 0)) / grid.length_mm
    east, west, north, south = node_steps(u, grid.closed)
    c1, c2 = k.c1[:, None], k.c2
    t1, t2 = c1 * (east - west), c2 * (north - south)
    area = t1[0] * t2[1] - t1[1] * t2[0]
    tangents = []
    for s in (east + west, north + south):
        tangents += [c1 * (s[0] * t2[1] - s[1] * t2[0]) / area, c2 * (t1[0] * s[1] - t1[1] * s[0]) / area]
    # At a clamped edge the given normal is e3 itself: nothing to subtract for the slope.
    follows = np.where(k.clamped1 | k.clamped2, 0.0, 1.0)
    moduli = node_constants(k)
    coupling = moduli[3:7] if not k.orthogonal else moduli[:0]
    return np.concatenate([moduli[:3], follows * np.stack(tangents), coupling])


def stiffness_bound(node: np.ndarray, twist: np.ndarray, closed: bool) -> np.ndarray:
    """Row-sum bound of the bending energy's stiffness, (ni, nj): E'' <= sum of bound w^2 / 2. A constant of the mesh.

    node : of `linear_constants`. twist : (4, zone rows, nj - 1), C33 and `plate.hourglass_constants`.
    """
    k11, k12, k22 = np.abs(node[:3])
    a11, a12, a21, a22 = node[3:7]
    coupling = node[7:] if len(node) > 7 else np.zeros((4, *node.shape[1:]))
    k13, k23, k33 = np.abs(coupling[:3])
    bound = np.zeros(node.shape[1:])
    mixed = coupling[3] * (k13 + k23 + k33)
    for modulus, parts in (
        (k11 + k12 + k13, (1.0 - a11, 1.0 + a11, a12, a12)),
        (k12 + k22 + k23, (a21, a21, 1.0 - a22, 1.0 + a22)),
    ):
        east, west, north, south = np.abs(parts)
        weight = modulus * (2.0 + east + west + north + south)
        bound += 2.0 * weight
        _spread(bound, weight * east, weight * west, weight * north, weight * south, closed)
    alpha, beta = twist[2:]
    corners = np.abs([1.0 + alpha, 1.0 + beta, 1.0 - alpha, 1.0 - beta])  # of w_a, w_b, w_c, w_d
    far = np.roll(mixed, -1, axis=0) if closed else mixed[1:]
    near = mixed if closed else mixed[:-1]
    around = near[:, :-1] + far[:, :-1] + far[:, 1:] + near[:, 1:]
    pulls = (np.abs(twist[0]) + around) * corners.sum(axis=0) * corners
    rows = len(bound)
    first = np.arange(twist.shape[1])
    following = (first + 1) % rows
    bound[first, :-1] += pulls[0]
    bound[following, :-1] += pulls[1]
    bound[following, 1:] += pulls[2]
    bound[first, 1:] += pulls[3]
    return bound


def _spread(
    bound: np.ndarray, east: np.ndarray, west: np.ndarray, north: np.ndarray, south: np.ndarray, closed: bool
) -> None:
    """Add what a node puts on its neighbours; a missing neighbour is the node itself."""
    rows, columns = bound.shape
    i, j = np.arange(rows), np.arange(columns)
    after, before = ((i + 1) % rows, (i - 1) % rows) if closed else (i + 1, i - 1)
    np.add.at(bound, np.clip(after, 0, rows - 1), east)
    np.add.at(bound, np.clip(before, 0, rows - 1), west)
    np.add.at(bound.T, np.clip(j + 1, 0, columns - 1), north.T)
    np.add.at(bound.T, np.clip(j - 1, 0, columns - 1), south.T)


@compiled
def zone_curvature_row(s, columns):
    """Mixed curvature b12 of the zones between node rows i + 1 and i + 2."""
    for j in range(columns):
        za, zb, zc, zd = s[ZB + j], s[ZC + j], s[ZC + ONE + j], s[ZB + ONE + j]
        s[NEW_B12 + j] = zc - zb - zd + za - s[ALPHA + j] * (zc - za) - s[BETA + j] * (zd - zb)


@compiled
def node_moment_row(s, columns, coupling):
    """Curvatures and moments of node row i + 1 and their gradient on the node and its neighbours; returns energy.

    coupling : None where b3 has no part in the energy; decided when this is compiled.
    """
    energy = 0.0
    for j in range(columns):
        w = s[ZB + j]
        east, west = s[ZC + j] - w, s[ZA + j] - w
        north, south = s[ZB + ONE + j] - w, s[ZB - ONE + j] - w
        a11, a12, a21, a22 = s[A11 + j], s[A12 + j], s[A21 + j], s[A22 + j]
        b1 = east + west - a11 * (east - west) - a12 * (north - south)
        b2 = north + south - a21 * (east - west) - a22 * (north - south)
        m1 = s[K11 + j] * b1 + s[K12 + j] * b2
        m2 = s[K12 + j] * b1 + s[K22 + j] * b2
        energy += 0.5 * (m1 * b1 + m2 * b2)
        if coupling is not None:
            share, k13, k23, k33 = s[SHARE + j], s[K13 + j], s[K23 + j], s[K33 + j]
            b3 = share * (s[OLD_B12 + j] + s[OLD_B12 - ONE + j] + s[NEW_B12 + j] + s[NEW_B12 - ONE + j])
            energy += b3 * (k13 * b1 + k23 * b2 + 0.5 * k33 * b3)
            s[NEW_M3 + j] = share * (k13 * b1 + k23 * b2 + k33 * b3)
            m1, m2 = m1 + k13 * b3, m2 + k23 * b3
        h1, h2 = a11 * m1 + a21 * m2, a12 * m1 + a22 * m2
        s[EAST + j], s[WEST + j] = m1 - h1, m1 + h1
        s[NORTH + j], s[SOUTH + j] = m2 - h2, m2 + h2
        s[SELF + j] = -2.0 * (m1 + m2)
    return energy


@compiled
def zone_moment_row(s, columns, coupling):
    """Add mixed moment and hourglass stiffness of zone row i to the forces on its diagonals; returns both energies."""
    energy = hourglass = 0.0
    for j in range(columns):
        d1x, d1y = s[XB + ONE + j] - s[XA + j], s[YB + ONE + j] - s[YA + j]
        d2x, d2y = s[XA + ONE + j] - s[XB + j], s[YA + ONE + j] - s[YB + j]
        sx = s[XB + ONE + j] - s[XB + j] - s[XA + ONE + j] + s[XA + j]
        sy = s[YB + ONE + j] - s[YB + j] - s[YA + ONE + j] + s[YA + j]
        k, alpha, beta, b12 = s[HOURGLASS + j], s[ALPHA + j], s[BETA + j], s[OLD_B12 + j]
        energy += 0.5 * s[C33 + j] * b12 * b12
        gx, gy = sx - alpha * d1x - beta * d2x, sy - alpha * d1y - beta * d2y
        hourglass += 0.5 * k * (gx * gx + gy * gy)
        gx, gy = k * gx, k * gy
        m = s[C33 + j] * b12
        if coupling is not None:
            m += s[OLD_M3 + j] + s[OLD_M3 + ONE + j] + s[NEW_M3 + j] + s[NEW_M3 + ONE + j]
        s[T1X + j], s[T2X + j] = s[T1X + j] - alpha * gx, s[T2X + j] - beta * gx
        s[T1Y + j], s[T2Y + j] = s[T1Y + j] - alpha * gy, s[T2Y + j] - beta * gy
        s[T1Z + j], s[T2Z + j] = s[T1Z + j] - alpha * m, s[T2Z + j] - beta * m
        s[QX + j], s[QY + j], s[QZ + j] = gx, gy, m
    return energy, hourglass


@compiled
def in_plane_row(s, f, start, columns, t1, t2, q, upper):
    """Force on a row of nodes, one component in the plane: no moment reaches it."""
    for j in range(columns):
        f[start + j] = s[upper + j] + s[t1 + j] - s[q + j] - s[t2 - ONE + j] + s[q - ONE + j]


@compiled
def load_constants(s, slot, source, first, count, row, rows, columns):
    """Load one row of the fields first, ..., first + count - 1 of `source` into as many slots."""
    plane, start = np.uint64(rows) * columns, np.uint64(row) * columns
    for k in range(count):
        load(s, slot + np.uint64(k) * (K12 - K11), source, np.uint64(first + k) * plane + start, columns)


@compiled
def band(law, r, f, zone, energy, rows, columns, closed, start, stop, s, node, twist, coupling):
    """As `plate.band`; node, coupling : the first 7 fields of `linear_constants`, and the rest or None; flat."""
    n = np.uint64(columns)
    cells = n - ONE
    zone_rows = rows if closed else rows - 1
    plane = np.uint64(rows) * n
    for t in (T1X, T1Y, T1Z, T2X, T2Y, T2Z, QX, QY, QZ, UPPER_X, UPPER_Y, UPPER_Z):
        clear(s, t, n)
    for t in (OLD_B12, NEW_B12, OLD_M3, NEW_M3, EAST, WEST, NORTH, SOUTH, SELF, PAST, SUM, BEND):
        clear(s, t, n)
    for i in range(start - 3, stop):
        for slot, k in ((ZA, i), (ZB, i + 1), (ZC, i + 2)):
            row = k % rows if closed else min(max(k, 0), rows - 1)
            load(s, slot, r, plane + plane + np.uint64(row) * n, n)
            s[slot - ONE] = s[slot]
            s[slot + n] = s[slot + cells]
        move(s, OLD_B12, NEW_B12, n)
        if coupling is not None:
            move(s, OLD_M3, NEW_M3, n)
        if closed or 0 <= i + 1 < zone_rows:
            load_constants(s, ALPHA, twist, 2, 2, (i + 1) % rows, zone_rows, cells)
            zone_curvature_row(s, cells)
        else:
            clear(s, NEW_B12, n)
        if i + 1 < start - 1:
            continue
        if closed or 0 <= i + 1 < rows:
            load_constants(s, K11, node, 0, 7, (i + 1) % rows, rows, n)
            if coupling is not None:
                load_constants(s, K13, coupling, 0, 4, (i + 1) % rows, rows, n)
            node_energy = node_moment_row(s, n, coupling)
            gather_nodes(
                s, n, not closed and i + 1 == 0, False, EAST, WEST, NORTH, SOUTH, SELF, PAST, SUM, BEND
            )
            if start <= i + 1 < stop:
                energy[1, i + 1] = node_energy
        elif i + 1 == rows:
            gather_nodes(s, n, False, True, EAST, WEST, NORTH, SOUTH, SELF, PAST, SUM, BEND)
            clear(s, NEW_M3, n)
        if i < start - 1:
            continue
        if closed or 0 <= i < zone_rows:
            here, after = i % rows, (i + 1) % rows
            for slot_x, slot_y, row in ((XA, YA, here), (XB, YB, after)):
                load(s, slot_x, r, np.uint64(row) * n, n)
                load(s, slot_y, r, plane + np.uint64(row) * n, n)
            membrane.load_zones(s, zone, here, zone_rows, cells)
            load_constants(s, C33, twist, 0, 4, here, zone_rows, cells)
            membrane_energy = membrane.zone_row(s, law, cells)
            bending_energy, hourglass_energy = zone_moment_row(s, cells, coupling)
        else:
            membrane_energy = bending_energy = hourglass_energy = 0.0
            for t in (T1X, T1Y, T1Z, T2X, T2Y, T2Z, QX, QY, QZ):
                clear(s, t, n)
        if i >= start:
            first = np.uint64(i) * n
            in_plane_row(s, f, first, n, T1X, T2X, QX, UPPER_X)
            in_plane_row(s, f, plane + first, n, T1Y, T2Y, QY, UPPER_Y)
            node_row(s, f, plane + plane + first, n, T1Z, T2Z, QZ, UPPER_Z, BEND)
            energy[0, i] = membrane_energy
            energy[1, i] += bending_energy
            energy[2, i] = hourglass_energy
        keep_upper(s, n, T1X, T2X, QX, UPPER_X)
        keep_upper(s, n, T1Y, T2Y, QY, UPPER_Y)
        keep_upper(s, n, T1Z, T2Z, QZ, UPPER_Z)
