"""Damping rules of dynamic relaxation, and the compiled step.

adaptive : viscous, c = 2 omega with omega^2 the Rayleigh quotient of the motion, measured once a block. Where the
    quotient is negative the motion runs down from an unstable state, and is not damped at all.
kinetic : no viscosity; at a peak of kinetic energy go back to the middle of r(n - 1) and r(n) and restart from rest
    with the half kick [70], at least `APART` steps after the last restart. Where no speed is capped that middle is the
    estimate [73]. It wipes out the fastest waves, which a restart at r(n) keeps; and a fall that is not the end of a
    rise is no peak: restarts at a fixed distance never stop the modes for which it is half a period.
kinetic-published : restart at every peak of the kinetic energy [72] from the estimate [73].
viscous : constant c = 2 omega of the longest wave that fits the mesh.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from fdsolver import plane_motion
from fdsolver.rows import compiled, threaded

APART = 10  # steps between two kinetic restarts
LARGEST_VISCOSITY = 1.0  # per step; beyond it the fastest waves are damped, which need no help
RULES = ("adaptive", "kinetic", "kinetic-published", "viscous")


def rule(name: str, nodes_across: int) -> tuple[str, float]:
    """The rule's name and its constant viscosity (used by "viscous" only).

    Raises ValueError for an unknown name.
    """
    if name not in RULES:
        raise ValueError(f"damping must be one of {', '.join(RULES)}, not {name!r}")
    return name, 2.0 * math.pi / nodes_across


@compiled
def step_band(r, v, inverse_mass, f, viscosity, cap, kick, power, start, stop):
    """`step` on the mesh rows from start to stop; writes the power of each row into power (rows,)."""
    keep, gain = (2.0 - viscosity) / (2.0 + viscosity), kick * 2.0 / (2.0 + viscosity)
    for i in range(start, stop):
        row = 0.0
        for j in range(r.shape[2]):
            fx, fy, fz = f[0, i, j], f[1, i, j], f[2, i, j]
            xy, xz, yz = inverse_mass[3, i, j], inverse_mass[4, i, j], inverse_mass[5, i, j]
            vx = keep * v[0, i, j] + gain * (inverse_mass[0, i, j] * fx + xy * fy + xz * fz)
            vy = keep * v[1, i, j] + gain * (xy * fx + inverse_mass[1, i, j] * fy + yz * fz)
            vz = keep * v[2, i, j] + gain * (xz * fx + yz * fy + inverse_mass[2, i, j] * fz)
            speed = vx * vx + vy * vy + vz * vz
            if speed > cap * cap:
                slower = cap / np.sqrt(speed)
                vx, vy, vz = slower * vx, slower * vy, slower * vz
            row += 0.5 * ((v[0, i, j] + vx) * fx + (v[1, i, j] + vy) * fy + (v[2, i, j] + vz) * fz)
            v[0, i, j], v[1, i, j], v[2, i, j] = vx, vy, vz
            r[0, i, j] += vx
            r[1, i, j] += vy
            r[2, i, j] += vz
        power[i] = row


@threaded
def step_bands(r, v, inverse_mass, f, viscosity, cap, kick, power, bands):
    """`step_band` on as many bands of rows as there are threads."""
    rows = r.shape[1]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        step_band(r, v, inverse_mass, f, viscosity, cap, kick, power, start, stop)


def step(r, v, inverse_mass, f, viscosity, cap, kick, threads=1):
    """One step of [68] with unit time step; the first from rest [70] has kick = 1/2 and no viscosity, others kick = 1.

    r, v, f : (3, ni, nj), or (2, ni, nj) in the plane. inverse_mass : (6, ni, nj), xx yy zz xy xz yz, or (3, ni, nj),
    xx yy xy. cap : largest speed of a node. threads : bands of rows side by side. Returns the power
    (v_old + v_new) . f / 2 at the positions r(n), summed by rows in order: same bits for any number of threads.
    """
    power = np.empty(r.shape[1])
    band, bands = (
        (step_band, step_bands) if len(r) == 3 else (plane_motion.step_band, plane_motion.step_bands)
    )
    if threads == 1:
        band(r, v, inverse_mass, f, viscosity, cap, kick, power, 0, r.shape[1])
    else:
        bands(r, v, inverse_mass, f, viscosity, cap, kick, power, threads)
    return float(power.sum())


def twice_kinetic(v, mass):
    """Sum of v . m v over all nodes, twice the kinetic energy [72].

    v : (3, nodes), mass : (6, nodes); in the plane (2, nodes) and (3, nodes).
    """
    return (twice_kinetic_in_space if len(v) == 3 else plane_motion.twice_kinetic)(v, mass)


@compiled
def twice_kinetic_in_space(v, mass):
    """`twice_kinetic` of motions with three components."""
    total = 0.0
    for k in range(v.shape[1]):
        x, y, z = v[0, k], v[1, k], v[2, k]
        total += mass[0, k] * x * x + mass[1, k] * y * y + mass[2, k] * z * z
        total += 2.0 * (mass[3, k] * x * y + mass[4, k] * x * z + mass[5, k] * y * z)
    return total


@compiled
def twice_work(v, old, new):
    """v K v of the motion v that led from force `old` to force `new` in one step; all (components, nodes)."""
    total = 0.0
    for axis in range(v.shape[0]):
        for k in range(v.shape[1]):
            total -= v[axis, k] * (new[axis, k] - old[axis, k])
    return total


def times(mass, v):
    """Product of every node's symmetric matrix and vector; mass and v as in `twice_kinetic`, but (..., ni, nj)."""
    if len(v) == 2:
        xx, yy, xy = mass
        return np.stack([xx * v[0] + xy * v[1], xy * v[0] + yy * v[1]])
    xx, yy, zz, xy, xz, yz = mass
    x, y, z = v
    return np.stack([xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z])


