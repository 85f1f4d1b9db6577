"""A manufactured solution of the nonlinear sheet: its load balances a smooth strained and bent shape exactly.

The load is the weak form itself: the derivative of the energy density at the exact shape, by complex steps, tested with
every function of the mesh. What is left is the error of the elements: fourth order in position, second in curvature.
"""

from __future__ import annotations

import numpy as np

from femref.assembly import SheetEnergy
from femref.bicubic import GAUSS_POINTS, Mesh, evaluate, from_function
from femref.held import Support, held_by_supports
from femref.newton import NewtonSettings, Outcome, minimise
from tests.femref.sheets import POISSON, THICKNESS, YOUNG, plain_gradient, waves

ORDERS = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
# With a free edge the shape would be in equilibrium too, but not in a stable one, and the solver would leave it.
EDGES = dict.fromkeys(("left", "right", "top"), Support("pinned")) | {"bottom": Support("clamped")}


def exact_nodes(mesh: Mesh) -> np.ndarray:
    def function(x, y):
        r, first, second, _, mixed, _ = waves(x, y)
        return np.stack([r, second, first, mixed])

    return from_function(mesh, function)


def gauss(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    along_x, along_y = mesh.axis_tables
    x, y = (table.place.ravel() for table in (along_x, along_y))
    area = np.outer(along_x.weight.ravel(), along_y.weight.ravel())
    return *np.meshgrid(x, y, indexing="ij"), area


def manufactured_load(mesh: Mesh) -> np.ndarray:
    """(ni, nj, 4, 3): derivative of the energy at the exact shape in the direction of every function."""
    x, y, area = gauss(mesh)
    exact = np.stack(waves(x, y)[1:], axis=2)
    density = plain_gradient(exact, YOUNG, POISSON, THICKNESS) * area[..., None, None]
    along_x, along_y = mesh.axis_tables
    load = np.zeros((*mesh.shape, 4, 3))
    density = density.reshape(len(along_x.weight), GAUSS_POINTS, len(along_y.weight), GAUSS_POINTS, 5, 3)
    for p, (order_x, order_y) in enumerate(ORDERS):
        local = np.einsum(
            "esp,gtq,esgtk->egpqk",
            along_x.values[:, :, order_x],
            along_y.values[:, :, order_y],
            density[..., p, :],
        )
        for a in range(2):
            for b in range(2):
                part = local[:, :, 2 * a : 2 * a + 2, 2 * b : 2 * b + 2]
                nodes = load[a : a + local.shape[0], b : b + local.shape[1]]
                nodes += part.reshape(*local.shape[:2], 4, 3)
    return load


def errors(elements: int) -> tuple[float, ...]:
    """Root-mean-square errors of positions, slopes and normal curvature n . r,11 on elements x elements."""
    s = np.linspace(0.0, 1.0, elements + 1)
    mesh = Mesh(s + 0.1 * np.sin(np.pi * s), 0.8 * s)
    energy = SheetEnergy(mesh, YOUNG, POISSON, THICKNESS, load=manufactured_load(mesh))
    held = held_by_supports(mesh, EDGES)
    # supported edges have their exact shape, the clamped one also its exact slope in z
    found = minimise(energy, exact_nodes(mesh), ~held, NewtonSettings(tolerance=1e-11, iterations=20))
    assert found.outcome is Outcome.CONVERGED
    x, y, area = gauss(mesh)
    exact, places = waves(x, y), (x.ravel(), y.ravel())
    normal = np.cross(exact[1], exact[2])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    position, slope, second = (
        evaluate(mesh, found.q, *places, *order).reshape(*x.shape, 3) - exact[k]
        for order, k in (((0, 0), 0), ((1, 0), 1), ((2, 0), 3))
    )
    curvature = (normal * second).sum(axis=-1, keepdims=True)
    return tuple(float(np.sqrt((area[..., None] * part**2).sum())) for part in (position, slope, curvature))


def test_strain_and_curvature_converge_with_order_two_and_positions_with_more():
    """Two is the element's own order for the curvature; through the curved shape it carries over to the slopes, which
    alone would have three.
    """
    found = np.array([errors(elements) for elements in (4, 8, 16)])
    order = np.log2(found[:-1] / found[1:])
    print(f"errors {found.tolist()}, orders {order.tolist()}")
    position, slope, curvature = order[-1]
    assert position > 2.9 and slope > 1.9 and curvature > 1.9  # three, two and two in the limit
    assert found[-1, 0] < 1e-6  # of a sheet of size one: not the order of something else


def test_the_load_matters():
    """Without its load the sheet is elsewhere: the orders above are not those of a trivial problem."""
    mesh = Mesh(np.linspace(0.0, 1.0, 5), np.linspace(0.0, 0.8, 5))
    energy = SheetEnergy(mesh, YOUNG, POISSON, THICKNESS)
    held = held_by_supports(mesh, EDGES)
    found = minimise(energy, exact_nodes(mesh), ~held, NewtonSettings())
    assert np.abs(found.q - exact_nodes(mesh))[:, :, 0].max() > 1e-2
