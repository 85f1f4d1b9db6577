"""Kernel of the published scheme: Taylor, Bertoldi and Steigmann (2014), Eqs. (52) to (65) and (77), on rectangles.

The mesh carries a layer of ghost nodes outside its four edges (Fig. 2 of the paper; `published_ghosts`). With the
gradient F of every zone [57], exterior ones included, the nodes of the sheet have

    A F_ka,b = contour sum of F_ka over the four zones, symmetrised in a, b                                  [61]
    n = unit vector of the mean of F_1 x F_2 over the four zones                                             [63, 64]
    b_ab = n_k F_ka,b,      M_kab = h^3/12 n_k (c tr(b) delta_ab + 2 mu b_ab)                                [60, 34]

and the zones of the sheet, with means over their corners marked by < >,

    T_ka = h F_kb S_ba - <M_klm> F_ia <F_il,m> - M_kab,b                                        [31, 35, 36, 59, 65]

The force on a node is half of Sigma [55], the contour sum of T over its zones within the sheet, and on an edge half
of the difference of M_kab nu_a tau_b between the next node of the edge and the last one [77].

Of (64) we take the four zones around the node (as printed it has one of them twice and one not at all). At a corner
between two edges the paper leaves (77) open: here the twisting moment goes on oddly beyond the corner, since a corner
carries no force ([M nu tau] = 0), and then the forces of a free sheet add up to zero.

This force is no gradient. The energy returned is the sum of A W over the zones (membrane) and over the nodes (bending).
"""

from __future__ import annotations

import numba
import numpy as np

from fdsolver import membrane
from fdsolver.membrane import T1X, T1Y, T1Z, T2X, T2Y, T2Z, UPPER_X, UPPER_Y, UPPER_Z, XA, XB, YA, YB, ZA, ZB
from fdsolver.published_rows import (
    HOURGLASS,
    INVERSE,
    M11,
    M22,
    NEW_H,
    NEW_M,
    NEW_X1,
    NEW_X2,
    NEW_Y1,
    NEW_Y2,
    NEW_Z1,
    NEW_Z2,
    NX,
    NY,
    NZ,
    OLD_M,
    OLD_X1,
    OLD_X2,
    OLD_Y1,
    OLD_Y2,
    OLD_Z1,
    OLD_Z2,
    QX,
    QY,
    QZ,
    SHARE,
    SLOTS,
    age,
    bending_row,
    christoffel_row,
    contour_row,
    gradient_row,
    hourglass_row,
    keep_upper,
    load_row,
    membrane_row,
    moment_row,
    node_row,
    second_gradient_row,
)
from fdsolver.rows import FIRST, ONE, PITCH, clear, compiled, threaded


@compiled
def sheet_gradient_rows(s, n):
    """Second gradient [61] of node row i, its three components."""
    x11, x12, x22, y11, y12, y22, z11, z12, z22 = NEW_H
    second_gradient_row(s, n, OLD_X1, OLD_X2, NEW_X1, NEW_X2, x11, x12, x22)
    second_gradient_row(s, n, OLD_Y1, OLD_Y2, NEW_Y1, NEW_Y2, y11, y12, y22)
    second_gradient_row(s, n, OLD_Z1, OLD_Z2, NEW_Z1, NEW_Z2, z11, z12, z22)


@compiled
def traction_rows(s, law, cells, stabilised):
    """T [31] of zone row i - 1 and what it pulls with on its diagonals; returns membrane and hourglass energy."""
    x11, x12, x22, y11, y12, y22, z11, z12, z22 = OLD_M
    nx11, nx12, nx22, ny11, ny12, ny22, nz11, nz12, nz22 = NEW_M
    energy = membrane_row(s, law, cells)
    christoffel_row(s, cells)
    bending_row(s, cells, x11, x12, x22, nx11, nx12, nx22, T1X, T2X)
    bending_row(s, cells, y11, y12, y22, ny11, ny12, ny22, T1Y, T2Y)
    bending_row(s, cells, z11, z12, z22, nz11, nz12, nz22, T1Z, T2Z)
    contour_row(s, cells, T1X, T2X)
    contour_row(s, cells, T1Y, T2Y)
    contour_row(s, cells, T1Z, T2Z)
    return energy, hourglass_row(s, cells) if stabilised else 0.0


@compiled
def keep_edges(s, i, rows, n, row_edges, column_edges):
    """Keep normal, moment across the edge and M_k12 of node row i where it lies on an edge."""
    last = n - ONE - ONE
    twist = (NEW_M[1], NEW_M[4], NEW_M[7])
    normal = (NX, NY, NZ)
    for k in range(3):
        for side, j in ((0, ONE), (1, last)):
            column_edges[side, k, i] = s[normal[k] + j]
            column_edges[side, 4 + k, i] = s[twist[k] + j]
        if i == 1 or i == rows - 2:
            for j in range(n):
                row_edges[0 if i == 1 else 1, k, j] = s[normal[k] + j]
                row_edges[0 if i == 1 else 1, 4 + k, j] = s[twist[k] + j]
    column_edges[0, 3, i], column_edges[1, 3, i] = s[M22 + ONE], s[M22 + last]
    if i == 1 or i == rows - 2:
        for j in range(n):
            row_edges[0 if i == 1 else 1, 3, j] = s[M11 + j]


