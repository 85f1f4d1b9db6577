"""Response of the measured curvatures (see `fdsolver.curvature`) to quadratic fields on the flat mesh.

The fields are x^2/2, y^2/2 and x y. A small deflection f of the flat sheet tilts the normal by the slope
that fits the differences of f along the two discrete tangents, so the measured curvature is the second
difference of f less that slope times the second difference of the mesh: affine fields give nothing.
"""

from __future__ import annotations

import numpy as np


def _quadratics(v: np.ndarray) -> np.ndarray:
    """The fields x^2/2, y^2/2, x y at points v (2, ...)."""
    return np.stack([0.5 * v[0] ** 2, 0.5 * v[1] ** 2, v[0] * v[1]])


def _slope(t1: np.ndarray, t2: np.ndarray, f1: np.ndarray, f2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gradient (f,x, f,y) of fields with the differences f1 along t1 and f2 along t2."""
    area = t1[0] * t2[1] - t1[1] * t2[0]
    area = np.where(area > 0.0, area, np.nan)  # folded tangents are caught as a degenerate node
    return (f1 * t2[1] - f2 * t1[1]) / area, (f2 * t1[0] - f1 * t2[0]) / area


def _clamp(index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the next and the previous node along an open direction, clamped to the mesh."""
    return np.minimum(index + 1, index[-1]), np.maximum(index - 1, 0)


def node_steps(u: np.ndarray, closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Steps of the mesh u (2, ni, nj) from every node to its east, west, north and south neighbour; 0 past an end."""
    ni, nj = u.shape[1:]
    i, j = np.arange(ni), np.arange(nj)
    following, previous = ((i + 1) % ni, (i - 1) % ni) if closed else _clamp(i)
    above, below = _clamp(j)
    return u[:, following] - u, u[:, previous] - u, u[:, :, above] - u, u[:, :, below] - u


def node_responses(
    u: np.ndarray, closed: bool, c1: np.ndarray, c2: np.ndarray, clamped1: np.ndarray, clamped2: np.ndarray
) -> np.ndarray:
    """R at all nodes, shape (3 measured curvatures, 3 fields, ni, nj); the row of <b12> is left empty."""
    ni, nj = u.shape[1:]
    east, west, north, south = node_steps(u, closed)
    f_east, f_west, f_north, f_south = (_quadratics(v) for v in (east, west, north, south))
    factor1 = c1[:, None]
    f_x, f_y = _slope(
        factor1 * (east - west), c2 * (north - south), factor1 * (f_east - f_west), c2 * (f_north - f_south)
    )
    # A given normal is the field's own normal at the node: no slope to subtract there.
    given = clamped1 | clamped2
    f_x[:, given] = 0.0
    f_y[:, given] = 0.0
    response = np.empty((3, 3, ni, nj))
    for row, f, v, clamped in (
        (response[0], f_east + f_west, east + west, clamped1),
        (response[1], f_north + f_south, north + south, clamped2),
    ):
        row[:] = f - f_x * v[0] - f_y * v[1]
        row[:, clamped] *= 2.0  # the mirror node counts as much as the node inside
    return response


def twist_responses(u: np.ndarray, closed: bool) -> np.ndarray:
    """Response of the zones' b12 to the three fields, shape (3, zone rows, nj - 1)."""
    if closed:
        u = np.concatenate([u, u[:, :1]], axis=1)
    a = u[:, :-1, :-1]
    b, c, d = u[:, 1:, :-1] - a, u[:, 1:, 1:] - a, u[:, :-1, 1:] - a
    f_b, f_c, f_d = _quadratics(b), _quadratics(c), _quadratics(d)
    mixed = c - b - d
    f_x, f_y = _slope(0.5 * (b + c - d), 0.5 * (d + c - b), 0.5 * (f_b + f_c - f_d), 0.5 * (f_d + f_c - f_b))
    return f_c - f_b - f_d - f_x * mixed[0] - f_y * mixed[1]
