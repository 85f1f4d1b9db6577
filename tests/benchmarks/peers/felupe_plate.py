"""FElupe: the stretched strip as quadratic bricks with one layer and reduced integration; it has no plates or shells.

Poisson's ratio is 0.49: the bricks are of a material in three dimensions, which 0.5 would make incompressible.
"""

import felupe as fem
import numpy as np
from problem import (
    HEIGHT,
    ITERATIONS,
    PULL,
    STRETCH,
    Clock,
    answer,
    asked,
    rms_of,
    solve_or_say,
    strip_lattice,
    waves,
)

_, MESH = asked()
NU = 0.49
SHEAR = STRETCH.young / (2 * (1 + NU))
LAME = 2 * SHEAR * NU / (1 - 2 * NU)
ONE = np.eye(3)
MODULI = LAME * np.einsum("ij,kl->ijkl", ONE, ONE) + SHEAR * (
    np.einsum("ik,jl->ijkl", ONE, ONE) + np.einsum("il,jk->ijkl", ONE, ONE)
)


def second_stress(F):
    strain = 0.5 * (np.einsum("ki...,kj...->ij...", F, F) - ONE[:, :, None, None])
    return np.einsum("ijkl,kl...->ij...", MODULI, strain)


def stress(x):
    return [np.einsum("ik...,kj...->ij...", x[0], second_stress(x[0])), x[-1]]


def elasticity(x):
    F = x[0]
    A = np.einsum("im...,mjnl,kn...->ijkl...", F, MODULI, F, optimize=True)
    return [A + np.einsum("ik,jl...->ijkl...", ONE, second_stress(F))]


def bricks():
    """Points (n, 3) and elements (m, 20), in the order of VTK."""
    lattice = strip_lattice(MESH)
    flat, cells = lattice.points(), lattice.quadratic()[:, :8]
    points = np.concatenate(
        [
            np.column_stack([flat, np.full(len(flat), z)])
            for z in STRETCH.thickness * np.array([-0.5, 0.0, 0.5])
        ]
    )
    corners, middles, n = cells[:, :4], cells[:, 4:], len(flat)
    whole = np.hstack([corners, corners + 2 * n, middles, middles + 2 * n, corners + n])
    used, place = np.unique(whole, return_inverse=True)
    return points[used], place.reshape(whole.shape)


def solve():
    points, cells = bricks()
    mesh = fem.Mesh(points, cells, "hexahedron20")
    region = fem.Region(mesh, fem.QuadraticHexahedron(), fem.GaussLegendre(order=1, dim=3))
    start = np.zeros_like(points)
    start[:, 1] = PULL * (points[:, 1] / HEIGHT + 0.5)
    field = fem.FieldContainer([fem.Field(region, dim=3, values=start)])
    top, bottom = (np.isclose(points[:, 1], side * HEIGHT / 2) for side in (1, -1))
    middle = np.isclose(points[:, 2], 0.0)  # the pinned line
    supports = {
        "plane": fem.Boundary(field[0], mask=top | bottom, skip=(0, 0, 1)),
        "line": fem.Boundary(field[0], mask=(top | bottom) & middle, skip=(1, 1, 0)),
    }
    outside, inside = fem.dof.partition(field, supports)
    values = start.ravel()[outside]
    solid = fem.SolidBody(fem.Material(stress, elasticity), field)
    clock, count = Clock(), 0
    for height in (0.0, 1.0):  # first flat, then from waves on it
        field[0].values[:, 2] += height * waves(points)
        result = fem.newtonraphson(
            items=[solid], dof0=outside, dof1=inside, ext0=values, maxiter=ITERATIONS, tol=1e-9, verbose=0
        )
        count += result.iterations
    spent = clock()
    force = solid.assemble.vector().toarray().reshape(-1, 3)
    line = np.flatnonzero(np.isclose(points[:, 1], 0.0) & np.isclose(points[:, 2], STRETCH.thickness / 2))
    line = line[np.argsort(points[line, 0])]
    z = field[0].values[line, 2]
    found = {"force_N": float(force[top, 1].sum()), "rms_mm": rms_of(points[line, 0], z - z.mean())}
    answer(found, spent, points.size, count, {"felupe": fem.__version__})


if __name__ == "__main__":
    solve_or_say(solve)
