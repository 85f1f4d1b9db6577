"""Cholesky factors of tangents: one dense matrix for each part of a nested dissection (Duff and Reid 1983).

The elimination of a part leaves a dense matrix on the ring round it, which is added to the next larger part. Almost all
work is dense matrix products, several times faster than eliminating entry by entry. A Cholesky factor exists if and
only if the matrix is positive definite.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.linalg.blas import dsyrk, dtrsm, dtrsv
from scipy.linalg.lapack import dpotrf

from fdsolver.dissection import Ordering
from fdsolver.rows import compiled
from fdsolver.tangent import Tangent


class NotPositiveDefinite(ArithmeticError):
    """The matrix has a zero or a negative eigenvalue, or one so small that rounding hides it."""


class Cholesky:
    """The factor of a tangent over the free nodes of a mesh; raises NotPositiveDefinite where there is none.

    matrix : see `Tangent`. ordering : of the same mesh and reach. shift : part of every diagonal entry added to it.
    """

    def __init__(self, matrix: Tangent, ordering: Ordering, shift: float = 0.0) -> None:
        self.ordering, self.axes = ordering, matrix.values.shape[-1]
        self.places = list(_places(ordering))
        self.factors: list[tuple[np.ndarray, np.ndarray]] = []
        left: dict[int, np.ndarray] = {}
        local = np.full(ordering.rank.size, -1)
        for index, part in enumerate(ordering.parts):
            pivots, ring = self.axes * part.pivots, self.axes * (part.nodes.size - part.pivots)
            a, b, c = (
                np.zeros(shape, order="F") for shape in ((pivots, pivots), (ring, pivots), (ring, ring))
            )
            local[part.nodes] = np.arange(part.nodes.size)
            _gather(a, b, matrix.values, matrix.closed, part.nodes, part.pivots, local, shift)
            for child in part.children:
                inner = ordering.parts[child]
                _add(a, b, c, local[inner.nodes[inner.pivots :]], self.axes, left.pop(child))
            local[part.nodes] = -1
            left[index] = self._eliminate(a, b, c)

    def _eliminate(self, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """Keep the factor of a part; returns the matrix that is left on its ring, lower triangle."""
        if a.size:
            a, info = dpotrf(a, lower=1, clean=0, overwrite_a=1)
            if info:
                raise NotPositiveDefinite
        if b.size:
            b = dtrsm(1.0, a, b, side=1, lower=1, trans_a=1, overwrite_b=1)
            c = dsyrk(-1.0, b, beta=1.0, c=c, lower=1, overwrite_c=1)
        self.factors.append((a, b))
        return c

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x of A x = right, both (axes, ni, nj) float64; zero at fixed nodes."""
        rank, free = self.ordering.rank, self.ordering.rank >= 0
        x = np.empty((int(free.sum()), self.axes))
        flat = right.reshape(self.axes, -1)
        x[rank[free]] = flat[:, free].T
        for (own, ring), (a, b) in zip(self.places, self.factors, strict=True):
            if own.start < own.stop:
                y = dtrsv(a, x[own].ravel(), lower=1, overwrite_x=1)
                x[own] = y.reshape(-1, self.axes)
                x[ring] -= (b @ y).reshape(-1, self.axes)
        for (own, ring), (a, b) in zip(self.places[::-1], self.factors[::-1], strict=True):
            if own.start < own.stop:
                y = x[own].ravel() - x[ring].ravel() @ b
                x[own] = dtrsv(a, y, lower=1, trans=1, overwrite_x=1).reshape(-1, self.axes)
        result = np.zeros_like(flat)
        result[:, free] = x[rank[free]].T
        return result.reshape(right.shape)


def _places(ordering: Ordering) -> Iterator[tuple[slice, np.ndarray]]:
    """For each part the ranks of its own nodes and of its ring."""
    start = 0
    for part in ordering.parts:
        yield slice(start, start + part.pivots), ordering.rank[part.nodes[part.pivots :]]
        start += part.pivots


@compiled
def _gather(a, b, values, closed, nodes, pivots, local, shift):
    """Write the entries of a part's own columns into its matrix, lower triangle, raising the diagonal."""
    ni, nj, width, _, axes, _ = values.shape
    reach = width // 2
    for column in range(pivots):
        i, j = nodes[column] // nj, nodes[column] % nj
        for k in range(width):
            for m in range(width):
                i2, j2 = i + k - reach, j + m - reach
                if closed:
                    i2 = i2 % ni
                if i2 < 0 or i2 >= ni or j2 < 0 or j2 >= nj:
                    continue
                row = local[i2 * nj + j2]
                if row < column:
                    continue  # fixed, eliminated before, or the upper triangle
                for first in range(axes):
                    for second in range(axes):
                        value = values[i, j, k, m, second, first]
                        if row >= pivots:
                            b[axes * (row - pivots) + first, axes * column + second] = value
                        elif row > column or first >= second:
                            a[axes * row + first, axes * column + second] = value
        for first in range(axes):
            a[axes * column + first, axes * column + first] *= 1.0 + shift


@compiled
def _add(a, b, c, places, axes, update):
    """Add what a child left, lower triangle, at the places of its nodes in this part."""
    pivots = a.shape[0]
    for k in range(update.shape[0]):
        to = axes * places[k // axes] + k % axes
        for m in range(k, update.shape[0]):
            row = axes * places[m // axes] + m % axes
            if row < pivots:
                a[row, to] += update[m, k]
            elif to < pivots:
                b[row - pivots, to] += update[m, k]
            else:
                c[row - pivots, to - pivots] += update[m, k]
