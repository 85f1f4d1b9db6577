"""Kernel of the membrane that stays in its plane: the equations of `membrane` with two displacement components.

Right where nothing pushes the sheet out of its plane and no compression makes it buckle. The out-of-plane components of
the deformation gradient are compile-time zeros, so nothing of them is computed or stored.
"""

from __future__ import annotations

import numpy as np

from fdsolver.membrane import first_piola, keep_upper, load_zones, node_row
from fdsolver.rows import ONE, clear, compiled, load, slots

XA, YA, XB, YB = slots(4)  # positions of the node rows i and i + 1
UPPER_X, UPPER_Y = slots(2, 4)
G1X, G1Y, G2X, G2Y, AREA = slots(5, 6)  # where `membrane.load_zones` puts them
T1X, T1Y, T2X, T2Y = slots(4, 11)
SLOTS = 15


@compiled
def load_nodes(s, x, y, r, row, rows, columns):
    """Load the positions of one row of nodes into the slots x, y."""
    plane = np.uint64(rows) * columns
    start = np.uint64(row) * columns
    load(s, x, r, start, columns)
    load(s, y, r, plane + start, columns)


@compiled
def zone_row(s, law, columns):
    """Membrane forces t1, t2 on the diagonals of one row of zones; returns the row's energy."""
    energy = 0.0
    for j in range(columns):
        d1x, d1y = s[XB + ONE + j] - s[XA + j], s[YB + ONE + j] - s[YA + j]
        d2x, d2y = s[XA + ONE + j] - s[XB + j], s[YA + ONE + j] - s[YB + j]
        g1x, g1y, g2x, g2y, area = s[G1X + j], s[G1Y + j], s[G2X + j], s[G2Y + j], s[AREA + j]
        fx1, fy1 = d1x * g1x + d2x * g2x, d1y * g1x + d2y * g2x
        fx2, fy2 = d1x * g1y + d2x * g2y, d1y * g1y + d2y * g2y
        px1, px2, py1, py2, _, _, density = first_piola(law, fx1, fx2, fy1, fy2, 0.0, 0.0)
        energy += area * density
        px1, px2, py1, py2 = area * px1, area * px2, area * py1, area * py2
        s[T1X + j], s[T2X + j] = px1 * g1x + px2 * g1y, px1 * g2x + px2 * g2y
        s[T1Y + j], s[T2Y + j] = py1 * g1x + py2 * g1y, py1 * g2x + py2 * g2y
    return energy


@compiled
def band(law, r, f, zone, energy, rows, columns, closed, start, stop, s):
    """As `membrane.band`, with r, f : flat (2, rows, columns)."""
    n = np.uint64(columns)
    cells = n - ONE
    zone_rows = rows if closed else rows - 1
    for t in (T1X, T1Y, T2X, T2Y, UPPER_X, UPPER_Y):
        clear(s, t, n)
    for i in range(start - 1, stop):
        here = i if i >= 0 else rows - 1
        if here < zone_rows and (i >= 0 or closed):
            load_nodes(s, XA, YA, r, here, rows, n)
            load_nodes(s, XB, YB, r, here + 1 if here + 1 < rows else 0, rows, n)
            load_zones(s, zone, here, zone_rows, cells)
            row_energy = zone_row(s, law, cells)
        else:
            row_energy = 0.0
            for t in (T1X, T1Y, T2X, T2Y):
                clear(s, t, n)
        if i >= start:
            plane, first = np.uint64(rows) * n, np.uint64(i) * n
            node_row(s, f, first, n, T1X, T2X, UPPER_X)
            node_row(s, f, plane + first, n, T1Y, T2Y, UPPER_Y)
            energy[0, i] = row_energy
        keep_upper(s, n, T1X, T2X, UPPER_X)
        keep_upper(s, n, T1Y, T2Y, UPPER_Y)
