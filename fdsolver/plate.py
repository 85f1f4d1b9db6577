"""Kernel of the conservative Koiter plate: curvature, moments, force and energy added to the membrane's.

In index coordinates (unit spacing) the tangents at a node are t1 = c1 (r_E - r_W), t2 = c2 (r_N - r_S) (c = 1/2, and 1
with the missing neighbour replaced by the node itself at an open edge), n = unit(t1 x t2), and the curvatures are
b1 = n . (r_E - 2 r + r_W), b2 = n . (r_N - 2 r + r_S). A zone has b12 = n_z . (r_c - r_b - r_d + r_a) with n_z the unit
normal of d1 x d2; b3 is the mean of b12 over the zones of a node. The energy is

    sum over nodes of (b K b) / 2  +  sum over zones of C33 b12^2 / 2,      b = (b1, b2, b3),

with the constants K, C33 of `curvature`. The force is its exact negative gradient: with the moments m = K b,
dE = m1 n . d(s1) + m2 n . d(s2) + a . d(t1 x t2), a = (m1 s1 + m2 s2 - n (m1 b1 + m2 b2)) / |t1 x t2|; the last term is
the strain-gradient effect, which comes from the variation of the normal (MODEL section 1).

Zone gradients do not see an in-plane checkerboard, and where free edges leave it loose it grows until nodes fall
together. So each zone also carries k (|g|^2 - b12^2) / 2 with g = s - F (u_c - u_b - u_d + u_a) and
s = r_c - r_b - r_d + r_a: the part of s that no affine deformation explains, less its normal part, which is
curvature. It vanishes on affine states and is of second order in the mesh width.
"""

from __future__ import annotations

import numpy as np

from fdsolver import membrane
from fdsolver.curvature import CurvatureConstants
from fdsolver.grid import Grid
from fdsolver.membrane import T1X, T1Y, T1Z, T2X, T2Y, T2Z, UPPER_X, UPPER_Y, UPPER_Z, XA, XB, YA, YB, ZA, ZB
from fdsolver.rows import FIRST, ONE, PITCH, clear, compiled, load, move, slots

HOURGLASS_STRENGTH = (
    0.01  # larger costs accuracy (its energy is of second order), 0.001 still holds the holed sheet
)

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


def node_constants(k: CurvatureConstants) -> np.ndarray:
    """K11, K12, K22, K13, K23, K33, share and turns of every node, (8, ni, nj) float64, scaled.

    At a clamped edge the normal stays e3 (edges turn about the z axis only) and the mirror node is eliminated: the
    curvature across the edge is 2 n . (r_in - r_edge). With the missing neighbour replaced by the node itself the
    kernel measures half of that, so its moduli carry the factor 2.
    """
    across1, across2 = np.where(k.clamped1, 2.0, 1.0), np.where(k.clamped2, 2.0, 1.0)
    moduli = [
        k.K11 * across1**2,
        k.K12 * across1 * across2,
        k.K22 * across2**2,
        k.K13 * across1,
        k.K23 * across2,
    ]
    turns = np.where(k.clamped1 | k.clamped2, 0.0, 1.0)
    return np.stack([*moduli, k.K33_rest, k.twist_weight, turns])


def hourglass_constants(grid: Grid, strength: float = HOURGLASS_STRENGTH) -> np.ndarray:
    """Stiffness k and the affine part (alpha, beta) of s = alpha d1 + beta d2 + g of every zone, scaled.

    strength : share of the stiffness that a fully integrated bilinear zone has against in-plane bending,
        A (|g1|^2 + |g2|^2) / 12. Returns (3, zone rows, nj - 1) float64.
    """
    g1x, g1y, g2x, g2y, area = membrane.zone_constants(grid)
    u = grid.u / grid.length_mm
    far, near = (np.roll(u, -1, axis=0), u) if grid.closed else (u[1:], u[:-1])
    skew = far[:, 1:] - far[:, :-1] - near[:, 1:] + near[:, :-1]
    stiffness = strength * area * (g1x**2 + g1y**2 + g2x**2 + g2y**2) / 12.0
    return np.stack(
        [stiffness, g1x * skew[..., 0] + g1y * skew[..., 1], g2x * skew[..., 0] + g2y * skew[..., 1]]
    )


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


