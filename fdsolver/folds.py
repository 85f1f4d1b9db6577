"""Folds of a deformed mesh: where the normal of the sheet turns over from one zone to the next.

A relaxed membrane has folds that belong to its least energy. Write the deformation gradient of a wrinkled zone as
F = l m (x) M + s n (x) N, with the tension l m (x) M and the width s across the wrinkles. Energy and stress know l m
and M alone, and no orientation of the surface: a sheet in space can be turned over. The tension lines are straight, so
their geometry decides about s, and where they touch an envelope s passes through zero: the pleats lie wholly upon each
other, and beyond the envelope the mean surface lies the other way up. The flat annulus turned by 45 degrees does so in
its closed form: the lines leave the hub inwards, and touch a circle of 62.0 mm before they go outwards.

There F has rank one, and the fold line, of direction t in the reference, is stretched by |F t| = l |M . t|. That tells
such a fold from a place at which the sheet runs together to a point: there the line itself lies across the tension,
M . t = 0, and no longer has a length. It also tells it from a fold against the tension, which no force would hold.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from fdsolver.fields import WRINKLED
from fdsolver.grid import Grid
from fdsolver.result import ZoneFields

AXES = (0, 1)  # mesh lines i = const, between zone rows, and j = const, between zone columns


def turned_over(grid: Grid, r: np.ndarray) -> np.ndarray:
    """Zones of a planar state that lie upside down: their area has the other sign than in the reference.

    r : (ni, nj, 3) float64, mm. Returns (zone rows, nj - 1) bool.
    """
    return _area_normals(grid, r)[..., 2] * _area_normals(grid, _in_space(grid))[..., 2] < 0.0


def folded_zones(grid: Grid, r: np.ndarray) -> np.ndarray:
    """Zones whose normal is turned by more than 90 degrees against that of a zone beside them.

    r : (ni, nj, 3) float64, mm. Returns (zone rows, nj - 1) bool.
    """
    return _beside(grid, [_folds(grid, r, axis) for axis in AXES])


def folded_against_tension(grid: Grid, r: np.ndarray, zone: ZoneFields) -> np.ndarray:
    """Zones of a relaxed membrane at folds that are none of its tension field's own.

    A fold is its own between two wrinkled zones if the line is stretched by more than the sum of their widths s. Their
    F t differ from that of the line by no more than the width changes from one to the other; so the line has a share
    along the tension, which a line that runs together to a point or lies across the tension has not.
    r : (ni, nj, 3) float64, mm. Returns (zone rows, nj - 1) bool.
    """
    strange = []
    for axis in AXES:
        before, after = _sides(grid, zone.state, axis)
        wrinkled = (before == WRINKLED) & (after == WRINKLED)
        widths = np.sum(_sides(grid, zone.stretch_minor, axis), axis=0)
        stretch = _lengths(grid, r, axis) / _lengths(grid, _in_space(grid), axis)
        strange.append(_folds(grid, r, axis) & ~(wrinkled & (stretch > widths)))
    return _beside(grid, strange)


def inverted_zones(grid: Grid, r: np.ndarray, zone: ZoneFields) -> np.ndarray:
    """Zones of a planar relaxed membrane that lie upside down although no fold of its tension field leads there.

    Zones that lie upside down side by side are one patch, and are right or wrong together: wrong if the patch has no
    border with zones that lie upright, as when the whole sheet is turned over, or any other fold on its border.
    r : (ni, nj, 3) float64, mm. Returns (zone rows, nj - 1) bool.
    """
    over = turned_over(grid, r)
    patch = _patches(grid, over)
    bordered = np.isin(patch, patch[over & folded_zones(grid, r)])
    broken = np.isin(patch, patch[over & folded_against_tension(grid, r, zone)])
    return over & (broken | ~bordered)


def _patches(grid: Grid, marked: np.ndarray) -> np.ndarray:
    """(zone rows, nj - 1) int: the same number for marked zones that hang together by their edges."""
    number = np.arange(marked.size).reshape(marked.shape)
    sides = [_sides(grid, number, axis) for axis in AXES]
    before, after = (np.concatenate([pair[k].ravel() for pair in sides]) for k in (0, 1))
    joined = marked.ravel()[before] & marked.ravel()[after]
    graph = coo_matrix((joined[joined], (before[joined], after[joined])), shape=(marked.size, marked.size))
    return connected_components(graph, directed=False)[1].reshape(marked.shape)


def _in_space(grid: Grid) -> np.ndarray:
    """(ni, nj, 3), mm: the reference positions."""
    return np.concatenate([grid.u, np.zeros((*grid.u.shape[:2], 1))], axis=-1)


def _area_normals(grid: Grid, r: np.ndarray) -> np.ndarray:
    """(zone rows, nj - 1, 3), mm^2: normal of every zone, twice its area long."""
    far, near = (np.roll(r, -1, axis=0), r) if grid.closed else (r[1:], r[:-1])
    return np.cross(far[:, 1:] - near[:, :-1], near[:, 1:] - far[:, :-1])


def _sides(grid: Grid, field: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """A field of zones on the two sides of every mesh edge that lies on an inner line of this axis."""
    if axis == 0:
        return (np.roll(field, 1, axis=0), field) if grid.closed else (field[:-1], field[1:])
    return field[:, :-1], field[:, 1:]


def _lengths(grid: Grid, r: np.ndarray, axis: int) -> np.ndarray:
    """Lengths, mm, of these edges."""
    if axis == 0:
        line = r if grid.closed else r[1:-1]
        return np.linalg.norm(line[:, 1:] - line[:, :-1], axis=-1)
    line = r[:, 1:-1]
    edge = np.roll(line, -1, axis=0) - line
    return np.linalg.norm(edge if grid.closed else edge[:-1], axis=-1)


def _folds(grid: Grid, r: np.ndarray, axis: int) -> np.ndarray:
    """Which of these edges are folds: the normals on their sides are more than 90 degrees apart."""
    before, after = _sides(grid, _area_normals(grid, r), axis)
    return np.sum(before * after, axis=-1) < 0.0


def _beside(grid: Grid, edges: list[np.ndarray]) -> np.ndarray:
    """The zones (zone rows, nj - 1) beside the marked edges of both axes."""
    rows, columns = edges
    beside = np.zeros((grid.ni if grid.closed else grid.ni - 1, grid.nj - 1), dtype=bool)
    beside[:, 1:] |= columns
    beside[:, :-1] |= columns
    if grid.closed:
        return beside | rows | np.roll(rows, -1, axis=0)
    beside[1:] |= rows
    beside[:-1] |= rows
    return beside
