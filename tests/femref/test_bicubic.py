"""The bicubic field: exact for bicubic polynomials, C1 everywhere, and the same functions as scikit-fem's element."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuadBFS, MeshQuad

from femref.bicubic import Mesh, derivative_scales, evaluate, flat, from_function, transfer

X, Y = np.array([0.0, 0.7, 1.0, 2.2]), np.array([-1.0, 0.1, 0.5])


def random_field(mesh: Mesh, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((*mesh.shape, 4, 2))


def places(mesh: Mesh, count: int = 50) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(1)
    return tuple(axis[0] + (axis[-1] - axis[0]) * random.random(count) for axis in mesh.breaks)


def test_bicubic_polynomials_are_exact_with_all_their_derivatives():
    mesh = Mesh(X, Y)
    p, q = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.3]), np.polynomial.Polynomial([0.2, 1.0, -1.0, 0.7])

    def function(x, y):
        rows = [p(x) * q(y), p(x) * q.deriv()(y), p.deriv()(x) * q(y), p.deriv()(x) * q.deriv()(y)]
        return np.stack(rows)[..., None]

    values = from_function(mesh, function)
    x, y = places(mesh)
    for i in range(3):
        for j in range(3):
            wanted = (p.deriv(i) if i else p)(x) * (q.deriv(j) if j else q)(y)
            assert evaluate(mesh, values, x, y, i, j)[:, 0] == pytest.approx(wanted, abs=1e-12)  # rounding


def test_field_and_slopes_are_continuous_across_every_line():
    mesh = Mesh(X, Y)
    values = random_field(mesh)
    x, y = places(mesh)
    step = 1e-9
    for order_x, order_y in ((0, 0), (1, 0), (0, 1), (1, 1)):
        for line in mesh.x[1:-1]:
            left, right = (
                evaluate(mesh, values, np.full_like(y, line + side * step), y, order_x, order_y)
                for side in (-1, 1)
            )
            # second derivatives of order 100 over a step of 1e-9
            assert left == pytest.approx(right, abs=1e-6)
    jump = [evaluate(mesh, values, np.full_like(y, mesh.x[1] + side * step), y, 2, 0) for side in (-1, 1)]
    assert np.abs(jump[0] - jump[1]).max() > 0.1  # only C1: otherwise this test could not fail


def test_functions_are_those_of_another_library():
    """scikit-fem's Bogner-Fox-Schmit element on the same nodal values, at its own quadrature points."""
    mesh = Mesh(X, Y)
    values = random_field(mesh)
    other = MeshQuad.init_tensor(X, Y)
    basis = Basis(other, ElementQuadBFS(), intorder=4)
    nodal = np.zeros(basis.N)
    unscaled = values / derivative_scales(mesh)[..., None]
    for vertex, (x, y) in enumerate(other.p.T):
        i, j = np.searchsorted(X, x), np.searchsorted(Y, y)
        nodal[basis.nodal_dofs[:, vertex]] = unscaled[i, j, [0, 2, 1, 3], 0]  # u, u_x, u_y, u_xy
    found = basis.interpolate(nodal)
    x, y = np.asarray(basis.global_coordinates()).reshape(2, -1)
    for theirs, order in ((np.asarray(found), (0, 0)), (found.grad[0], (1, 0)), (found.hess[0][1], (1, 1))):
        assert evaluate(mesh, values, x, y, *order)[:, 0] == pytest.approx(
            theirs.ravel(), abs=1e-10
        )  # rounding


def test_transfer_to_a_finer_mesh_is_exact():
    mesh = Mesh(X, Y)
    fine = Mesh(np.sort(np.append(X, [0.3, 1.7])), np.sort(np.append(Y, 0.3)))
    values = random_field(mesh)
    x, y = places(mesh)
    there = evaluate(fine, transfer(mesh, values, fine), x, y)
    assert there == pytest.approx(evaluate(mesh, values, x, y), abs=1e-12)  # rounding


def test_closed_meshes_join_smoothly():
    mesh = Mesh(np.array([0.0, 1.0, 2.5, 4.0]), Y + 3.0, polar=True)
    values = random_field(mesh)
    y = np.linspace(2.0, 3.5, 7)
    for order in (0, 1):
        start = evaluate(mesh, values, np.zeros(7), y, order)
        end = evaluate(mesh, values, np.full(7, 2.0 * np.pi), y, order)
        assert end == pytest.approx(start, abs=1e-12)  # rounding


def test_a_ring_is_round_to_fourth_order():
    errors = []
    for count in (16, 32):
        mesh = Mesh(2.0 * np.pi * np.arange(count) / count, np.array([1.0, 2.0]), polar=True)
        angle = np.linspace(0.0, 2.0 * np.pi, 501)
        radius = np.linalg.norm(evaluate(mesh, flat(mesh), angle, np.full(501, 2.0))[:, :2], axis=1)
        errors.append(np.abs(radius - 2.0).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)  # cubic Hermite interpolation


@pytest.mark.parametrize("x", [[0.0], [0.0, 0.0], [1.0, 0.0], [0.0, np.nan]])
def test_axes_that_do_not_rise_are_refused(x):
    with pytest.raises(ValueError, match="x must be at least two finite, rising numbers"):
        Mesh(np.array(x), Y)


def test_places_outside_are_refused():
    mesh = Mesh(X, Y)
    with pytest.raises(ValueError, match="outside the mesh"):
        evaluate(mesh, random_field(mesh), np.array([2.3]), np.array([0.0]))
