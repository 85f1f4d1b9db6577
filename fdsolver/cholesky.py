"""Cholesky factors of tangents: one dense matrix for each part of a nested dissection (Duff and Reid 1983).

The elimination of a part leaves a dense matrix on the ring round it, which is added to the next larger part. Almost all
work is dense matrix products, several times faster than eliminating entry by entry. A Cholesky factor exists if and
only if the matrix is positive definite.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg.blas import dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf

from fdsolver.dissection import Ordering
from fdsolver.rows import compiled
from fdsolver.tangent import Tangent


class NotPositiveDefinite(ArithmeticError):
    """The matrix has a zero or a negative eigenvalue, or one so small that rounding hides it."""


class Pattern:
    """Where the numbers of a matrix go in its factor: the same for every matrix of one mesh, so it is made once.

    ordering : nested dissection of the free nodes. closed : the first mesh direction is a ring. axes : unknowns a node.

    begins, own, rings : (parts + 1,) where the parts begin: in the factor's entries, column after column; in the
    unknowns; in `ring`, the unknowns of all rings one after the other. source, target : places of the matrix' numbers
    in `Tangent.values` and in the entries. diagonal : places of its diagonal in the entries.
    inner : for each part, where its ring lies in the part that it joins.
    """

    def __init__(self, ordering: Ordering, closed: bool, axes: int) -> None:
        self.ordering, self.axes = ordering, axes
        pivots = axes * np.array([part.pivots for part in ordering.parts])
        sizes = axes * np.array([part.nodes.size for part in ordering.parts])
        self.begins, self.own, self.rings = (
            np.concatenate([[0], np.cumsum(count)]) for count in (pivots * sizes, pivots, sizes - pivots)
        )
        nodes = np.concatenate([part.nodes[part.pivots :] for part in ordering.parts])
        self.ring = _unknowns(ordering.rank[nodes], axes)
        self.diagonal = np.concatenate(
            [begin + np.arange(n) * (n + 1) for begin, n in zip(self.begins[:-1], pivots, strict=True)]
        )
        self.inner = [np.empty(0, dtype=np.int64)] * len(ordering.parts)
        self._trace(closed)

    def _trace(self, closed: bool) -> None:
        """Find source, target and inner."""
        ordering, axes = self.ordering, self.axes
        width = 2 * ordering.reach + 1
        shape = (*ordering.shape, width, width, axes, axes)
        # what every number of a matrix would leave if it were its own place, counted from one
        numbers = 1.0 + np.arange(np.prod(shape)).reshape(shape)
        entries, local = np.zeros(self.begins[-1]), np.full(ordering.rank.size, -1)
        for index, part in enumerate(ordering.parts):
            a, b = self.columns(entries, index)
            local[part.nodes] = np.arange(part.nodes.size)
            _gather(a, b, numbers, closed, part.nodes, part.pivots, local)
            for child in part.children:
                joined = ordering.parts[child]
                self.inner[child] = _unknowns(local[joined.nodes[joined.pivots :]], axes)
            local[part.nodes] = -1
        self.target = np.flatnonzero(entries)
        self.source = entries[self.target].astype(np.int64) - 1

    def columns(self, entries: np.ndarray, index: int) -> tuple[np.ndarray, np.ndarray]:
        """The columns that a part eliminates: their rows in the part itself, and those in its ring."""
        n, ring = self.own[index + 1] - self.own[index], self.rings[index + 1] - self.rings[index]
        begin, end = self.begins[index], self.begins[index + 1]
        middle = begin + n * n
        square = entries[begin:middle].reshape((n, n), order="F")
        return square, entries[middle:end].reshape((ring, n), order="F")


def _unknowns(nodes: np.ndarray, axes: int) -> np.ndarray:
    return (axes * nodes[:, None] + np.arange(axes)).ravel()


class Cholesky:
    """The factor of a tangent over the free nodes of a mesh; raises NotPositiveDefinite where there is none.

    matrix : see `Tangent`. pattern : of the same mesh and reach. shift : part of every diagonal entry added to it.
    """

    def __init__(self, matrix: Tangent, pattern: Pattern, shift: float = 0.0) -> None:
        self.pattern = pattern
        self.entries = np.zeros(pattern.begins[-1])
        self.entries[pattern.target] = matrix.values.reshape(-1)[pattern.source]
        self.entries[pattern.diagonal] *= 1.0 + shift
        left: dict[int, np.ndarray] = {}
        for index, part in enumerate(pattern.ordering.parts):
            a, b = pattern.columns(self.entries, index)
            c = np.zeros((len(b), len(b)), order="F")
            for child in part.children:
                _add(a, b, c, pattern.inner[child], left.pop(child))
            left[index] = _eliminate(a, b, c)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x of A x = right, both (axes, ni, nj) float64; zero at fixed nodes."""
        pattern, rank = self.pattern, self.pattern.ordering.rank
        free = rank >= 0
        x = np.empty((int(free.sum()), pattern.axes))
        flat = right.reshape(pattern.axes, -1)
        x[rank[free]] = flat[:, free].T
        place = pattern.begins, pattern.own, pattern.rings, pattern.ring
        _substitute(self.entries, *place, x.reshape(-1))
        result = np.zeros_like(flat)
        result[:, free] = x[rank[free]].T
        return result.reshape(right.shape)


