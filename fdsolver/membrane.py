"""Kernel of the membrane: zone gradient, strain, stress, nodal force and energy (paper Eqs. 52-58).

With d1 = r_c - r_a and d2 = r_d - r_b of a zone, the zone gradient [57] is F = d1 (x) g1 + d2 (x) g2, where
g1 = (q_2, -q_1) / 2A and g2 = (-p_2, p_1) / 2A are constants of the mesh. The force of the zone on its diagonals is
t_k = A F S g_k, and the force on a node is the sum over its four zones: it pulls with +t1 on a, -t1 on c, +t2 on b,
-t2 on d. That is the exact negative gradient of the sum of A W(F), and half of the paper's Sigma [54-55].

Everything is scaled: lengths by L, stresses by Young's modulus, forces by Y h L, energies by Y h L^2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba.extending import overload

from fdsolver.grid import Grid
from fdsolver.rows import ONE, clear, compiled, load, slots

# Positions of the rows i and i + 1 of nodes, constants and forces of the zone row between them.
XA, YA, ZA, XB, YB, ZB = slots(6)
G1X, G1Y, G2X, G2Y, AREA = slots(5, 6)
T1X, T1Y, T1Z, T2X, T2Y, T2Z = slots(6, 11)
UPPER_X, UPPER_Y, UPPER_Z = slots(3, 17)  # what the zone row below pulls with on the present node row
SLOTS = 20
OWN_KINEMATICS: set[type] = set()  # laws that register `first_piola` themselves (see `moderate`)


class StVenantKirchhoff(NamedTuple):
    """The unrelaxed membrane law S = c tr(E) 1 + 2 mu E [36], scaled by Y. poisson : nu."""

    poisson: float


def stress(law, e11, e22, e12):
    """Stress (s11, s22, s12) / Y and energy density W / Y at the Green strain (e11, e22, e12).

    Compile-time dispatch on the type of `law`; each law registers itself with numba's `overload`.
    """
    raise NotImplementedError("laws are compiled functions")


@overload(stress)
def _st_venant_kirchhoff(law, e11, e22, e12):
    if getattr(law, "instance_class", None) is not StVenantKirchhoff:
        return None

    def evaluate(law, e11, e22, e12):
        nu = law.poisson
        modulus = 1.0 / (1.0 - nu * nu)
        s11 = modulus * (e11 + nu * e22)
        s22 = modulus * (e22 + nu * e11)
        s12 = e12 / (1.0 + nu)
        return s11, s22, s12, 0.5 * (s11 * e11 + s22 * e22 + 2.0 * s12 * e12)

    return evaluate


def zone_constants(grid: Grid) -> np.ndarray:
    """Gradient vectors and areas of all zones, scaled by L.

    Returns (5, zone rows, nj - 1) float64: g1x, g1y, g2x, g2y (times L) and area (/ L^2) [57, 58].
    """
    u = grid.u / grid.length_mm
    last = np.roll(u, -1, axis=0) if grid.closed else u[1:]
    first = u if grid.closed else u[:-1]
    p = last[:, 1:] - first[:, :-1]
    q = first[:, 1:] - last[:, :-1]
    twice_area = p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]
    g1 = np.stack([q[..., 1], -q[..., 0]]) / twice_area
    g2 = np.stack([-p[..., 1], p[..., 0]]) / twice_area
    return np.ascontiguousarray(np.concatenate([g1, g2, 0.5 * twice_area[None]]))


def first_piola(law, fx1, fx2, fy1, fy2, fz1, fz2):
    """First Piola stress (px1, px2, py1, py2, pz1, pz2) / Y = dW/dF and the energy density W / Y.

    Compile-time dispatch on the type of `law`: Green's strain, unless the law registers kinematics of its own.
    """
    raise NotImplementedError("kinematics are compiled functions")


@overload(first_piola)
def _of_green_strain(law, fx1, fx2, fy1, fy2, fz1, fz2):
    if getattr(law, "instance_class", None) in OWN_KINEMATICS:
        return None

    def evaluate(law, fx1, fx2, fy1, fy2, fz1, fz2):
        e11 = 0.5 * (fx1 * fx1 + fy1 * fy1 + fz1 * fz1 - 1.0)
        e22 = 0.5 * (fx2 * fx2 + fy2 * fy2 + fz2 * fz2 - 1.0)
        e12 = 0.5 * (fx1 * fx2 + fy1 * fy2 + fz1 * fz2)
        s11, s22, s12, density = stress(law, e11, e22, e12)
        px1, px2 = fx1 * s11 + fx2 * s12, fx1 * s12 + fx2 * s22
        py1, py2 = fy1 * s11 + fy2 * s12, fy1 * s12 + fy2 * s22
        pz1, pz2 = fz1 * s11 + fz2 * s12, fz1 * s12 + fz2 * s22
        return px1, px2, py1, py2, pz1, pz2, density

    return evaluate


def strain(law, f):
    """Strain (e11, e22, e12) of the deformation gradient f (3, 2), of which is left what sym f^T dF = dE asks for.

    For bounds on the stiffness, not for the hot kernels. Green's strain leaves f as it is; kinematics of a law's own
    register themselves as `first_piola` does.
    """
    raise NotImplementedError("kinematics are compiled functions")


@overload(strain)
def _green_strain(law, f):
    if getattr(law, "instance_class", None) in OWN_KINEMATICS:
        return None

    def evaluate(law, f):
        e11 = 0.5 * (f[0, 0] ** 2 + f[1, 0] ** 2 + f[2, 0] ** 2 - 1.0)
        e22 = 0.5 * (f[0, 1] ** 2 + f[1, 1] ** 2 + f[2, 1] ** 2 - 1.0)
        return e11, e22, 0.5 * (f[0, 0] * f[0, 1] + f[1, 0] * f[1, 1] + f[2, 0] * f[2, 1])

    return evaluate


@compiled
def load_nodes(s, x, y, z, r, row, rows, columns):
    """Load the positions of one row of nodes into the slots x, y, z."""
    plane = np.uint64(rows) * columns
    start = np.uint64(row) * columns
    load(s, x, r, start, columns)
    load(s, y, r, plane + start, columns)
    load(s, z, r, plane + plane + start, columns)


@compiled
def load_zones(s, zone, row, zone_rows, columns):
    """Load the constants of one row of zones."""
    plane = np.uint64(zone_rows) * columns
    start = np.uint64(row) * columns
    load(s, G1X, zone, start, columns)
    load(s, G1Y, zone, plane + start, columns)
    load(s, G2X, zone, np.uint64(2) * plane + start, columns)
    load(s, G2Y, zone, np.uint64(3) * plane + start, columns)
    load(s, AREA, zone, np.uint64(4) * plane + start, columns)


@compiled
def zone_row(s, law, columns):
    """Membrane forces t1, t2 on the diagonals of one row of zones; returns the row's energy."""
    energy = 0.0
    for j in range(columns):
        d1x, d1y, d1z = s[XB + ONE + j] - s[XA + j], s[YB + ONE + j] - s[YA + j], s[ZB + ONE + j] - s[ZA + j]
        d2x, d2y, d2z = s[XA + ONE + j] - s[XB + j], s[YA + ONE + j] - s[YB + j], s[ZA + ONE + j] - s[ZB + j]
        g1x, g1y, g2x, g2y, area = s[G1X + j], s[G1Y + j], s[G2X + j], s[G2Y + j], s[AREA + j]
        fx1, fy1, fz1 = d1x * g1x + d2x * g2x, d1y * g1x + d2y * g2x, d1z * g1x + d2z * g2x
        fx2, fy2, fz2 = d1x * g1y + d2x * g2y, d1y * g1y + d2y * g2y, d1z * g1y + d2z * g2y
        px1, px2, py1, py2, pz1, pz2, density = first_piola(law, fx1, fx2, fy1, fy2, fz1, fz2)
        energy += area * density
        px1, px2, py1, py2, pz1, pz2 = area * px1, area * px2, area * py1, area * py2, area * pz1, area * pz2
        s[T1X + j], s[T2X + j] = px1 * g1x + px2 * g1y, px1 * g2x + px2 * g2y
        s[T1Y + j], s[T2Y + j] = py1 * g1x + py2 * g1y, py1 * g2x + py2 * g2y
        s[T1Z + j], s[T2Z + j] = pz1 * g1x + pz2 * g1y, pz1 * g2x + pz2 * g2y
    return energy


