"""Damping rules of dynamic relaxation, and the compiled step.

adaptive : viscous, c = 2 omega with omega^2 the Rayleigh quotient of the motion, measured once a block. Where the
    quotient is negative the motion runs down from an unstable state, and is not damped at all.
kinetic : no viscosity; at a peak of kinetic energy go back to r(n) and restart from rest with the half kick [70], at
    least `APART` steps after the last restart.
kinetic-published : restart at every peak of the kinetic energy [72] from the estimate [73].
viscous : constant c = 2 omega of the longest wave that fits the mesh.
"""

from __future__ import annotations

import math

import numpy as np

from fdsolver.rows import compiled

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
def step(r, v, inverse_mass, f, viscosity, cap, kick):
    """One step of [68] with unit time step, kick = 1/2 from rest [70] and 1 otherwise; returns the power (v_old + v_new) . f / 2 at the positions r(n)."""
    keep, gain = (2.0 - viscosity) / (2.0 + viscosity), 2.0 / (2.0 + viscosity)
    power = 0.0
    for k in range(r.size):
        old = v[k]
        new = min(max(keep * old + kick * gain * inverse_mass[k] * f[k], -cap), cap)
        v[k] = new
        r[k] += new
        power += 0.5 * (old + new) * f[k]
    return power


@compiled
def rayleigh(v, inverse_mass, old, new):
    """(v K v) / (v M v) of the motion that led from force `old` to force `new` in one step; 0 at rest."""
    stiffness = mass = 0.0
    for k in range(v.size):
        if inverse_mass[k] > 0.0:
            stiffness -= v[k] * (new[k] - old[k])
            mass += v[k] * v[k] / inverse_mass[k]
    return stiffness / mass if mass > 0.0 else 0.0


@compiled
def kinetic_energy(v, inverse_mass):
    """Sum of m v^2 / 2 over all moving components [72]."""
    energy = 0.0
    for k in range(v.size):
        if inverse_mass[k] > 0.0:
            energy += 0.5 * v[k] * v[k] / inverse_mass[k]
    return energy


def advance(force, r, v, inverse_mass, f, old, rule, viscosity, since_restart, steps, cap):
    """Advance r and v in place by `steps` steps under a damping rule; f holds the force at r on entry.

    r, v, inverse_mass, f, old : (3, ni, nj) float64; old is scratch. Returns the number of restarts, the viscosity
    and the steps since the last restart.
    """
    name, constant = rule
    kinetic = name.startswith("kinetic")
    viscosity = 0.0 if kinetic else constant if name == "viscous" else viscosity
    flat = [a.reshape(-1) for a in (r, v, inverse_mass, f, old)]
    restarts = 0
    for k in range(steps):
        if k > 0:
            if k == steps - 1:
                old[:] = f
            force(r, f)
            if k == steps - 1 and name == "adaptive":
                quotient = rayleigh(flat[1], flat[2], flat[4], flat[3])
                viscosity = min(2.0 * math.sqrt(max(quotient, 0.0)), LARGEST_VISCOSITY)
        power = step(*flat[:4], viscosity, cap, 0.5 if since_restart == 0 else 1.0)
        since_restart += 1
        if name == "kinetic-published" and power < 0.0:
            r -= 1.5 * v - 0.5 * inverse_mass * f
            v[:] = 0.0
            restarts, since_restart = restarts + 1, 0
        elif name == "kinetic" and power < 0.0 and since_restart > APART:
            r -= v
            v[:] = 0.5 * inverse_mass * f
            r += v
            restarts, since_restart = restarts + 1, 1
    return restarts, viscosity, since_restart
