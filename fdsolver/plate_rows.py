"""Row stages of the plate kernel; the equations stand in `plate`, which puts the stages in order."""

from __future__ import annotations

import numpy as np

from fdsolver import membrane
from fdsolver.membrane import T1X, T1Y, T1Z, T2X, T2Y, T2Z, XA, XB, YA, YB, ZA, ZB
from fdsolver.rows import ONE, compiled, load, slots

XC, YC, ZC = slots(3, membrane.SLOTS)  # positions of node row i + 2
K11, K12, K22, K13, K23, K33, SHARE, C2 = slots(8, membrane.SLOTS + 3)
# Normal, 1 / |d1 x d2| and mixed curvature of the zone rows i (old) and i + 1 (new).
OLD_NX, OLD_NY, OLD_NZ, OLD_SCALE, OLD_B12 = slots(5, membrane.SLOTS + 11)
NEW_NX, NEW_NY, NEW_NZ, NEW_SCALE, NEW_B12 = slots(5, membrane.SLOTS + 16)
OLD_M3, NEW_M3 = slots(
    2, membrane.SLOTS + 21
)  # mixed moments of node rows i and i + 1, shared out to their zones
EAST_X, EAST_Y, EAST_Z, WEST_X, WEST_Y, WEST_Z = slots(
    6, membrane.SLOTS + 23
)  # of node row i + 1 on its neighbours
NORTH_X, NORTH_Y, NORTH_Z, SOUTH_X, SOUTH_Y, SOUTH_Z = slots(6, membrane.SLOTS + 29)
SELF_X, SELF_Y, SELF_Z = slots(3, membrane.SLOTS + 35)
PAST_X, PAST_Y, PAST_Z = slots(3, membrane.SLOTS + 38)  # EAST of node row i
SUM_X, SUM_Y, SUM_Z = slots(3, membrane.SLOTS + 41)  # gradient at node row i from node rows up to i
BEND_X, BEND_Y, BEND_Z = slots(3, membrane.SLOTS + 44)  # complete gradient at node row i from nodes
QX, QY, QZ = slots(3, membrane.SLOTS + 47)  # gradient of zone row i on r_c - r_b - r_d + r_a
C33, HOURGLASS, ALPHA, BETA = slots(4, membrane.SLOTS + 50)
TURNS = slots(1, membrane.SLOTS + 54)[0]  # 1 where the normal follows the sheet, 0 where an edge is clamped
SLOTS = membrane.SLOTS + 55


@compiled
def zone_curvature_row(s, columns):
    """Normal and mixed curvature b12 of the zones between node rows i + 1 and i + 2."""
    for j in range(columns):
        d1x, d1y, d1z = s[XC + ONE + j] - s[XB + j], s[YC + ONE + j] - s[YB + j], s[ZC + ONE + j] - s[ZB + j]
        d2x, d2y, d2z = s[XB + ONE + j] - s[XC + j], s[YB + ONE + j] - s[YC + j], s[ZB + ONE + j] - s[ZC + j]
        wx, wy, wz = d1y * d2z - d1z * d2y, d1z * d2x - d1x * d2z, d1x * d2y - d1y * d2x
        scale = 1.0 / np.sqrt(wx * wx + wy * wy + wz * wz)
        nx, ny, nz = wx * scale, wy * scale, wz * scale
        sx = s[XC + ONE + j] - s[XC + j] - s[XB + ONE + j] + s[XB + j]
        sy = s[YC + ONE + j] - s[YC + j] - s[YB + ONE + j] + s[YB + j]
        sz = s[ZC + ONE + j] - s[ZC + j] - s[ZB + ONE + j] + s[ZB + j]
        s[NEW_NX + j], s[NEW_NY + j], s[NEW_NZ + j], s[NEW_SCALE + j] = nx, ny, nz, scale
        s[NEW_B12 + j] = nx * sx + ny * sy + nz * sz