def advance(
    force, r, v, mass, inverse_mass, f, old, rule, viscosity, since_restart, rising, steps, cap, threads=1
):
    """Advance r and v in place by `steps` steps under a damping rule; f holds the force at r on entry.

    r, v, f, old, mass, inverse_mass : as in `step`; old is scratch. rising : whether the last step
    added kinetic energy. threads : bands of rows side by side. Returns the number of restarts, the viscosity, the steps
    since the last restart, `rising`, and the Rayleigh quotient omega^2 of the motion at the last step (0 at rest).

    A force with a method follow(r, v) has it called after each step: it moves nodes that obey no force (ghosts, [74]).
    """
    name, constant = rule
    follow = getattr(force, "follow", None)
    kinetic = name.startswith("kinetic")
    viscosity = 0.0 if kinetic else constant if name == "viscous" else viscosity
    nodes = r.shape[1] * r.shape[2]
    motion, before, after = (field.reshape(len(field), nodes) for field in (v, old, f))
    arrival = np.empty_like(v)  # the velocity with which the motion came to r(n)
    restarts, quotient = 0, 0.0
    for k in range(steps):
        if k > 0:
            if k == steps - 1:
                old[:] = f
            force(r, f)
            if k == steps - 1:
                inertia = twice_kinetic(motion, mass.reshape(len(mass), nodes))
                quotient = twice_work(motion, before, after) / inertia if inertia > 0.0 else 0.0
                if name == "adaptive":
                    viscosity = min(2.0 * math.sqrt(max(quotient, 0.0)), LARGEST_VISCOSITY)
        if name == "kinetic":
            arrival[:] = v
        damped, share = (0.0, 0.5) if since_restart == 0 else (viscosity, 1.0)
        power = step(r, v, inverse_mass, f, damped, cap, share, threads)
        since_restart += 1
        peak, rising = rising and power < 0.0, power >= 0.0
        if name == "kinetic-published" and power < 0.0:
            r -= 1.5 * v - 0.5 * times(inverse_mass, f)
            v[:] = 0.0
            restarts, since_restart = restarts + 1, 0
        elif name == "kinetic" and peak and since_restart >= APART:
            r -= v + 0.5 * arrival
            v[:] = 0.0
            restarts, since_restart = restarts + 1, 0
        if follow is not None:
            follow(r, v)
    return restarts, viscosity, since_restart, rising, quotient
