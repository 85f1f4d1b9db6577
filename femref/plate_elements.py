"""Plate elements as scikit-fem elements: Argyris and Morley triangles, Bogner-Fox-Schmit rectangles.

Each cell has its own centred and scaled coordinates. Monomials about the origin of the mesh lose as many digits as the
cell is small beside its distance from there to the fifth power: a shifted square then buckles at another load.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from skfem import Mesh
from skfem.element import DiscreteField, Element
from skfem.refdom import RefQuad, RefTri

Derivative = tuple[int, int]


def _falling(power: int, order: int) -> int:
    """Coefficient of the derivative of this order of a power: power (power - 1) ..."""
    return int(np.prod([power - k for k in range(order)])) if order else 1


class PlateElement(Element):
    """Polynomials given by derivatives at the vertices and, on triangles, the normal slope at mid-facets.

    vertex_derivatives : orders in (x, y) of the values that a vertex carries, in mesh coordinates.
    exponents : powers (a, b) of the monomials that span a cell's polynomials.
    normal_slope : whether a facet carries the derivative along its normal, which `facet_normals` directs.
    """

    vertex_derivatives: tuple[Derivative, ...] = ()
    exponents: tuple[Derivative, ...] = ()
    normal_slope = False

    def __init__(self) -> None:
        self._coefficients: np.ndarray | None = None
        self._monomials: tuple[np.ndarray, dict[Derivative, np.ndarray]] | None = None

    def gbasis(
        self, mapping: Any, X: np.ndarray, i: int, tind: np.ndarray | None = None
    ) -> tuple[DiscreteField]:
        """Value, gradient and second derivatives of one basis function at the local points X, as scikit-fem asks."""
        mesh = mapping.mesh
        cells = np.arange(mesh.nelements) if tind is None else tind
        if self._coefficients is None:
            self._coefficients = self._inverse_vandermonde(mesh)
        if self._monomials is None or self._monomials[0] is not X:
            self._monomials = X, self._local_monomials(mapping, X, cells)
        powers, coefficients = self._monomials[1], self._coefficients[cells, :, i]

        def derivative(a: int, b: int) -> np.ndarray:
            return np.einsum("cm,mcq->cq", coefficients, powers[a, b])

        gradient = np.stack([derivative(1, 0), derivative(0, 1)])
        mixed = derivative(1, 1)
        hessian = np.stack([np.stack([derivative(2, 0), mixed]), np.stack([mixed, derivative(0, 2)])])
        return (DiscreteField(value=derivative(0, 0), grad=gradient, hess=hessian),)

    def _local_monomials(
        self, mapping: Any, X: np.ndarray, cells: np.ndarray
    ) -> dict[Derivative, np.ndarray]:
        """Derivatives in mesh coordinates of all monomials at the points, each (monomials, cells, points)."""
        centre, size = local_frames(mapping.mesh)
        points = mapping.F(X, tind=cells) - centre[:, cells, None]
        local = points / size[cells, None]
        orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
        return {order: self._evaluate(order, *local) / size[cells, None] ** sum(order) for order in orders}

    def _evaluate(self, order: Derivative, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """(monomials, ...) derivatives in local coordinates."""
        (a, b) = order
        return np.stack(
            [
                _falling(p, a) * _falling(q, b) * x ** max(p - a, 0) * y ** max(q - b, 0)
                for p, q in self.exponents
            ]
        )

    def _inverse_vandermonde(self, mesh: Mesh) -> np.ndarray:
        """(cells, monomials, functions): coefficients of the basis functions in each cell's local monomials."""
        centre, size = local_frames(mesh)
        vertices = (mesh.p[:, mesh.t] - centre[:, None]) / size
        rows, degrees = [], []
        for x, y in vertices.transpose(1, 0, 2):
            rows += [self._evaluate(order, x, y) for order in self.vertex_derivatives]
            degrees += [sum(order) for order in self.vertex_derivatives]
        if self.normal_slope:
            normal = facet_normals(mesh)
            middle = mesh.p[:, mesh.facets].mean(axis=1)
            for facets in mesh.t2f:
                x, y = (middle[:, facets] - centre) / size
                rows.append(
                    normal[0, facets] * self._evaluate((1, 0), x, y)
                    + normal[1, facets] * self._evaluate((0, 1), x, y)
                )
                degrees.append(1)
        # rows of the local system are of order one; a derivative in mesh coordinates is one in local ones / size^order
        vandermonde = np.stack(rows).transpose(2, 0, 1)
        return np.linalg.inv(vandermonde) * size[:, None, None] ** np.array(degrees)


def local_frames(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Centre (2, cells) and size (cells,) of every cell."""
    corners = mesh.p[:, mesh.t]
    centre = corners.mean(axis=1)
    return centre, np.linalg.norm(corners - centre[:, None], axis=0).max(axis=0)


def facet_normals(mesh: Mesh) -> np.ndarray:
    """(2, facets) unit normals, to the right of the way from a facet's first to its second vertex."""
    along = mesh.p[:, mesh.facets[1]] - mesh.p[:, mesh.facets[0]]
    return np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)


def _triangle_exponents(degree: int) -> tuple[Derivative, ...]:
    return tuple((a, b) for a in range(degree + 1) for b in range(degree + 1 - a))


class Argyris(PlateElement):
    """Complete quintics with continuous slopes (Argyris, Fried and Scharpf 1968); factors converge at order 8."""

    nodal_dofs, facet_dofs, maxdeg = 6, 1, 5
    dofnames = ["u", "u_x", "u_y", "u_xx", "u_xy", "u_yy", "u_n"]
    doflocs = np.array(
        [[0.0, 0.0]] * 6 + [[1.0, 0.0]] * 6 + [[0.0, 1.0]] * 6 + [[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]]
    )
    refdom = RefTri
    vertex_derivatives = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    exponents = _triangle_exponents(5)
    normal_slope = True


class Morley(PlateElement):
    """Quadratics, not conforming (Morley 1968); factors converge at order 2."""

    nodal_dofs, facet_dofs, maxdeg = 1, 1, 2
    dofnames = ["u", "u_n"]
    doflocs = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])
    refdom = RefTri
    vertex_derivatives = ((0, 0),)
    exponents = _triangle_exponents(2)
    normal_slope = True


class BognerFoxSchmit(PlateElement):
    """Bicubics on rectangles with continuous slopes (Bogner, Fox and Schmit 1965); factors converge at order 4."""

    nodal_dofs, maxdeg = 4, 6
    dofnames = ["u", "u_x", "u_y", "u_xy"]
    doflocs = np.array([[0.0, 0.0]] * 4 + [[1.0, 0.0]] * 4 + [[1.0, 1.0]] * 4 + [[0.0, 1.0]] * 4)
    refdom = RefQuad
    vertex_derivatives = ((0, 0), (1, 0), (0, 1), (1, 1))
    exponents = tuple((a, b) for a in range(4) for b in range(4))


ELEMENTS: dict[str, type[PlateElement]] = {
    "argyris": Argyris,
    "bogner-fox-schmit": BognerFoxSchmit,
    "morley": Morley,
}
