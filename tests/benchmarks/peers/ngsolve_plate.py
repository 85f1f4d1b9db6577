"""NGSolve: the stretched strip as a plate, heights and moments as unknowns (Hellan, Herrmann and Johnson).

The membrane strain is exact; the curvature is that of the heights alone, as the rotations are small.
"""

import ngsolve as ng
import numpy as np
from ngsolve.meshes import MakeStructured2DMesh
from problem import (
    HEIGHT,
    ITERATIONS,
    PULL,
    SEED_HEIGHT,
    STRETCH,
    WAVELENGTH,
    WIDTH,
    Clock,
    answer,
    asked,
    rms_of,
    solve_or_say,
)

_, MESH = asked()
NU, H = STRETCH.poisson, STRETCH.thickness
STIFFNESS = STRETCH.young * H**3 / (12 * (1 - NU**2))


def energy(u, w, moment):
    """Membrane energy, and the functional whose saddle point has moment = STIFFNESS (...) of the curvature of w."""
    slope, n = ng.grad(w), ng.specialcf.normal(2)
    F = ng.Grad(u) + ng.Id(2)
    E = 0.5 * (F.trans * F + ng.OuterProduct(slope, slope) - ng.Id(2))
    membrane = (
        STRETCH.young * H / (2 * (1 - NU**2)) * ((1 - NU) * ng.InnerProduct(E, E) + NU * ng.Trace(E) ** 2)
    )
    spread = ng.InnerProduct(moment, moment) - NU / (1 + NU) * ng.Trace(moment) ** 2
    inside = membrane - spread / (2 * STIFFNESS * (1 - NU)) + ng.InnerProduct(moment, w.Operator("hesse"))
    return inside.Compile(), (moment * n) * n * (slope * n)


def solve():
    mesh = MakeStructured2DMesh(
        quads=False,
        nx=MESH,
        ny=max(MESH // 2, 4),
        mapping=lambda x, y: (WIDTH * (x - 0.5), HEIGHT * (y - 0.5)),
    )
    held = "bottom|top"
    plane = ng.VectorH1(mesh, order=3, dirichlet=held)
    heights = ng.H1(mesh, order=3, dirichlet=held)
    moments = ng.HDivDiv(mesh, order=2, dirichlet=".*")  # no couple on any edge
    space = plane * heights * moments
    inside, edges = energy(*space.TrialFunction())
    form = ng.BilinearForm(space, symmetric=True)
    form += ng.Variation(inside * ng.dx)
    form += ng.Variation(-edges * ng.dx(element_boundary=True))
    state, step = ng.GridFunction(space), ng.GridFunction(space)
    state.components[0].Set(ng.CF((0, PULL * (ng.y / HEIGHT + 0.5))))
    wave = SEED_HEIGHT * ng.cos(np.pi * ng.x / WIDTH) ** 2 * ng.cos(np.pi * ng.y / HEIGHT) ** 2
    step.components[1].Set(wave * ng.cos(2 * np.pi * ng.x / WAVELENGTH))
    clock, count = Clock(), 0
    for height in (0.0, 1.0):  # first flat, then from waves on it
        state.vec.data += height * step.vec
        status, more = ng.solvers.Newton(
            form, state, maxit=ITERATIONS, maxerr=1e-9, inverse="sparsecholesky", printing=False
        )
        count += more
        if status:
            raise ArithmeticError(f"no equilibrium after {count} iterations")
    spent = clock()
    force, shift = state.vec.CreateVector(), ng.GridFunction(space)
    form.Apply(state.vec, force)
    shift.components[0].Set(ng.CF((0, 1)), definedon=mesh.Boundaries("top"))
    x = np.linspace(-WIDTH / 2, WIDTH / 2, 2001)
    z = np.array([state.components[1](mesh(float(place), 0.0)) for place in x])
    values = {
        "energy_N_mm": form.Energy(state.vec),
        "force_N": ng.InnerProduct(force, shift.vec),
        "rms_mm": rms_of(x, z),
    }
    answer(values, spent, space.ndof, count, {"ngsolve": ng.__version__})


if __name__ == "__main__":
    solve_or_say(solve)
