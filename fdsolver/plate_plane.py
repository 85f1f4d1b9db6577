"""Kernel of the plate that stays in its plane: the membrane of `membrane_plane` with the plate's hourglass stiffness.

A flat plate has no curvature, but its zones go on carrying k (g_x^2 + g_y^2) / 2 of `plate`: without it the flat state
would be that of another energy, and free edges could fold into a checkerboard that the plate does not have.
"""

from __future__ import annotations

import numpy as np

from fdsolver import membrane_plane
from fdsolver.membrane import load_zones
from fdsolver.membrane_plane import T1X, T1Y, T2X, T2Y, UPPER_X, UPPER_Y, XA, XB, YA, YB, load_nodes
from fdsolver.plate_linear import in_plane_row
from fdsolver.plate_rows import keep_upper
from fdsolver.rows import ONE, clear, compiled, load, slots

QX, QY, STIFFNESS, ALPHA, BETA = slots(5, membrane_plane.SLOTS)
SLOTS = membrane_plane.SLOTS + 5


@compiled
def hourglass_row(s, columns):
    """Add the hourglass stiffness of one row of zones to the forces on its diagonals; returns its energy."""
    energy = 0.0
    for j in range(columns):
        d1x, d1y = s[XB + ONE + j] - s[XA + j], s[YB + ONE + j] - s[YA + j]
        d2x, d2y = s[XA + ONE + j] - s[XB + j], s[YA + ONE + j] - s[YB + j]
        sx = s[XB + ONE + j] - s[XB + j] - s[XA + ONE + j] + s[XA + j]
        sy = s[YB + ONE + j] - s[YB + j] - s[YA + ONE + j] + s[YA + j]
        k, alpha, beta = s[STIFFNESS + j], s[ALPHA + j], s[BETA + j]
        gx, gy = sx - alpha * d1x - beta * d2x, sy - alpha * d1y - beta * d2y
        energy += 0.5 * k * (gx * gx + gy * gy)
        gx, gy = k * gx, k * gy
        s[T1X + j], s[T2X + j] = s[T1X + j] - alpha * gx, s[T2X + j] - beta * gx
        s[T1Y + j], s[T2Y + j] = s[T1Y + j] - alpha * gy, s[T2Y + j] - beta * gy
        s[QX + j], s[QY + j] = gx, gy
    return energy


@compiled
def load_hourglass(s, hourglass, row, zone_rows, columns):
    """Load the constants of one row of zones."""
    plane, start = np.uint64(zone_rows) * columns, np.uint64(row) * columns
    load(s, STIFFNESS, hourglass, start, columns)
    load(s, ALPHA, hourglass, plane + start, columns)
    load(s, BETA, hourglass, plane + plane + start, columns)


@compiled
def band(law, r, f, zone, energy, rows, columns, closed, start, stop, s, hourglass):
    """As `membrane_plane.band`; hourglass : flat (3, zone rows, columns - 1) of `plate.hourglass_constants`.

    energy : (3, rows); energy[2, i] takes the hourglass energy of zone row i.
    """
    n = np.uint64(columns)
    cells = n - ONE
    zone_rows = rows if closed else rows - 1
    for t in (T1X, T1Y, T2X, T2Y, QX, QY, UPPER_X, UPPER_Y):
        clear(s, t, n)
    for i in range(start - 1, stop):
        here = i if i >= 0 else rows - 1
        if here < zone_rows and (i >= 0 or closed):
            load_nodes(s, XA, YA, r, here, rows, n)
            load_nodes(s, XB, YB, r, here + 1 if here + 1 < rows else 0, rows, n)
            load_zones(s, zone, here, zone_rows, cells)
            load_hourglass(s, hourglass, here, zone_rows, cells)
            membrane_energy = membrane_plane.zone_row(s, law, cells)
            hourglass_energy = hourglass_row(s, cells)
        else:
            membrane_energy = hourglass_energy = 0.0
            for t in (T1X, T1Y, T2X, T2Y, QX, QY):
                clear(s, t, n)
        if i >= start:
            plane, first = np.uint64(rows) * n, np.uint64(i) * n
            in_plane_row(s, f, first, n, T1X, T2X, QX, UPPER_X)
            in_plane_row(s, f, plane + first, n, T1Y, T2Y, QY, UPPER_Y)
            energy[0, i] = membrane_energy
            energy[2, i] = hourglass_energy
        keep_upper(s, n, T1X, T2X, QX, UPPER_X)
        keep_upper(s, n, T1Y, T2Y, QY, UPPER_Y)
