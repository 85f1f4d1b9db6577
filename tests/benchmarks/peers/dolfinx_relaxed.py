"""DOLFINx: the relaxed membrane as an energy in UFL, biquadratic elements, PETSc's Newton."""

import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from dolfinx_newton import Equilibrium
from mpi4py import MPI
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


def density(u, soft):
    """Energy per area; soft : part of the unrelaxed energy, since slack zones have none of their own."""
    nu = SHEET.poisson
    F = ufl.grad(u) + ufl.as_matrix([[float(i == j) for j in range(2)] for i in range(DIM)])
    E = 0.5 * (F.T * F - ufl.Identity(2))
    mean, half = 0.5 * (E[0, 0] + E[1, 1]), 0.5 * (E[0, 0] - E[1, 1])
    radius = ufl.sqrt(half**2 + E[0, 1] ** 2 + 1e-20)
    major, lateral = mean + radius, mean - radius + nu * (mean + radius)

    def relaxed(x):
        return ufl.conditional(ufl.gt(x, 0), 1.0, soft) * x**2

    return SHEET.young * SHEET.thickness * (relaxed(major) / 2 + relaxed(lateral) / (2 * (1 - nu**2)))


def solve():
    lattice = annulus_lattice(MESH) if PROBLEM == "annulus" else hole_lattice(MESH)
    cells = lattice.quadratic()[:, dolfinx.cpp.io.perm_vtk(dolfinx.mesh.CellType.quadrilateral, 9)]
    shape = ufl.Mesh(ufl.VectorElement("Lagrange", "quadrilateral", 2))
    mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells, lattice.points(), shape)
    V = fem.VectorFunctionSpace(mesh, ("Lagrange", 2), dim=DIM)
    u, soft = fem.Function(V), fem.Constant(mesh, SOFTNESS[0])
    start = annulus_start if PROBLEM == "annulus" else hole_start
    u.interpolate(lambda x: start(x[:2].T).T)
    points = V.tabulate_dof_coordinates()[:, :2]
    if PROBLEM == "annulus":
        radius = np.linalg.norm(points, axis=1)
        moved, other = np.isclose(radius, INNER), np.isclose(radius, OUTER)
    else:
        moved, other = (np.isclose(points[:, 1], side * HOLE_HEIGHT / 2) for side in (1, -1))
    held = fem.Function(V)
    held.x.array[:] = u.x.array
    supports = [fem.dirichletbc(held, np.flatnonzero(moved | other).astype(np.int32))]
    energy = density(u, soft) * ufl.dx(metadata={"quadrature_degree": 4})
    problem, total = Equilibrium(energy, u, supports), fem.form(energy)
    snes, clock = problem.solver(ITERATIONS), Clock()
    for softness in SOFTNESS:
        soft.value = softness
        problem.settle(snes)
    spent, force = clock(), problem.reactions()
    values = {"energy_N_mm": float(fem.assemble_scalar(total))}
    if PROBLEM == "annulus":
        x, y = (points + u.x.array.reshape(-1, DIM)[:, :2])[moved].T
        values["torque_N_mm"] = float((x * force[moved, 1] - y * force[moved, 0]).sum())
    else:
        values["force_N"] = float(force[moved, 1].sum())
    answer(values, spent, points.shape[0] * DIM, problem.iterations, {"dolfinx": dolfinx.__version__})


if __name__ == "__main__":
    solve_or_say(solve)
