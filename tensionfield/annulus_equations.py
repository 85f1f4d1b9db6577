"""Residual and Jacobian of the collocated equilibrium of the annulus (see `annulus_collocation`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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


def lines(elements: Elements, field: Array) -> tuple[Array, Array]:
    """Return line derivatives (e, n, 4) and phi' (e, n) of the nodal `field` (e, n, 3)."""
    slope = elements.derivative(field)
    r = field[..., 0]
    line = np.stack([slope[..., 0], r * slope[..., 1], slope[..., 2], r / elements.radius], axis=-1)
    return line, slope[..., 1]


def linearised(elements: Elements, field: Array, poisson: float, branch: States) -> Linearised:
    """Return the momenta of the nodal `field` (e, n, 3), and derivatives; `branch` (e, 1) per element."""
    line, turn = lines(elements, field)
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


def newton_system(elements: Elements, field: Array, poisson: float, branch: States) -> tuple[Array, Array]:
    """Return the residual (m, 3) and its Jacobian (m, 3, m, 3) at the m distinct nodes inside the rims.

    At inner nodes of an element the residual is that of the differential equations, between elements it is
    the jump of the momenta.
    """
    terms = linearised(elements, field, poisson, branch)
    count, nodes = elements.radius.shape
    local = elements.derivative(terms.momenta)
    local[..., 0] -= terms.source
    size = count * (nodes - 1) + 1
    residual, matrix = np.zeros((size, 3)), np.zeros((size, 3, size, 3))
    identity = np.eye(nodes)
    for e in range(count):
        slope = elements.matrix(e)
        change = np.einsum("nk,ncd->nckd", identity, terms.momenta_field[e])
        change += np.einsum("nk,ncd->nckd", slope, terms.momenta_slope[e])
        jacobian = np.einsum("mn,nckd->mckd", slope, change)
        jacobian[:, 0] -= np.einsum("nk,nd->nkd", identity, terms.source_field[e])
        jacobian[:, 0] -= np.einsum("nk,nd->nkd", slope, terms.source_slope[e])
        first, last = e * (nodes - 1), (e + 1) * (nodes - 1)
        own, inner = slice(first, last + 1), slice(first + 1, last)
        residual[inner] = local[e, 1:-1]
        matrix[inner, :, own] = jacobian[1:-1]
        residual[first] -= terms.momenta[e, 0]
        matrix[first, :, own] -= change[0]
        residual[last] += terms.momenta[e, -1]
        matrix[last, :, own] += change[-1]
    return residual[1:-1], matrix[1:-1, :, 1:-1]
