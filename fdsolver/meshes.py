"""The meshes of the three shapes: rectangle, annulus, rectangle with a hole.

Each shape has one map (xi, eta) -> u, the same at every node count, so that fields of two meshes of a shape
can be interpolated in (xi, eta). Cells are about square and the nodes within 5 % of the number asked for
(from 400 up). Meshes keep the mirror symmetries of their shape exactly, to the last bit.
"""

from __future__ import annotations

import math
import sys
from fractions import Fraction

import numpy as np

from fdsolver.grid import Grid, GridError
from fdsolver.node_counts import PositionMap, cell_ratio, checked_node_count, interval_counts

LARGEST_BIAS = 5.0
LARGEST_CELL_RATIO = 10.0
# ni is a multiple of 4 times the denominator of the side fractions. With 4 * 8 rows there is always an nj
# from 12 up within 0.5 / 12 = 4 % of 400 nodes or more; larger denominators could not promise that.
LARGEST_DENOMINATOR = 8


def rectangle(
    width_mm: float,
    height_mm: float,
    nodes: int,
    bias: float = 0.0,
    bias_x: float | None = None,
    bias_y: float | None = None,
    cell_ratio: float = 1.0,
) -> Grid:
    """Mesh of the rectangle |x| <= width/2, |y| <= height/2; i runs along +x, j along +y.

    nodes : number of nodes asked for; both counts are odd, so that nodes lie on both centre lines.
    bias : 0 (uniform) to 5. x = (width/2) sinh(bias s) / sinh(bias), s in [-1, 1], and y alike: the spacing
        at the edge is cosh(bias) times that at the centre line. bias_x and bias_y override it for one
        direction.
    cell_ratio : height over width of the cells, 0.1 to 10 (without bias; about, as counts are whole numbers).

    Raises GridError for sizes, nodes, biases or cell_ratio out of range.
    """
    width, height = _positive("width_mm", width_mm), _positive("height_mm", height_mm)
    count = checked_node_count(nodes)
    across = _bias("bias_x", bias if bias_x is None else bias_x)
    along = _bias("bias_y", bias if bias_y is None else bias_y)
    if not 1.0 / LARGEST_CELL_RATIO <= cell_ratio <= LARGEST_CELL_RATIO:
        raise GridError(f"cell_ratio must lie between 0.1 and {LARGEST_CELL_RATIO:g}, not {cell_ratio}")
    ratio = width / height * cell_ratio
    rows, columns = interval_counts(count, ratio, closed=False, row_step=2, column_step=2)
    x = 0.5 * width * _centred(rows, across)
    y = 0.5 * height * _centred(columns, along)
    u = np.ascontiguousarray(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1))
    i, j = np.arange(rows + 1), np.arange(columns + 1)
    edges = {"left": _edge(0, j), "right": _edge(rows, j), "bottom": _edge(i, 0), "top": _edge(i, columns)}
    return Grid("rectangle", u, False, edges, i / rows, j / columns, width)


