"""Kernel of the conservative Koiter plate: curvature, moments, force and energy added to the membrane's.

In index coordinates (unit spacing) the tangents at a node are t1 = c1 (r_E - r_W), t2 = c2 (r_N - r_S) (c = 1/2, and 1
with the missing neighbour replaced by the node itself at an open edge), n = unit(t1 x t2), and the curvatures are
b1 = n . (r_E - 2 r + r_W), b2 = n . (r_N - 2 r + r_S). A zone has b12 = n_z . (r_c - r_b - r_d + r_a) with n_z the unit
normal of d1 x d2; b3 is the mean of b12 over the zones of a node. The energy is

    sum over nodes of (b K b) / 2  +  sum over zones of C33 b12^2 / 2,      b = (b1, b2, b3),

with the constants K, C33 of `curvature`. The force is its exact negative gradient: with the moments m = K b,
dE = m1 n . d(s1) + m2 n . d(s2) + a . d(t1 x t2), a = (m1 s1 + m2 s2 - n (m1 b1 + m2 b2)) / |t1 x t2|; the last term is
the strain-gradient effect, which comes from the variation of the normal (Eq. 35).

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
from fdsolver.membrane import T1X, T1Y, T1Z, T2X, T2Y, T2Z, UPPER_X, UPPER_Y, UPPER_Z
from fdsolver.plate_rows import (
    BEND_X,
    BEND_Y,
    BEND_Z,
    C2,
    NEW_B12,
    NEW_M3,
    NEW_NX,
    NEW_NY,
    NEW_NZ,
    NEW_SCALE,
    OLD_B12,
    OLD_M3,
    OLD_NX,
    OLD_NY,
    OLD_NZ,
    OLD_SCALE,
    QX,
    QY,
    QZ,
    SLOTS,
    gather_row,
    keep_upper,
    load_moduli,
    load_positions,
    load_twist,
    node_moment_row,
    node_row,
    zone_curvature_row,
    zone_moment_row,
)
from fdsolver.rows import FIRST, ONE, PITCH, clear, compiled, move

# Larger costs accuracy (its energy is of second order in the mesh width); a tenth of it still holds the holed sheet.
HOURGLASS_STRENGTH = 0.01


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
def band(law, r, f, zone, energy, rows, columns, closed, start, stop, s, node, twist):
    """Force and energy of the node rows start <= i < stop, membrane and bending.

    As `membrane.band`, with energy : (3, rows); node : flat (8, rows, columns) of `node_constants`; twist : flat
    (4, zone rows, columns - 1), C33 and `hourglass_constants`. energy[1, i] takes the bending energy of node row i
    and zone row i, energy[2, i] the hourglass energy of zone row i. Zone row i needs the moments of node
    rows i and i + 1, and these the mixed curvatures of zone rows i - 1 to i + 1: so rows enter three steps early.
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