@compiled
def node_moment_row(s, c1, columns):
    """Curvatures and moments of node row i + 1 and their gradient on the node and its neighbours; returns energy."""
    energy = 0.0
    for j in range(columns):
        x, y, z = s[XB + j], s[YB + j], s[ZB + j]
        east_x, east_y, east_z = s[XC + j] - x, s[YC + j] - y, s[ZC + j] - z
        west_x, west_y, west_z = x - s[XA + j], y - s[YA + j], z - s[ZA + j]
        north_x, north_y, north_z = s[XB + ONE + j] - x, s[YB + ONE + j] - y, s[ZB + ONE + j] - z
        south_x, south_y, south_z = x - s[XB - ONE + j], y - s[YB - ONE + j], z - s[ZB - ONE + j]
        c2 = s[C2 + j]
        t1x, t1y, t1z = c1 * (east_x + west_x), c1 * (east_y + west_y), c1 * (east_z + west_z)
        t2x, t2y, t2z = c2 * (north_x + south_x), c2 * (north_y + south_y), c2 * (north_z + south_z)
        s1x, s1y, s1z = east_x - west_x, east_y - west_y, east_z - west_z
        s2x, s2y, s2z = north_x - south_x, north_y - south_y, north_z - south_z
        wx, wy, wz = t1y * t2z - t1z * t2y, t1z * t2x - t1x * t2z, t1x * t2y - t1y * t2x
        scale = 1.0 / np.sqrt(wx * wx + wy * wy + wz * wz)
        turns = s[TURNS + j]
        scale *= turns
        nx, ny, nz = wx * scale, wy * scale, wz * scale + (1.0 - turns)
        b1 = nx * s1x + ny * s1y + nz * s1z
        b2 = nx * s2x + ny * s2y + nz * s2z
        share = s[SHARE + j]
        b3 = share * (s[OLD_B12 + j] + s[OLD_B12 - ONE + j] + s[NEW_B12 + j] + s[NEW_B12 - ONE + j])
        m1 = s[K11 + j] * b1 + s[K12 + j] * b2 + s[K13 + j] * b3
        m2 = s[K12 + j] * b1 + s[K22 + j] * b2 + s[K23 + j] * b3
        m3 = s[K13 + j] * b1 + s[K23 + j] * b2 + s[K33 + j] * b3
        energy += 0.5 * (m1 * b1 + m2 * b2 + m3 * b3)
        s[NEW_M3 + j] = share * m3
        along = m1 * b1 + m2 * b2
        ax = scale * (m1 * s1x + m2 * s2x - along * nx)
        ay = scale * (m1 * s1y + m2 * s2y - along * ny)
        az = scale * (m1 * s1z + m2 * s2z - along * nz)
        h1x, h1y, h1z = c1 * (t2y * az - t2z * ay), c1 * (t2z * ax - t2x * az), c1 * (t2x * ay - t2y * ax)
        h2x, h2y, h2z = c2 * (ay * t1z - az * t1y), c2 * (az * t1x - ax * t1z), c2 * (ax * t1y - ay * t1x)
        s[EAST_X + j], s[WEST_X + j] = m1 * nx + h1x, m1 * nx - h1x
        s[EAST_Y + j], s[WEST_Y + j] = m1 * ny + h1y, m1 * ny - h1y
        s[EAST_Z + j], s[WEST_Z + j] = m1 * nz + h1z, m1 * nz - h1z
        s[NORTH_X + j], s[SOUTH_X + j] = m2 * nx + h2x, m2 * nx - h2x
        s[NORTH_Y + j], s[SOUTH_Y + j] = m2 * ny + h2y, m2 * ny - h2y
        s[NORTH_Z + j], s[SOUTH_Z + j] = m2 * nz + h2z, m2 * nz - h2z
        centre = -2.0 * (m1 + m2)
        s[SELF_X + j], s[SELF_Y + j], s[SELF_Z + j] = centre * nx, centre * ny, centre * nz
    return energy


@compiled
def gather_nodes(s, columns, first, last, east, west, north, south, own, past, total, bend):
    """Add up one component of the nodes' gradient: complete it at row i, begin it at row i + 1.

    At an open edge the missing neighbour is the node itself, so what would go to it folds back on the node.
    """
    s[north - ONE] = s[south]
    s[south + columns] = s[north + columns - ONE]
    if last:
        for j in range(columns):
            s[bend + j] = s[total + j] + s[past + j]
        return
    for j in range(columns):
        s[bend + j] = s[total + j] + s[west + j]
    if first:
        for j in range(columns):
            s[past + j] = s[west + j]
    for j in range(columns):
        s[total + j] = s[past + j] + s[own + j] + s[north - ONE + j] + s[south + ONE + j]
        s[past + j] = s[east + j]