@compiled
def band(
    law,
    bending,
    stabilised,
    r,
    f,
    zone,
    node,
    hourglass,
    energy,
    rows,
    columns,
    start,
    stop,
    s,
    row_edges,
    column_edges,
):
    """Force of the zones on the node rows start <= i < stop of the mesh with its ghost layer.

    bending : (h / L)^2 / 12. r, f : flat (3, rows, columns), f is overwritten in the band. zone : flat constants of
    `membrane.zone_constants`. node : flat (2, rows, columns), 1 / A [53] and area of the sheet at the node, 0 at
    ghosts. hourglass : flat (rows - 1, columns - 1), used if stabilised. energy : (3, rows), by rows. row_edges,
    column_edges : (2, 7, columns) and (2, 7, rows), receive n, M_nu_nu / n and M_k12 of the four edges.
    """
    n = np.uint64(columns)
    cells = n - ONE
    for k in range(SLOTS):
        clear(s, np.uint64(k * PITCH + FIRST), n)
    for i in range(start - 2, stop + 1):
        age(s, n)
        if 0 <= i < rows - 1:
            membrane.load_nodes(s, XA, YA, ZA, r, i, rows, n)
            membrane.load_nodes(s, XB, YB, ZB, r, i + 1, rows, n)
            membrane.load_zones(s, zone, i, rows - 1, cells)
            gradient_row(s, cells)
        if 1 <= i < rows - 1:
            load_row(s, INVERSE, node, np.uint64(i), n)
            load_row(s, SHARE, node, np.uint64(rows + i), n)
            sheet_gradient_rows(s, n)
            node_energy = moment_row(s, law.poisson, bending, n)
            if start <= i < stop:  # before, the rows that led here are not all known
                energy[1, i] = node_energy
                keep_edges(s, i, rows, n, row_edges, column_edges)
        membrane_energy = hourglass_energy = 0.0
        if 1 <= i - 1 < rows - 2:
            membrane.load_zones(s, zone, i - 1, rows - 1, cells)
            load_row(s, HOURGLASS, hourglass, np.uint64(i - 1), cells)
            membrane_energy, hourglass_energy = traction_rows(s, law, cells, stabilised)
        else:
            for t in (T1X, T1Y, T1Z, T2X, T2Y, T2Z, QX, QY, QZ):
                clear(s, t, n)
        if start <= i - 1 < stop:
            plane, first = np.uint64(rows) * n, np.uint64(i - 1) * n
            node_row(s, f, first, n, T1X, T2X, QX, UPPER_X)
            node_row(s, f, plane + first, n, T1Y, T2Y, QY, UPPER_Y)
            node_row(s, f, plane + plane + first, n, T1Z, T2Z, QZ, UPPER_Z)
            energy[0, i - 1], energy[2, i - 1] = membrane_energy, hourglass_energy
        keep_upper(s, n, T1X, T2X, QX, UPPER_X)
        keep_upper(s, n, T1Y, T2Y, QY, UPPER_Y)
        keep_upper(s, n, T1Z, T2Z, QZ, UPPER_Z)


@threaded
def bands(
    law,
    bending,
    stabilised,
    r,
    f,
    zone,
    node,
    hourglass,
    energy,
    rows,
    columns,
    scratch,
    row_edges,
    column_edges,
):
    """`band` on as many bands of rows as there are scratch arrays, one thread each."""
    count = scratch.shape[0]
    for k in numba.prange(count):
        start, stop = k * rows // count, (k + 1) * rows // count
        band(
            law, bending, stabilised, r, f, zone, node, hourglass, energy, rows, columns,
            start, stop, scratch[k], row_edges, column_edges,
        )  # fmt: skip


@compiled
def add_edge_tractions(f, row_edges, column_edges):
    """Add half of the difference of M_kab nu_a tau_b between the next node of an edge and the last one [77].

    With the edge run through counter-clockwise that is M_k12 on the edges across the first mesh direction and -M_k12
    on the others. f : (3, rows, columns). The arrays are those of `band`.
    """
    rows, columns = f.shape[1], f.shape[2]
    for k in range(3):
        for side, sign in ((0, -0.5), (1, 0.5)):
            m, i = row_edges[side, 4 + k], 1 if side == 0 else rows - 2
            m[0], m[columns - 1] = -m[1], -m[columns - 2]
            for j in range(1, columns - 1):
                f[k, i, j] += sign * (m[j + 1] - m[j - 1])
            m, j = column_edges[side, 4 + k], 1 if side == 0 else columns - 2
            m[0], m[rows - 1] = -m[1], -m[rows - 2]
            for i in range(1, rows - 1):
                f[k, i, j] += sign * (m[i + 1] - m[i - 1])
