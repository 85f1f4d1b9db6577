"""Residual and Jacobian of the collocated equilibrium of the annulus (see `annulus_collocation`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from tensionfield.annulus_chebyshev import Elements
from tensionfield.annulus_energy import Array, States, force_and_tangent


@dataclass(frozen=True)
class Linearised:
    """Momenta and right side at the nodes, and their derivatives.

    momenta : (e, n, 3) p, G, Q;  source : (e, n) right side of the equation for p'.
    momenta_field, momenta_slope : (e, n, 3, 3) derivatives with respect to r, phi, z and to r', phi', z'.
    source_field, source_slope : (e, n, 3) the same of the right side.
    """

    momenta: Array
    source: Array
    momenta_field: Array
    momenta_slope: Array
    source_field: Array
    source_slope: Array


def lines(elements: Elements, field: Array, slope: Array) -> Array:
    """Return line derivatives (e, n, 4) of the nodal `field` and its derivative `slope`, both (e, n, 3)."""
    r = field[..., 0]
    return np.stack([slope[..., 0], r * slope[..., 1], slope[..., 2], r / elements.radius], axis=-1)


def linearised(elements: Elements, field: Array, slope: Array, poisson: float, branch: States) -> Linearised:
    """Return momenta and derivatives of the nodal `field` and `slope` (e, n, 3) on each `branch` (e, 1)."""
    line, turn = lines(elements, field, slope), slope[..., 1]
    force, tangent = force_and_tangent(line, poisson, branch)
    radius, r = elements.radius, field[..., 0]
    by_field = np.zeros((*r.shape, 4, 3))  # of the line derivatives
    by_slope = np.zeros((*r.shape, 4, 3))
    by_field[..., 1, 0], by_field[..., 3, 0] = turn, 1.0 / radius
    by_slope[..., 0, 0], by_slope[..., 1, 1], by_slope[..., 2, 2] = 1.0, r, 1.0
    force_field, force_slope = tangent @ by_field, tangent @ by_slope
    weight = np.stack([radius, radius * r, radius], axis=-1)
    momenta_field = weight[..., None] * force_field[..., :3, :]
    momenta_field[..., 1, 0] += radius * force[..., 1]
    source_slope = (radius * turn)[..., None] * force_slope[..., 1, :] + force_slope[..., 3, :]
    source_slope[..., 1] += radius * force[..., 1]
    return Linearised(
        momenta=weight * force[..., :3],
        source=radius * force[..., 1] * turn + force[..., 3],
        momenta_field=momenta_field,
        momenta_slope=weight[..., None] * force_slope[..., :3, :],
        source_field=(radius * turn)[..., None] * force_field[..., 1, :] + force_field[..., 3, :],
        source_slope=source_slope,
    )


def newton_step(elements: Elements, field: Array, slope: Array, poisson: float, branch: States) -> Array:
    """Return Newton's step (m, 3) at the m distinct nodes, zero at both rims.

    At inner nodes of an element the residual is that of the differential equations, between elements it is
    the jump of the momenta.

    Raises LinAlgError if the Jacobian is singular.
    """
    terms = linearised(elements, field, slope, poisson, branch)
    count, nodes = elements.radius.shape
    local = elements.derivative(terms.momenta)
    local[..., 0] -= terms.source
    size, width = 3 * (count * (nodes - 1) + 1), 3 * nodes - 1
    residual, band = np.zeros(size), np.zeros((2 * width + 1, size))
    row, column = np.indices((3 * nodes, 3 * nodes))
    for e in range(count):
        block, first = _element_jacobian(elements.matrix(e), terms, e), 3 * e * (nodes - 1)
        band[width + row - column, first + column] += block.reshape(3 * nodes, 3 * nodes)
        own = np.concatenate([-terms.momenta[e, :1], local[e, 1:-1], terms.momenta[e, -1:]])
        residual[first : first + 3 * nodes] += own.ravel()
    for rim in (slice(0, 3), slice(size - 3, size)):  # the rows of the rims say that their step is zero
        index = np.arange(size)[rim]
        offset, other = np.indices((2 * width + 1, size))
        band[np.isin(offset + other - width, index)] = 0.0
        band[width, index], residual[index] = 1.0, 0.0
    return np.asarray(solve_banded((width, width), band, -residual), dtype=np.float64).reshape(-1, 3)


def _element_jacobian(to_slope: Array, terms: Linearised, e: int) -> Array:
    """Return the derivative (n, 3, n, 3) of one element's part of the residual by its nodal field.

    to_slope : (n, n) derivative matrix of the element.
    """
    identity = np.eye(to_slope.shape[0])
    change = np.einsum("nk,ncd->nckd", identity, terms.momenta_field[e])
    change += np.einsum("nk,ncd->nckd", to_slope, terms.momenta_slope[e])
    jacobian = np.einsum("mn,nckd->mckd", to_slope, change)
    jacobian[:, 0] -= np.einsum("nk,nd->nkd", identity, terms.source_field[e])
    jacobian[:, 0] -= np.einsum("nk,nd->nkd", to_slope, terms.source_slope[e])
    jacobian[0], jacobian[-1] = -change[0], change[-1]
    return jacobian