@compiled
def node_row(s, f, start, columns, t1, t2, upper):
    """Force on a row of nodes, one component: corners a and d of the zones above, b and c of those below."""
    for j in range(columns):
        f[start + j] = s[upper + j] + s[t1 + j] - s[t2 - ONE + j]


@compiled
def keep_upper(s, columns, t1, t2, upper):
    """Keep what the zone row pulls with on its far node row (corners b and c), one component."""
    for j in range(columns):
        s[upper + j] = s[t2 + j] - s[t1 - ONE + j]


@compiled
def band(law, r, f, zone, energy, rows, columns, closed, start, stop, s):
    """Force and energy of the node rows start <= i < stop.

    r, f : flat (3, rows, columns) positions and forces, f is overwritten in the band.
    zone : flat constants of `zone_constants`. energy : (2, rows), membrane energy of zone row i in energy[0, i].
    """
    n = np.uint64(columns)
    cells = n - ONE
    zone_rows = rows if closed else rows - 1
    for t in (T1X, T1Y, T1Z, T2X, T2Y, T2Z, UPPER_X, UPPER_Y, UPPER_Z):
        clear(s, t, n)
    for i in range(start - 1, stop):
        here = i if i >= 0 else rows - 1
        if here < zone_rows and (i >= 0 or closed):
            load_nodes(s, XA, YA, ZA, r, here, rows, n)
            load_nodes(s, XB, YB, ZB, r, here + 1 if here + 1 < rows else 0, rows, n)
            load_zones(s, zone, here, zone_rows, cells)
            row_energy = zone_row(s, law, cells)
        else:
            row_energy = 0.0
            for t in (T1X, T1Y, T1Z, T2X, T2Y, T2Z):
                clear(s, t, n)
        if i >= start:
            plane, first = np.uint64(rows) * n, np.uint64(i) * n
            node_row(s, f, first, n, T1X, T2X, UPPER_X)
            node_row(s, f, plane + first, n, T1Y, T2Y, UPPER_Y)
            node_row(s, f, plane + plane + first, n, T1Z, T2Z, UPPER_Z)
            energy[0, i] = row_energy
        keep_upper(s, n, T1X, T2X, UPPER_X)
        keep_upper(s, n, T1Y, T2Y, UPPER_Y)
        keep_upper(s, n, T1Z, T2Z, UPPER_Z)
