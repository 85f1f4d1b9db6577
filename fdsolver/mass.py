"""Nodal masses from a bound on the local stiffness, so that a unit time step is stable (DESIGN of the engine: the mass
in dynamic relaxation is free, only equilibria matter).

A zone's energy changes by at most A (M |sym F^T dF|^2 + s |dF|^2) / 2 with the largest modulus M = 1 / (1 - nu^2) and
the largest principal stress s (scaled by Y). With phi and theta the sizes of the in-plane and out-of-plane rows of F,
|sym F^T dF|^2 <= (phi + theta) (phi |d in-plane|^2 + theta |d out-of-plane|^2): the slope theta couples the two, and
a mass that forgets it is too light as soon as wrinkles grow. |dF|^2 <= G (|d1|^2 + |d2|^2) <= 2 G sum |dr|^2 over the
corners, G the largest eigenvalue of the Gram matrix of g1 and g2. The bending stencils give 16 times their moduli.
"""

from __future__ import annotations

import numpy as np

from fdsolver.effects import Force
from fdsolver.membrane import stress
from fdsolver.rows import compiled

SAFETY = 1.4  # over the bound for central differences, m >= k / 4; covers the growth of k between two updates
LEAST_SLOPE = 0.05  # smallest slope counted on: wrinkles steeper than the present state must not outrun the mass


@compiled
def _membrane_stiffness(law, r, zone, closed, least_slope, stiffness):
    """Add the zones' share of the stiffness bound, in plane and out of plane, to their corners."""
    rows, columns = r.shape[1], r.shape[2]
    zone_rows = rows if closed else rows - 1
    modulus = 1.0 / (1.0 - law.poisson * law.poisson)
    for i in range(zone_rows):
        k = (i + 1) % rows
        for j in range(columns - 1):
            g1x, g1y, g2x, g2y = zone[0, i, j], zone[1, i, j], zone[2, i, j], zone[3, i, j]
            c11 = c22 = c12 = inside = outside = 0.0
            for axis in range(3):
                d1 = r[axis, k, j + 1] - r[axis, i, j]
                d2 = r[axis, i, j + 1] - r[axis, k, j]
                f1, f2 = d1 * g1x + d2 * g2x, d1 * g1y + d2 * g2y
                c11, c22, c12 = c11 + f1 * f1, c22 + f2 * f2, c12 + f1 * f2
                if axis == 2:
                    outside = f1 * f1 + f2 * f2
            largest = 0.5 * (c11 + c22) + np.sqrt(0.25 * (c11 - c22) ** 2 + c12 * c12)
            s11, s22, s12, _ = stress(law, 0.5 * (c11 - 1.0), 0.5 * (c22 - 1.0), 0.5 * c12)
            tension = max(0.5 * (s11 + s22) + np.sqrt(0.25 * (s11 - s22) ** 2 + s12 * s12), 0.0)
            theta = np.sqrt(outside)
            inside = np.sqrt(max(largest - outside, 0.25 * largest))
            theta = max(theta, least_slope * inside)
            a, b, c = g1x * g1x + g1y * g1y, g2x * g2x + g2y * g2y, g1x * g2x + g1y * g2y
            gram = 0.5 * (a + b) + np.sqrt(0.25 * (a - b) ** 2 + c * c)
            weight = 2.0 * zone[4, i, j] * gram
            plane = weight * (modulus * inside * (inside + theta) + tension)
            normal = weight * (modulus * theta * (inside + theta) + tension)
            for row, column in ((i, j), (k, j), (k, j + 1), (i, j + 1)):
                stiffness[0, row, column] += plane
                stiffness[1, row, column] += normal


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


def nodal_masses(force: Force, r: np.ndarray, kind: str = "nodal", least_slope: float = LEAST_SLOPE) -> np.ndarray:
    """Masses that make a unit time step stable at the state r.

    r : (3, ni, nj) float64, scaled positions.
    kind : "nodal" (in plane and out of plane apart), "isotropic" (their maximum) or "uniform" (the maximum over the
        mesh, as published).

    Returns (2, ni, nj) float64: in-plane and out-of-plane mass of every node, scaled (time step 1).
    """
    stiffness = np.zeros((2, force.rows, force.columns))
    _membrane_stiffness(force.law, r, force.zone, force.closed, least_slope, stiffness)
    if force.node is not None:
        stiffness += _bending_stiffness(force)
    if kind == "isotropic":
        stiffness[:] = stiffness.max(axis=0)
    elif kind == "uniform":
        stiffness[:] = stiffness.max()
    elif kind != "nodal":
        raise ValueError(f"mass must be nodal, isotropic or uniform, not {kind!r}")
    return 0.25 * SAFETY * stiffness
