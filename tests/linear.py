"""Small deflections and displacements of the flat sheet: the kernels' stiffness matrix, loads and solutions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu

from fdsolver.effects import build_force
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import Model

REACH = 2  # a node's force depends on nodes at most two mesh lines away
STEP = 1e-7  # scaled displacement: relative error its square, rounding 1e-16 / 1e-7


def stiffness(
    grid: Grid, sheet: Sheet, model: Model, supports: Mapping[str, str], axes: tuple[int, ...]
) -> csc_matrix:
    """-df/dr of the flat sheet for the given axes, sparse, scaled; unknowns in the order (axis, i, j).

    Nodes so far apart that no force depends on two of them are displaced together.
    """
    force = build_force(grid, sheet, model, supports)
    flat = np.zeros((3, grid.ni, grid.nj))
    flat[:2] = np.moveaxis(grid.u / grid.length_mm, -1, 0)
    up, down = np.empty_like(flat), np.empty_like(flat)
    number = np.arange(len(axes) * grid.nodes).reshape(len(axes), grid.ni, grid.nj)
    rows, columns, values = [], [], []
    for group in _independent_nodes(grid):
        owner = _owners(grid, group)
        touched = owner >= 0
        for column, axis in enumerate(axes):
            for moved, sign in ((up, 1.0), (down, -1.0)):
                r = flat.copy()
                r[axis, group] += sign * STEP
                force(r, moved)
            for row, along in enumerate(axes):
                values.append((down - up)[along][touched] / (2 * STEP))
                rows.append(number[row][touched])
                columns.append(number[column].ravel()[owner[touched]])
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return coo_matrix(entries, (number.size, number.size)).tocsc()


def _independent_nodes(grid: Grid) -> Iterator[np.ndarray]:
    """Masks (ni, nj) of nodes, any two of which are more than twice the reach apart along a direction."""
    period = 2 * REACH + 1
    whole = grid.ni - grid.ni % period if grid.closed else grid.ni
    rows = [np.arange(start, whole, period) for start in range(period)]
    rows += [np.array([row]) for row in range(whole, grid.ni)]  # what is left over of a closed direction
    for row in rows:
        for start in range(period):
            mask = np.zeros((grid.ni, grid.nj), dtype=bool)
            mask[np.ix_(row, np.arange(start, grid.nj, period))] = True
            yield mask


def _owners(grid: Grid, group: np.ndarray) -> np.ndarray:
    """Flat index of the node of the group within reach of each node, or -1, (ni, nj)."""
    owner = np.full((grid.ni, grid.nj), -1)
    for i, j in np.argwhere(group):
        near = np.arange(i - REACH, i + REACH + 1)
        near = near % grid.ni if grid.closed else near[(near >= 0) & (near < grid.ni)]
        owner[near, max(j - REACH, 0) : j + REACH + 1] = i * grid.nj + j
    return owner


def solve(matrix: csc_matrix, load: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Displacements under nodal loads (..., ni, nj), zero at the fixed nodes (ni, nj)."""
    free = ~np.broadcast_to(fixed, load.shape).ravel()
    result = np.zeros(load.size)
    result[free] = splu(matrix[free][:, free].tocsc()).solve(load.ravel()[free])
    return result.reshape(load.shape)


def edge_nodes(grid: Grid, names: tuple[str, ...]) -> np.ndarray:
    """(ni, nj) bool: the nodes of the named edges."""
    mask = np.zeros((grid.ni, grid.nj), dtype=bool)
    for name in names:
        mask[tuple(grid.edges[name].T)] = True
    return mask
