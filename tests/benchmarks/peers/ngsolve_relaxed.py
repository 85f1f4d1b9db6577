"""NGSolve: the relaxed membrane as an energy that is differentiated symbolically, cubic elements, damped Newton."""

import ngsolve as ng
from netgen.geom2d import SplineGeometry
from problem import (
    ANNULUS,
    HOLE,
    HOLE_HEIGHT,
    HOLE_PULL,
    HOLE_WIDTH,
    INNER,
    ITERATIONS,
    LIFT,
    OUTER,
    RADIUS,
    TURN,
    Clock,
    answer,
    asked,
    solve_or_say,
)

PROBLEM, MESH = asked()
# part of the unrelaxed energy, lowered step by step: slack zones have none of their own
SOFTNESS = (0.0,) if PROBLEM == "annulus" else tuple(10.0**-k for k in range(1, 6))
SOFT = ng.Parameter(SOFTNESS[0])


def geometry():
    shape = SplineGeometry()
    if PROBLEM == "annulus":
        shape.AddCircle((0, 0), OUTER, bc="outer", leftdomain=1, rightdomain=0)
        shape.AddCircle((0, 0), INNER, bc="inner", leftdomain=0, rightdomain=1)
        return shape, 60.0 / MESH, "inner|outer"
    x, y = HOLE_WIDTH / 2, HOLE_HEIGHT / 2
    shape.AddRectangle((-x, -y), (x, y), bcs=["bottom", "side", "top", "side"])
    shape.AddCircle((0, 0), RADIUS, bc="hole", leftdomain=0, rightdomain=1)
    return shape, 15.0 / MESH, "bottom|top"


def energy(u, sheet, dim):
    F = ng.Grad(u) + ng.CF(tuple(float(i == j) for i in range(dim) for j in range(2)), dims=(dim, 2))
    E = 0.5 * (F.trans * F - ng.Id(2))
    mean, half = 0.5 * (E[0, 0] + E[1, 1]), 0.5 * (E[0, 0] - E[1, 1])
    radius = ng.sqrt(half**2 + E[0, 1] ** 2 + 1e-20)
    major, lateral = mean + radius, mean - radius + sheet.poisson * (mean + radius)
    full = 0.5 * major**2 + lateral**2 / (2 * (1 - sheet.poisson**2))
    relaxed = ng.IfPos(major, 0.5 * major**2, 0) + ng.IfPos(
        lateral, lateral**2 / (2 * (1 - sheet.poisson**2)), 0
    )
    return sheet.young * sheet.thickness * ((1 - SOFT) * relaxed + SOFT * full)


def start(dim):
    x, y = ng.x, ng.y
    if PROBLEM == "hole":
        return ng.CF((0, HOLE_PULL * y / HOLE_HEIGHT))
    r = ng.sqrt(x**2 + y**2)
    share = (OUTER - r) / (OUTER - INNER)
    turned = TURN * share
    c, s = ng.cos(turned), ng.sin(turned)
    return ng.CF((c * x - s * y - x, s * x + c * y - y, LIFT * share))


def solve():
    shape, size, held = geometry()
    mesh = ng.Mesh(shape.GenerateMesh(maxh=size))
    mesh.Curve(3)
    dim, sheet = (3, ANNULUS) if PROBLEM == "annulus" else (2, HOLE)
    space = ng.H1(mesh, order=3, dim=dim, dirichlet=held)
    form = ng.BilinearForm(space, symmetric=True)
    form += ng.Variation(energy(space.TrialFunction(), sheet, dim).Compile() * ng.dx)
    state = ng.GridFunction(space)
    state.Set(start(dim))
    state.Set(start(dim), definedon=mesh.Boundaries(held))  # the interior values of Set are lost: set again
    inside = ng.GridFunction(space)
    inside.Set(start(dim))
    free = space.FreeDofs()
    for k in range(len(free)):
        if free[k]:
            state.vec[k] = inside.vec[k]
    clock = Clock()
    count = 0
    for softness in SOFTNESS:
        SOFT.Set(softness)
        status, more = ng.solvers.NewtonMinimization(
            form, state, maxit=ITERATIONS, maxerr=1e-9, inverse="sparsecholesky", printing=False
        )
        count += more
        if status:
            raise ArithmeticError(
                f"no equilibrium after {count} iterations, part of full energy {softness:g}"
            )
    force = state.vec.CreateVector()
    form.Apply(state.vec, force)
    spent = clock()
    shift = ng.GridFunction(space)
    if PROBLEM == "annulus":
        x, y = ng.x + state[0], ng.y + state[1]
        shift.Set(ng.CF((-y, x, 0)), definedon=mesh.Boundaries("inner"))
        values = {"torque_N_mm": ng.InnerProduct(force, shift.vec)}
    else:
        shift.Set(ng.CF((0, 1)), definedon=mesh.Boundaries("top"))
        values = {"force_N": ng.InnerProduct(force, shift.vec)}
    values["energy_N_mm"] = form.Energy(state.vec)
    answer(values, spent, dim * space.ndof, count, {"ngsolve": ng.__version__})


if __name__ == "__main__":
    solve_or_say(solve)
