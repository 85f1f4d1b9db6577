"""Kernels of the bicubic sheet: energy, gradient, Hessian and mass matrix, summed over elements and Gauss points.

tables : Hermite functions of the two axes (elements, points, 3, 4), their weights (elements, points), and the length of
the circle per angle at the points of the second axis (1 on Cartesian meshes). q : (ni, nj, 4, 3) nodal values. moduli :
of `femref.koiter.moduli`. places : (elements, elements, 4, 4), the block of data (blocks, 12, 12) of each pair of
element nodes.
"""

from __future__ import annotations

import numpy as np

from femref.compiled import compiled
from femref.koiter import density, density_hessian


@compiled(inline="always")
def _basis(x, y, radius, out):
    """Derivatives ,1 ,2 ,11 ,12 ,22 (rows) of the 16 functions, and the functions (last row); (6, 16).

    x, y : (3, 4) functions of the axes. Function 4 (2 a + b) + 2 k + l: node (a, b), slope along x if k, along y if l.
    Polar: ,1 is the derivative along the circle; b_ab needs no Christoffel symbols, n is normal to both tangents.
    """
    for a in range(2):
        for k in range(2):
            for b in range(2):
                for m in range(2):
                    f = 4 * (2 * a + b) + 2 * k + m
                    p, q = 2 * a + k, 2 * b + m
                    out[0, f] = x[1, p] * y[0, q] / radius
                    out[1, f] = x[0, p] * y[1, q]
                    out[2, f] = x[2, p] * y[0, q] / radius**2
                    out[3, f] = x[1, p] * y[1, q] / radius
                    out[4, f] = x[0, p] * y[2, q]
                    out[5, f] = x[0, p] * y[0, q]


@compiled(inline="always")
def _gather(q, e, g, local):
    """Nodal values (16, 3) of element (e, g)."""
    for a in range(2):
        i = e + a if e + a < q.shape[0] else 0
        for b in range(2):
            for kind in range(4):
                for k in range(3):
                    local[4 * (2 * a + b) + kind, k] = q[i, g + b, kind, k]


@compiled(inline="always")
def _derivatives(basis, local, d):
    for p in range(5):
        for k in range(3):
            d[p, k] = 0.0
        for f in range(16):
            for k in range(3):
                d[p, k] += basis[p, f] * local[f, k]


@compiled()
def energy(q, tables, moduli, membrane_only):
    """(2,) membrane and bending energy; summed by columns of elements, so that rounding stays small."""
    x, y, weight_x, weight_y, radius = tables
    basis, local = np.empty((6, 16)), np.empty((16, 3))
    d, gradient = np.empty((5, 3)), np.empty((5, 3))
    total = np.zeros(2)
    for e in range(x.shape[0]):
        column = np.zeros(2)
        for g in range(y.shape[0]):
            _gather(q, e, g, local)
            for s in range(x.shape[1]):
                for t in range(y.shape[1]):
                    _basis(x[e, s], y[g, t], radius[g, t], basis)
                    _derivatives(basis, local, d)
                    area = weight_x[e, s] * weight_y[g, t] * radius[g, t]
                    membrane, bending = density(d, moduli, membrane_only, gradient)
                    column[0] += area * membrane
                    column[1] += area * bending
        total += column
    return total


@compiled()
def add_gradient(q, tables, moduli, membrane_only, out):
    """Add the derivative of the energy by q to out (ni, nj, 4, 3)."""
    x, y, weight_x, weight_y, radius = tables
    basis, local = np.empty((6, 16)), np.empty((16, 3))
    d, gradient = np.empty((5, 3)), np.empty((5, 3))
    force = np.empty((16, 3))
    for e in range(x.shape[0]):
        for g in range(y.shape[0]):
            _gather(q, e, g, local)
            force[:] = 0.0
            for s in range(x.shape[1]):
                for t in range(y.shape[1]):
                    _basis(x[e, s], y[g, t], radius[g, t], basis)
                    _derivatives(basis, local, d)
                    density(d, moduli, membrane_only, gradient)
                    area = weight_x[e, s] * weight_y[g, t] * radius[g, t]
                    for p in range(5):
                        for f in range(16):
                            for k in range(3):
                                force[f, k] += area * basis[p, f] * gradient[p, k]
            for a in range(2):
                i = e + a if e + a < q.shape[0] else 0
                for b in range(2):
                    for kind in range(4):
                        for k in range(3):
                            out[i, g + b, kind, k] += force[4 * (2 * a + b) + kind, k]


@compiled()
def add_hessian(q, tables, moduli, membrane_only, places, data):
    """Add the second derivative of the energy by q to the node blocks."""
    x, y, weight_x, weight_y, radius = tables
    basis, local = np.empty((6, 16)), np.empty((16, 3))
    d, second = np.empty((5, 3)), np.empty((15, 15))
    half = np.empty((5, 16))
    element = np.empty((3, 3, 16, 16))  # component, component, function, function
    for e in range(x.shape[0]):
        for g in range(y.shape[0]):
            _gather(q, e, g, local)
            element[:] = 0.0
            for s in range(x.shape[1]):
                for t in range(y.shape[1]):
                    _basis(x[e, s], y[g, t], radius[g, t], basis)
                    _derivatives(basis, local, d)
                    density_hessian(d, moduli, membrane_only, second)
                    area = weight_x[e, s] * weight_y[g, t] * radius[g, t]
                    _add_outer(basis, second, area, half, element)
            _scatter(element, places[e, g], data)


@compiled(fastmath=True)
def _add_outer(basis, second, area, half, element):
    """element[k, m] += area B^T second[k, m] B for k <= m (of 5 x 5 second derivatives, 5 x 16 B)."""
    for k in range(3):
        for m in range(k, 3):
            for p in range(5):
                for f in range(16):
                    half[p, f] = 0.0
                for r in range(5):
                    factor = area * second[3 * p + k, 3 * r + m]
                    for f in range(16):
                        half[p, f] += factor * basis[r, f]
            block = element[k, m]
            for f in range(16):
                b0, b1, b2, b3, b4 = basis[0, f], basis[1, f], basis[2, f], basis[3, f], basis[4, f]
                for r in range(16):
                    block[f, r] += (
                        b0 * half[0, r]
                        + b1 * half[1, r]
                        + b2 * half[2, r]
                        + b3 * half[3, r]
                        + b4 * half[4, r]
                    )


@compiled()
def _scatter(element, places, data):
    for a in range(4):
        for b in range(4):
            block = data[places[a, b]]
            for f in range(4):
                for r in range(4):
                    for k in range(3):
                        for m in range(3):
                            if k <= m:
                                block[3 * f + k, 3 * r + m] += element[k, m, 4 * a + f, 4 * b + r]
                            else:
                                block[3 * f + k, 3 * r + m] += element[m, k, 4 * b + r, 4 * a + f]


@compiled()
def add_mass(tables, places, data):
    """Add the matrix of the integral of |r|^2 to the node blocks."""
    x, y, weight_x, weight_y, radius = tables
    basis = np.empty((6, 16))
    for e in range(x.shape[0]):
        for g in range(y.shape[0]):
            for s in range(x.shape[1]):
                for t in range(y.shape[1]):
                    _basis(x[e, s], y[g, t], radius[g, t], basis)
                    area = weight_x[e, s] * weight_y[g, t] * radius[g, t]
                    for f in range(16):
                        for r in range(16):
                            value = area * basis[5, f] * basis[5, r]
                            block = data[places[e, g, f // 4, r // 4]]
                            for k in range(3):
                                block[3 * (f % 4) + k, 3 * (r % 4) + k] += value
