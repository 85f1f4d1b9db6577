"""FElupe: the relaxed membrane as a material with stress and elasticity written out, biquadratic elements, Newton."""

import felupe as fem
import numpy as np
from problem import (
    ANNULUS,
    HOLE,
    HOLE_HEIGHT,
    INNER,
    ITERATIONS,
    OUTER,
    Clock,
    annulus_lattice,
    annulus_start,
    answer,
    asked,
    hole_lattice,
    hole_start,
    solve_or_say,
)

PROBLEM, MESH = asked()
SHEET, DIM = (ANNULUS, 3) if PROBLEM == "annulus" else (HOLE, 2)
SOFTNESS = (0.0,) if PROBLEM == "annulus" else tuple(10.0**-k for k in range(1, 6))
SOFT = [SOFTNESS[0]]  # part of the unrelaxed energy, lowered step by step: slack zones have none of their own


def principal(F):
    """Principal Green strains (major, minor), and the tensors on which they are read: M1, M2 and the shear."""
    C = np.einsum("ki...,kj...->ij...", F, F)
    e11, e22, e12 = 0.5 * (C[0, 0] - 1), 0.5 * (C[1, 1] - 1), 0.5 * C[0, 1]
    mean, half = 0.5 * (e11 + e22), 0.5 * (e11 - e22)
    radius = np.sqrt(half**2 + e12**2 + 1e-20)
    angle = 0.5 * np.arctan2(e12, half)
    m = np.array([np.cos(angle), np.sin(angle)])
    n = np.array([-m[1], m[0]])
    first, second = (np.einsum("i...,j...->ij...", a, a) for a in (m, n))
    mixed = np.einsum("i...,j...->ij...", m, n)
    return mean + radius, mean - radius, first, second, mixed + mixed.swapaxes(0, 1)


def stresses(major, minor):
    """Principal second Piola stresses and their derivatives by (major, minor)."""
    nu, soft = SHEET.poisson, SOFT[0]
    lateral = minor + nu * major
    on = np.where(lateral > 0, 1.0, soft) / (1 - nu**2)
    tension = np.where(major > 0, 1.0, soft)
    d22, d12, d11 = on, nu * on, tension + nu**2 * on
    return d11 * major + d12 * minor, d12 * major + d22 * minor, d11, d12, d22


def stress(x):
    F = x[0]
    major, minor, first, second, _ = principal(F)
    s1, s2, *_ = stresses(major, minor)
    return [SHEET.young * np.einsum("ik...,kj...->ij...", F, s1 * first + s2 * second), x[-1]]


def elasticity(x):
    F = x[0]
    major, minor, first, second, shear = principal(F)
    s1, s2, d11, d12, d22 = stresses(major, minor)
    across = 0.5 * (s1 - s2) / (major - minor)

    def dyad(a, b):
        return np.einsum("ij...,kl...->ijkl...", a, b)

    D = d11 * dyad(first, first) + d22 * dyad(second, second) + across * dyad(shear, shear)
    D += d12 * (dyad(first, second) + dyad(second, first))
    A = np.einsum("im...,mjnl...,kn...->ijkl...", F, D, F)
    A += np.einsum("ik,jl...->ijkl...", np.eye(DIM), s1 * first + s2 * second)
    return [SHEET.young * A]


def energy(F, weight):
    major, minor, *_ = principal(F)
    s1, s2, *_ = stresses(major, minor)
    return 0.5 * SHEET.young * SHEET.thickness * float(((s1 * major + s2 * minor) * weight).sum())


def solve():
    lattice = annulus_lattice(MESH) if PROBLEM == "annulus" else hole_lattice(MESH)
    points = lattice.points()
    region = fem.RegionBiQuadraticQuad(fem.Mesh(points, lattice.quadratic(), "quad9"))
    start = annulus_start(points) if PROBLEM == "annulus" else hole_start(points)
    field = fem.FieldContainer([fem.Field(region, dim=DIM, values=start)])
    if PROBLEM == "annulus":
        radius = np.linalg.norm(points, axis=1)
        moved, other = np.isclose(radius, INNER), np.isclose(radius, OUTER)
    else:
        moved, other = (np.isclose(points[:, 1], side * HOLE_HEIGHT / 2) for side in (1, -1))
    held = fem.Boundary(field[0], mask=moved | other)
    outside, inside = fem.dof.partition(field, {"held": held})
    values = start.ravel()[outside]
    solid = fem.SolidBody(fem.Material(stress, elasticity), field)
    clock, count = Clock(), 0
    for softness in SOFTNESS:
        SOFT[0] = softness
        result = fem.newtonraphson(
            items=[solid], dof0=outside, dof1=inside, ext0=values, maxiter=ITERATIONS, tol=1e-9, verbose=0
        )
        count += result.iterations
    spent = clock()
    force = SHEET.thickness * solid.assemble.vector().toarray().reshape(-1, DIM)
    found = {"energy_N_mm": energy(solid.field.extract()[0], region.dV)}
    if PROBLEM == "annulus":
        x, y = (points + field[0].values[:, :2])[moved].T
        found["torque_N_mm"] = float((x * force[moved, 1] - y * force[moved, 0]).sum())
    else:
        found["force_N"] = float(force[moved, 1].sum())
    answer(found, spent, points.size // 2 * DIM, count, {"felupe": fem.__version__})


if __name__ == "__main__":
    solve_or_say(solve)