def annulus(
    inner_radius_mm: float, outer_radius_mm: float, nodes: int, bias: float = 1.0, sectors: int = 1
) -> Grid:
    """Mesh of the annulus about the origin; i runs clockwise from the +x axis (closed), j outward.

    nodes : number of nodes asked for; ni is a multiple of 4, so that nodes lie on both axes.
    bias : 0 to 5. R^(1 - bias) is linear in eta: 0 gives uniform rings, 1 (default) a geometric series,
        where all cells are equally close to squares; larger values crowd the nodes further at the inner
        circle.
    sectors : divides ni too.

    Raises GridError for radii, nodes or bias out of range.
    """
    inner, outer = (
        _positive("inner_radius_mm", inner_radius_mm),
        _positive("outer_radius_mm", outer_radius_mm),
    )
    if inner >= outer:
        raise GridError(f"inner_radius_mm {inner:g} must be below outer_radius_mm {outer:g}")
    count, grading = checked_node_count(nodes), _bias("bias", bias)

    def position(s: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        part = _graded(eta, outer / inner, grading)
        radius = (1.0 - part) * inner + part * outer
        angle = 0.5 * math.pi * s
        return radius * np.cos(angle), radius * np.sin(angle)

    step = math.lcm(4, sectors)
    rows, columns = interval_counts(count, 4.0 * cell_ratio(position), closed=True, row_step=step)
    i, eta = np.arange(rows), np.arange(columns + 1) / columns
    edges = {"inner": _edge(i, 0), "outer": _edge(i, columns)}
    return Grid("annulus", _four_quarters(position, rows, eta), True, edges, i / rows, eta, outer)


def rectangle_with_hole(
    width_mm: float, height_mm: float, hole_radius_mm: float, nodes: int, bias: float = 1.0
) -> Grid:
    """O-mesh of a rectangle with a central hole; i runs clockwise from the +x axis (closed), j outward.

    Lines of constant i are straight, from the circle to the rectangle. Those to the four corners
    (`Grid.breaks`) leave the circle at the angle of the corner and have the same xi at every node count.

    bias : 0 to 5. Grading along each line towards the hole: 0 is uniform; with 1 (default) the spacing grows
        in proportion to the distance from the centre, as that of the lines does; larger values crowd the
        nodes further at the hole.

    Raises GridError for sizes, nodes or bias out of range, and for a hole that does not fit into the
    rectangle.
    """
    width, height = _positive("width_mm", width_mm), _positive("height_mm", height_mm)
    hole = _positive("hole_radius_mm", hole_radius_mm)
    if 2.0 * hole >= min(width, height):
        raise GridError(
            f"hole_radius_mm {hole:g} must be below half the shorter side, {0.5 * min(width, height):g} mm:"
            " the hole is wider than the sheet"
        )
    count, grading = checked_node_count(nodes), _bias("bias", bias)
    corner = _corner_fraction(width, height)
    position = _hole_map(0.5 * width, 0.5 * height, hole, grading, corner)
    step = 4 * corner.denominator
    rows, columns = interval_counts(count, 4.0 * cell_ratio(position), closed=True, row_step=step)
    i, eta = np.arange(rows), np.arange(columns + 1) / columns
    edges = {"hole": _edge(i, 0), **_sides(rows, columns, rows * corner.numerator // step)}
    quarter = float(corner) / 4.0
    breaks = (quarter, 0.5 - quarter, 0.5 + quarter, 1.0 - quarter)
    u = _four_quarters(position, rows, eta)
    return Grid("rectangle-with-hole", u, True, edges, i / rows, eta, max(width, height), breaks)


def _hole_map(
    half_width: float, half_height: float, hole: float, bias: float, corner: Fraction
) -> PositionMap:
    """Map of one quarter: lines from the circle to the side x = half_width, then to the side y = half_height.

    The argument s is 0 on the x axis, `corner` at the corner and 1 on the y axis.
    """
    at_corner = float(corner)
    # tan(angle) = stretch tan(pi s / 2) is smooth round the whole circle and meets the corner's angle.
    stretch = half_height / half_width / math.tan(0.5 * math.pi * at_corner)

    def position(s: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        angle = np.arctan2(stretch * np.sin(0.5 * math.pi * s), np.cos(0.5 * math.pi * s))
        x_hole, y_hole = hole * np.cos(angle), hole * np.sin(angle)
        x_side = half_width * np.minimum(1.0, (1.0 - s) / (1.0 - at_corner))
        y_side = half_height * np.minimum(1.0, s / at_corner)
        ratio = 1.0 + np.hypot(x_side - x_hole, y_side - y_hole) / hole
        part = _graded(eta, ratio, bias)
        return (1.0 - part) * x_hole + part * x_side, (1.0 - part) * y_hole + part * y_side

    return position


def _corner_fraction(width: float, height: float) -> Fraction:
    """Part of a quarter of xi that goes to the upright side, a ratio of small integers.

    It lies midway between equal spacing on the circle (the corner's angle) and on the rectangle (the sides'
    lengths).
    """
    by_angle = math.atan2(height, width) / (0.5 * math.pi)
    by_length = height / (width + height)
    best = Fraction(0.5 * (by_angle + by_length)).limit_denominator(LARGEST_DENOMINATOR)
    least = Fraction(1, LARGEST_DENOMINATOR)
    return min(max(best, least), 1 - least)


def _sides(ni: int, last: int, corner: int) -> dict[str, np.ndarray]:
    """Sides of the rectangle on column `last`, clockwise, corners in both; the first at row `corner`."""

    def side(start: int, stop: int) -> np.ndarray:
        return _edge(np.arange(start, stop + 1) % ni, last)

    half = ni // 2
    return {
        "right": side(-corner, corner),
        "bottom": side(corner, half - corner),
        "left": side(half - corner, half + corner),
        "top": side(half + corner, ni - corner),
    }


def _edge(i: np.ndarray | int, j: np.ndarray | int) -> np.ndarray:
    """(m, 2) int64 node indices."""
    return np.stack(np.broadcast_arrays(i, j), axis=-1).astype(np.int64)


def _four_quarters(position: PositionMap, ni: int, eta: np.ndarray) -> np.ndarray:
    """(ni, nj, 2) nodes of a closed mesh, clockwise from the +x axis: one quarter and its mirror images."""
    quarter = ni // 4
    x, y = position((np.arange(quarter + 1) / quarter)[:, None], eta[None, :])
    x[-1] = 0.0  # on the y axis; the cosine of pi/2 is not zero in floating point
    first = np.stack([x, -y], axis=-1)
    lower = np.concatenate([first[:-1], first[::-1] * (-1.0, 1.0)])  # to the -x axis, both ends included
    u = np.concatenate([lower[:-1], lower[:0:-1] * (1.0, -1.0)])
    return np.ascontiguousarray(u) + 0.0  # turns -0 into 0


def _centred(intervals: int, bias: float) -> np.ndarray:
    """(intervals + 1,) positions from -1 to 1, dense at 0, odd about it without rounding."""
    s = np.arange(-intervals, intervals + 1, 2) / intervals
    return np.sinh(bias * s) / math.sinh(bias) if bias > 1e-6 else s


def _graded(eta: np.ndarray, ratio: np.ndarray | float, bias: float) -> np.ndarray:
    """(R - 1) / (ratio - 1) with R from 1 to `ratio` and R^(1 - bias) linear in eta (bias 1: log R)."""
    power = 1.0 - bias
    growth = np.log(ratio)
    if abs(power) < 1e-6:
        part = np.expm1(eta * growth) / np.expm1(growth)
    else:
        part = np.expm1(np.log1p(eta * np.expm1(power * growth)) / power) / np.expm1(growth)
    return np.where(eta == 1.0, 1.0, part)  # the rounding of `part` would move the edge


def _positive(name: str, value: float) -> float:
    if not 0.0 < value <= sys.float_info.max:  # larger integers do not fit a float
        raise GridError(f"{name} must be positive and finite, not {value}")
    return float(value)


def _bias(name: str, value: float) -> float:
    if not 0.0 <= value <= LARGEST_BIAS:
        raise GridError(f"{name} must lie between 0 and {LARGEST_BIAS:g}, not {value}")
    return float(value)
