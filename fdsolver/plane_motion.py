"""The compiled steps of a motion in the plane: two components and 2 x 2 masses (xx, yy, xy) per node.

What `damping` and `mass` do with three; `out_of_plane` off leaves no third component to carry along.
"""

from __future__ import annotations

import numba
import numpy as np

from fdsolver.rows import compiled, threaded


@compiled
def step_band(r, v, inverse_mass, f, viscosity, cap, kick, power, start, stop):
    """One step of [68] on the mesh rows from start to stop; writes the power of each row into power (rows,)."""
    keep, gain = (2.0 - viscosity) / (2.0 + viscosity), kick * 2.0 / (2.0 + viscosity)
    for i in range(start, stop):
        row = 0.0
        for j in range(r.shape[2]):
            fx, fy, xy = f[0, i, j], f[1, i, j], inverse_mass[2, i, j]
            vx = keep * v[0, i, j] + gain * (inverse_mass[0, i, j] * fx + xy * fy)
            vy = keep * v[1, i, j] + gain * (xy * fx + inverse_mass[1, i, j] * fy)
            speed = vx * vx + vy * vy
            if speed > cap * cap:
                slower = cap / np.sqrt(speed)
                vx, vy = slower * vx, slower * vy
            row += 0.5 * ((v[0, i, j] + vx) * fx + (v[1, i, j] + vy) * fy)
            v[0, i, j], v[1, i, j] = vx, vy
            r[0, i, j] += vx
            r[1, i, j] += vy
        power[i] = row


@threaded
def step_bands(r, v, inverse_mass, f, viscosity, cap, kick, power, bands):
    """`step_band` on as many bands of rows as there are threads."""
    rows = r.shape[1]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        step_band(r, v, inverse_mass, f, viscosity, cap, kick, power, start, stop)


@compiled
def twice_kinetic(v, mass):
    """Sum of v . m v over all nodes. v : (2, nodes). mass : (3, nodes)."""
    total = 0.0
    for k in range(v.shape[1]):
        x, y = v[0, k], v[1, k]
        total += mass[0, k] * x * x + mass[1, k] * y * y + 2.0 * mass[2, k] * x * y
    return total


@compiled
def invert(mass, free, inverse):
    """Inverse of every node's symmetric mass; zero at fixed nodes. mass, inverse : (3, nodes). free : (nodes,)."""
    for k in range(free.size):
        determinant = mass[0, k] * mass[1, k] - mass[2, k] * mass[2, k]
        scale = 1.0 / determinant if free[k] else 0.0
        inverse[0, k], inverse[1, k] = scale * mass[1, k], scale * mass[0, k]
        inverse[2, k] = -scale * mass[2, k]
