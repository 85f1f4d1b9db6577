"""The exact tangent stiffness -df/dr of a discrete energy, by differences of its own force.

A node's force depends on nodes a few mesh lines away. Nodes so far apart that no force depends on two of them move
together, so the number of force evaluations does not grow with the mesh (Curtis, Powell and Reid 1974).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix

from fdsolver.effects import Force
from fdsolver.rows import compiled

STEP = 1e-6  # displacement, L: curvature of the force costs its square, rounding 1e-16 over it


@dataclass(frozen=True)
class Tangent:
    """A symmetric matrix that couples each node to those at most `reach` mesh lines away.

    values : (ni, nj, width, width, axes, axes) float64 with width = 2 reach + 1. values[i, j, k, m] couples node (i, j)
    to node (i + k - reach, j + m - reach); zero where there is none.
    closed : the first mesh direction is a ring. evaluations : of the force that it took.
    """

    values: np.ndarray
    closed: bool
    evaluations: int

    @property
    def reach(self) -> int:
        """Mesh lines across which nodes are coupled."""
        return self.values.shape[2] // 2

    def matrix(self) -> csc_matrix:
        """As a sparse matrix; unknown = node * axes + axis, nodes numbered row after row of the mesh."""
        ni, nj, width, _, axes, _ = self.values.shape
        offset = np.arange(width) - self.reach
        i = np.arange(ni)[:, None, None, None] + offset[:, None]
        j = np.arange(nj)[:, None, None] + offset
        there = np.broadcast_to(
            (j >= 0) & (j < nj) & (self.closed | ((i >= 0) & (i < ni))), (ni, nj, width, width)
        )
        column = np.broadcast_to((i % ni) * nj + j, there.shape)[there]
        row = np.broadcast_to(np.arange(ni * nj).reshape(ni, nj, 1, 1), there.shape)[there]
        axis = np.arange(axes)
        rows = np.broadcast_to((axes * row)[:, None, None] + axis[:, None], (row.size, axes, axes))
        columns = np.broadcast_to((axes * column)[:, None, None] + axis, rows.shape)
        entries = self.values[there].ravel(), (rows.ravel(), columns.ravel())
        return coo_matrix(entries, (ni * nj * axes, ni * nj * axes)).tocsc()


def reach_of(force: Force) -> int:
    """Mesh lines across which two nodes act on each other: one in a membrane, two where the curvature counts."""
    return 1 if force.node is None else 2


def tangent(force: Force, r: np.ndarray, axes: Sequence[int], step: float = STEP) -> Tangent:
    """The tangent for displacements along some axes, by central differences, over all nodes of the mesh.

    r : (components, ni, nj) float64, scaled. axes : of its first dimension. step : displacement, L.
    """
    ni, nj = r.shape[1:]
    reach = reach_of(force)
    values = np.zeros((ni, nj, 2 * reach + 1, 2 * reach + 1, len(axes), len(axes)))
    place, up, down = r.copy(), np.empty_like(r), np.empty_like(r)
    chosen, evaluations = np.asarray(axes), 0
    for owner_i in _owners(ni, reach, force.closed):
        for owner_j in _owners(nj, reach, False):
            group = np.ix_(owner_i == np.arange(ni), owner_j == np.arange(nj))
            for column, axis in enumerate(axes):
                for f, sign in ((up, 1.0), (down, -1.0)):
                    place[axis][group] = r[axis][group] + sign * step
                    force(place, f)
                place[axis][group] = r[axis][group]
                _collect(values, up, down, 0.5 / step, owner_i, owner_j, chosen, column, force.closed)
                evaluations += 2
    _symmetrise(values, force.closed)
    return Tangent(values, force.closed, evaluations)


def _owners(count: int, reach: int, closed: bool) -> Iterator[np.ndarray]:
    """For each group of lines that may move together: (count,) the line of the group within reach of a line, or -1."""
    period = 2 * reach + 1
    whole = count - count % period if closed else count
    groups = [np.arange(first, whole, period) for first in range(min(period, whole))]
    groups += [np.array([line]) for line in range(whole, count)]  # what is left over of a closed direction
    for group in groups:
        owner = np.full(count, -1)
        for shift in range(-reach, reach + 1):
            near = (group + shift) % count if closed else group + shift
            inside = (near >= 0) & (near < count)
            owner[near[inside]] = group[inside]
        yield owner


@compiled
def _collect(values, up, down, scale, owner_i, owner_j, axes, column, closed):
    """Put the change of all forces into the entries of the moved node within reach of each."""
    ni, nj, width = values.shape[:3]
    reach = width // 2
    for i in range(ni):
        if owner_i[i] < 0:
            continue
        k = owner_i[i] - i + reach
        if closed:
            k = k % ni
        for j in range(nj):
            if owner_j[j] >= 0:
                m = owner_j[j] - j + reach
                for row in range(axes.size):
                    axis = axes[row]
                    values[i, j, k, m, row, column] = scale * (down[axis, i, j] - up[axis, i, j])


@compiled
def _symmetrise(values, closed):
    """Replace every two entries that symmetry makes equal by their mean."""
    ni, nj, width, _, axes, _ = values.shape
    reach = width // 2
    for i in range(ni):
        for j in range(nj):
            for k in range(width):
                for m in range(width):
                    i2, j2 = i + k - reach, j + m - reach
                    if closed:
                        i2 = i2 % ni
                    if 0 <= i2 < ni and 0 <= j2 < nj:
                        for a in range(axes):
                            for b in range(axes):
                                one = values[i, j, k, m, a, b]
                                other = values[i2, j2, width - 1 - k, width - 1 - m, b, a]
                                mean = 0.5 * (one + other)
                                values[i, j, k, m, a, b] = mean
                                values[i2, j2, width - 1 - k, width - 1 - m, b, a] = mean
