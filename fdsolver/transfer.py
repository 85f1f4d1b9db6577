"""Interpolation of nodal fields between two meshes of one shape, in the logical coordinates (xi, eta).

The map (xi, eta) -> u of a shape is the same at every node count (`fdsolver.meshes`), so a field that is
smooth on the sheet is smooth in (xi, eta), but for kinks along the rows `Grid.breaks`: there the splines are
only continuous.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from fdsolver.grid import Grid, GridError

# Rows are multiples of 1/ni; a break that is off by more than rounding lies on none.
ROUNDING = 1e-12


def prolong(field: np.ndarray, coarse: Grid, fine: Grid) -> np.ndarray:
    """Values at the nodes of `fine` of a field given at the nodes of `coarse`.

    field : (ni, nj, ...) float64 on `coarse`. Interpolate displacements, r - u, rather than positions.
    coarse, fine : meshes of the same shape, sizes and bias; `fine` may also be the coarser one.

    Returns (fine.ni, fine.nj, ...) float64: tensor products of cubic splines (error of fourth order),
    periodic in xi on closed meshes, cut at `breaks`. Constants are exact, and so are cubics where the spline
    is not periodic.
    Raises GridError if the meshes differ in shape, closedness or breaks, or the field does not fit `coarse`.
    """
    if (coarse.shape, coarse.closed, coarse.breaks) != (fine.shape, fine.closed, fine.breaks):
        raise GridError(
            f"a field on a mesh of shape {coarse.shape} (breaks {coarse.breaks}) cannot go to one of"
            f" shape {fine.shape} (breaks {fine.breaks})"
        )
    if field.shape[:2] != (coarse.ni, coarse.nj):
        raise GridError(
            f"the field has the shape {field.shape}; its mesh has {coarse.ni} x {coarse.nj} nodes"
        )
    along_eta = CubicSpline(coarse.eta, field, axis=1)(fine.eta)
    if not coarse.closed:
        return _pieces(coarse.xi, along_eta, coarse.breaks, fine.xi)
    if not coarse.breaks:
        periodic = CubicSpline(*_closed(coarse.xi, along_eta), bc_type="periodic")
        return periodic(fine.xi)
    # One turn from the first break to its repetition, so that no piece runs across the seam of xi.
    first = coarse.breaks[0]
    start = _row_of(first, coarse.xi)
    turned = np.concatenate([coarse.xi[start:], coarse.xi[:start] + 1.0])
    xi, values = _closed(turned, np.roll(along_eta, -start, axis=0))
    places = np.where(fine.xi < first - ROUNDING, fine.xi + 1.0, fine.xi)
    return _pieces(xi, values, coarse.breaks[1:], places)


def _closed(xi: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows with the first one repeated a full turn later."""
    return np.append(xi, xi[0] + 1.0), np.concatenate([values, values[:1]])


def _pieces(xi: np.ndarray, values: np.ndarray, breaks: tuple[float, ...], places: np.ndarray) -> np.ndarray:
    """Not-a-knot cubic splines along the first axis, one between each two of the ends and `breaks`."""
    rows = [0, *(_row_of(value, xi) for value in breaks), len(xi) - 1]
    result = np.empty((len(places), *values.shape[1:]))
    for low, high in zip(rows[:-1], rows[1:], strict=True):
        inside = (places >= xi[low] - ROUNDING) & (places <= xi[high] + ROUNDING)
        part = slice(low, high + 1)
        result[inside] = CubicSpline(xi[part], values[part])(places[inside])
    return result


def _row_of(value: float, xi: np.ndarray) -> int:
    row = int(np.abs(xi - value).argmin())
    if abs(xi[row] - value) > ROUNDING:
        raise GridError(f"the mesh has no row of nodes at its break xi = {value}")
    return row
