"""DOLFINx: the stretched strip as a plate, biquadratic elements with interior penalties for the missing continuity.

The membrane strain is exact; the curvature is that of the heights alone, as the rotations are small.
"""

import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from dolfinx_newton import Equilibrium
from mpi4py import MPI
from problem import (
    HEIGHT,
    ITERATIONS,
    PULL,
    STRETCH,
    WIDTH,
    Clock,
    answer,
    asked,
    rms_of,
    solve_or_say,
    strip_lattice,
    waves,
)

_, MESH = asked()
PENALTY = 8.0  # of a kink, in bending stiffness over element size
NU, H = STRETCH.poisson, STRETCH.thickness
STIFFNESS = STRETCH.young * H**3 / (12 * (1 - NU**2))


def membrane(u):
    F = ufl.grad(u) + ufl.as_matrix([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    E = 0.5 * (F.T * F - ufl.Identity(2))
    return STRETCH.young * H / (2 * (1 - NU**2)) * ((1 - NU) * ufl.inner(E, E) + NU * ufl.tr(E) ** 2)


def bending(w, mesh):
    """Energies of the elements and of the kinks between them."""
    n, size = ufl.FacetNormal(mesh), WIDTH / MESH
    curvature = ufl.grad(ufl.grad(w))
    moment = STIFFNESS * ((1 - NU) * curvature + NU * ufl.tr(curvature) * ufl.Identity(2))
    kink = ufl.jump(ufl.grad(w), n)
    across = ufl.avg(ufl.dot(ufl.dot(moment, n), n))
    inside = 0.5 * ufl.inner(moment, curvature) * ufl.dx
    return inside + (0.5 * PENALTY * STIFFNESS / size * kink**2 - across * kink) * ufl.dS


def solve():
    lattice = strip_lattice(MESH)
    cells = lattice.quadratic()[:, dolfinx.cpp.io.perm_vtk(dolfinx.mesh.CellType.quadrilateral, 9)]
    shape = ufl.Mesh(ufl.VectorElement("Lagrange", "quadrilateral", 2))
    mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells, lattice.points(), shape)
    V = fem.VectorFunctionSpace(mesh, ("Lagrange", 2), dim=3)
    u, held = fem.Function(V), fem.Function(V)
    u.interpolate(lambda x: np.stack([0 * x[0], PULL * (x[1] / HEIGHT + 0.5), 0 * x[0]]))
    held.x.array[:] = u.x.array
    points = V.tabulate_dof_coordinates()[:, :2]
    top, bottom = (np.isclose(points[:, 1], side * HEIGHT / 2) for side in (1, -1))
    supports = [fem.dirichletbc(held, np.flatnonzero(top | bottom).astype(np.int32))]
    energy = membrane(u) * ufl.dx(metadata={"quadrature_degree": 4}) + bending(u[2], mesh)
    problem, total = Equilibrium(energy, u, supports), fem.form(energy)
    snes, clock = problem.solver(ITERATIONS), Clock()
    for height in (np.zeros(len(points)), waves(points)):  # first flat, then from waves on it
        problem.x.array[2::3] += height
        problem.settle(snes)
    spent, force = clock(), problem.reactions()
    line = np.flatnonzero(np.isclose(points[:, 1], 0.0))
    line = line[np.argsort(points[line, 0])]
    values = {
        "energy_N_mm": float(fem.assemble_scalar(total)),
        "force_N": float(force[top, 1].sum()),
        "rms_mm": rms_of(points[line, 0], u.x.array.reshape(-1, 3)[line, 2]),
    }
    answer(values, spent, points.shape[0] * 3, problem.iterations, {"dolfinx": dolfinx.__version__})


if __name__ == "__main__":
    solve_or_say(solve)