def _eliminate(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Turn the columns a, b of a part into its factor; returns the matrix left on its ring, lower triangle."""
    if a.size:
        _, info = dpotrf(a, lower=1, clean=0, overwrite_a=1)
        if info:
            raise NotPositiveDefinite
    if b.size:
        dtrsm(1.0, a, b, side=1, lower=1, trans_a=1, overwrite_b=1)
        dsyrk(-1.0, b, beta=1.0, c=c, lower=1, overwrite_c=1)
    return c


@compiled
def _substitute(entries, begins, own, rings, ring, x):
    """Solve with the factor and then with its transpose, in place."""
    parts = own.size - 1
    t = np.zeros(np.max(rings[1:] - rings[:-1]) if parts else 0)
    for part in range(parts):
        first, pivots, count = own[part], own[part + 1] - own[part], rings[part + 1] - rings[part]
        t[:count] = 0.0
        for k in range(pivots):
            y = x[first + k] / entries[begins[part] + k * pivots + k]
            x[first + k] = y
            column = entries[begins[part] + k * pivots : begins[part] + (k + 1) * pivots]
            for m in range(k + 1, pivots):
                x[first + m] -= column[m] * y
            start = begins[part] + pivots * pivots + k * count
            below = entries[start : start + count]
            for m in range(count):
                t[m] += below[m] * y
        for m in range(count):
            x[ring[rings[part] + m]] -= t[m]
    for part in range(parts - 1, -1, -1):
        first, pivots, count = own[part], own[part + 1] - own[part], rings[part + 1] - rings[part]
        for m in range(count):
            t[m] = x[ring[rings[part] + m]]
        for k in range(pivots - 1, -1, -1):
            y = x[first + k]
            column = entries[begins[part] + k * pivots : begins[part] + (k + 1) * pivots]
            for m in range(k + 1, pivots):
                y -= column[m] * x[first + m]
            start = begins[part] + pivots * pivots + k * count
            below = entries[start : start + count]
            for m in range(count):
                y -= below[m] * t[m]
            x[first + k] = y / column[k]


@compiled
def _gather(a, b, values, closed, nodes, pivots, local):
    """Write the entries of a part's own columns into its matrix, lower triangle."""
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


@compiled
def _add(a, b, c, places, update):
    """Add what a child left, lower triangle, at the places of its unknowns in this part."""
    pivots = a.shape[0]
    for k in range(update.shape[0]):
        to = places[k]
        for m in range(k, update.shape[0]):
            row = places[m]
            if row < pivots:
                a[row, to] += update[m, k]
            elif to < pivots:
                b[row - pivots, to] += update[m, k]
            else:
                c[row - pivots, to - pivots] += update[m, k]