@compiled
def band(law, r, f, zone, energy, rows, columns, closed, start, stop, s, node, twist):
    """Force and energy of the node rows start <= i < stop, membrane and bending.

    As `membrane.band`, with energy : (3, rows); node : flat (8, rows, columns) of `node_constants`; twist : flat
    (4, zone rows, columns - 1), C33 and `hourglass_constants`. energy[1, i] takes the bending energy of node row i
    and zone row i, energy[2, i] the hourglass energy of zone row i. Zone row i needs the moments of node rows i and i + 1, and these the mixed curvatures of zone rows i - 1 to i + 1: so rows enter three steps early.
    """
    n = np.uint64(columns)
    cells = n - ONE
    zone_rows = rows if closed else rows - 1
    for k in range(SLOTS):
        clear(s, np.uint64(k * PITCH + FIRST), n)
    for j in range(n):
        s[C2 + j] = 0.5
    s[C2] = s[C2 + cells] = 1.0
    for i in range(start - 3, stop):
        load_positions(s, r, i, rows, n, closed)
        for old, new in ((OLD_NX, NEW_NX), (OLD_NY, NEW_NY), (OLD_NZ, NEW_NZ), (OLD_SCALE, NEW_SCALE)):
            move(s, old, new, n)
        move(s, OLD_B12, NEW_B12, n)
        move(s, OLD_M3, NEW_M3, n)
        if closed or 0 <= i + 1 < zone_rows:
            zone_curvature_row(s, cells)
        else:
            clear(s, NEW_B12, n)
        if i + 1 < start - 1:
            continue
        if closed or 0 <= i + 1 < rows:
            edge_row = not closed and (i + 1 == 0 or i + 1 == rows - 1)
            load_moduli(s, node, (i + 1) % rows, rows, n)
            node_energy = node_moment_row(s, 1.0 if edge_row else 0.5, n)
            gather_row(s, n, not closed and i + 1 == 0, False)
            if start <= i + 1 < stop:
                energy[1, i + 1] = node_energy
        elif i + 1 == rows:
            gather_row(s, n, False, True)
            clear(s, NEW_M3, n)
        if i < start - 1:
            continue
        if closed or 0 <= i < zone_rows:
            here = i % rows
            membrane.load_zones(s, zone, here, zone_rows, cells)
            load_twist(s, twist, here, zone_rows, cells)
            membrane_energy = membrane.zone_row(s, law, cells)
            bending_energy, hourglass_energy = zone_moment_row(s, cells)
        else:
            membrane_energy = bending_energy = hourglass_energy = 0.0
            for t in (T1X, T1Y, T1Z, T2X, T2Y, T2Z, QX, QY, QZ):
                clear(s, t, n)
        if i >= start:
            plane, first = np.uint64(rows) * n, np.uint64(i) * n
            node_row(s, f, first, n, T1X, T2X, QX, UPPER_X, BEND_X)
            node_row(s, f, plane + first, n, T1Y, T2Y, QY, UPPER_Y, BEND_Y)
            node_row(s, f, plane + plane + first, n, T1Z, T2Z, QZ, UPPER_Z, BEND_Z)
            energy[0, i] = membrane_energy
            energy[1, i] += bending_energy
            energy[2, i] = hourglass_energy
        keep_upper(s, n, T1X, T2X, QX, UPPER_X)
        keep_upper(s, n, T1Y, T2Y, QY, UPPER_Y)
        keep_upper(s, n, T1Z, T2Z, QZ, UPPER_Z)