@compiled
def zone_moment_row(s, columns):
    """Add mixed moment and hourglass stiffness of zone row i to the forces on its diagonals; returns both energies."""
    energy = hourglass = 0.0
    for j in range(columns):
        d1x, d1y, d1z = s[XB + ONE + j] - s[XA + j], s[YB + ONE + j] - s[YA + j], s[ZB + ONE + j] - s[ZA + j]
        d2x, d2y, d2z = s[XA + ONE + j] - s[XB + j], s[YA + ONE + j] - s[YB + j], s[ZA + ONE + j] - s[ZB + j]
        sx = s[XB + ONE + j] - s[XB + j] - s[XA + ONE + j] + s[XA + j]
        sy = s[YB + ONE + j] - s[YB + j] - s[YA + ONE + j] + s[YA + j]
        sz = s[ZB + ONE + j] - s[ZB + j] - s[ZA + ONE + j] + s[ZA + j]
        nx, ny, nz, b12 = s[OLD_NX + j], s[OLD_NY + j], s[OLD_NZ + j], s[OLD_B12 + j]
        energy += 0.5 * s[C33 + j] * b12 * b12
        k, alpha, beta = s[HOURGLASS + j], s[ALPHA + j], s[BETA + j]
        gx, gy, gz = (
            sx - alpha * d1x - beta * d2x,
            sy - alpha * d1y - beta * d2y,
            sz - alpha * d1z - beta * d2z,
        )
        hourglass += 0.5 * k * (gx * gx + gy * gy + gz * gz - b12 * b12)
        gx, gy, gz = k * gx, k * gy, k * gz
        m = (s[C33 + j] - k) * b12 + s[OLD_M3 + j] + s[OLD_M3 + ONE + j] + s[NEW_M3 + j] + s[NEW_M3 + ONE + j]
        scale = m * s[OLD_SCALE + j]
        ax, ay, az = scale * (sx - b12 * nx), scale * (sy - b12 * ny), scale * (sz - b12 * nz)
        s[T1X + j] += d2y * az - d2z * ay - alpha * gx
        s[T1Y + j] += d2z * ax - d2x * az - alpha * gy
        s[T1Z + j] += d2x * ay - d2y * ax - alpha * gz
        s[T2X + j] += ay * d1z - az * d1y - beta * gx
        s[T2Y + j] += az * d1x - ax * d1z - beta * gy
        s[T2Z + j] += ax * d1y - ay * d1x - beta * gz
        s[QX + j], s[QY + j], s[QZ + j] = m * nx + gx, m * ny + gy, m * nz + gz
    return energy, hourglass


@compiled
def node_row(s, f, start, columns, t1, t2, q, upper, bend):
    """Force on a row of nodes, one component."""
    for j in range(columns):
        zones = s[upper + j] + s[t1 + j] - s[q + j] - s[t2 - ONE + j] + s[q - ONE + j]
        f[start + j] = zones - s[bend + j]


@compiled
def keep_upper(s, columns, t1, t2, q, upper):
    """Keep what the zone row pulls with on its far node row (corners b and c), one component."""
    for j in range(columns):
        s[upper + j] = s[t2 + j] + s[q + j] - s[t1 - ONE + j] - s[q - ONE + j]


@compiled
def load_moduli(s, node, row, rows, columns):
    """Load the bending constants of one row of nodes."""
    plane = np.uint64(rows) * columns
    start = np.uint64(row) * columns
    load(s, K11, node, start, columns)
    load(s, K12, node, plane + start, columns)
    load(s, K22, node, np.uint64(2) * plane + start, columns)
    load(s, K13, node, np.uint64(3) * plane + start, columns)
    load(s, K23, node, np.uint64(4) * plane + start, columns)
    load(s, K33, node, np.uint64(5) * plane + start, columns)
    load(s, SHARE, node, np.uint64(6) * plane + start, columns)
    load(s, TURNS, node, np.uint64(7) * plane + start, columns)


@compiled
def load_twist(s, twist, row, zone_rows, columns):
    """Load the twisting and hourglass constants of one row of zones."""
    plane = np.uint64(zone_rows) * columns
    start = np.uint64(row) * columns
    load(s, C33, twist, start, columns)
    load(s, HOURGLASS, twist, plane + start, columns)
    load(s, ALPHA, twist, np.uint64(2) * plane + start, columns)
    load(s, BETA, twist, np.uint64(3) * plane + start, columns)


@compiled
def load_positions(s, r, i, rows, columns, closed):
    """Load node rows i, i + 1, i + 2; rows beyond an open edge repeat the edge. Ghost columns repeat the end."""
    for slot_x, slot_y, slot_z, k in ((XA, YA, ZA, i), (XB, YB, ZB, i + 1), (XC, YC, ZC, i + 2)):
        row = k % rows if closed else min(max(k, 0), rows - 1)
        membrane.load_nodes(s, slot_x, slot_y, slot_z, r, row, rows, columns)
        for slot in (slot_x, slot_y, slot_z):
            s[slot - ONE] = s[slot]
            s[slot + columns] = s[slot + columns - ONE]


@compiled
def gather_row(s, n, first, last):
    """`gather_nodes` for the three components."""
    gather_nodes(s, n, first, last, EAST_X, WEST_X, NORTH_X, SOUTH_X, SELF_X, PAST_X, SUM_X, BEND_X)
    gather_nodes(s, n, first, last, EAST_Y, WEST_Y, NORTH_Y, SOUTH_Y, SELF_Y, PAST_Y, SUM_Y, BEND_Y)
    gather_nodes(s, n, first, last, EAST_Z, WEST_Z, NORTH_Z, SOUTH_Z, SELF_Z, PAST_Z, SUM_Z, BEND_Z)
