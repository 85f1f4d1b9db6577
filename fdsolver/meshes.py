"""The meshes of the three shapes: rectangle, annulus, rectangle with a hole.

Each shape has one smooth map (xi, eta) -> u, the same at every node count, so that fields of two meshes of a shape can be
interpolated in (xi, eta). The node counts of the two directions are chosen so that the cells are about square and their
product is within 5 % of the nodes asked for (from 400 nodes up). Meshes keep the mirror symmetries of their shape exactly.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np

from fdsolver.grid import Grid, GridError

FEWEST_NODES = 100
MOST_NODES = 50_000_000
LARGEST_BIAS = 5.0
# Side fractions with larger denominators would leave too few admissible node counts near 400 nodes: with ni a multiple of
# 4 * 8 there is always an nj >= 12 within 0.5 / 12 = 4 % of the nodes asked for.
LARGEST_DENOMINATOR = 8

# (s, eta) -> (x, y): s is xi on an open mesh, and 4 xi on the first quarter of a closed one.
PositionMap = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def rectangle(
    width_mm: float,
    height_mm: float,
    nodes: int,
    bias: float = 0.0,
    bias_x: float | None = None,
    bias_y: float | None = None,
) -> Grid:
    """Mesh of the rectangle |x| <= width/2, |y| <= height/2; i runs along +x, j along +y.

    nodes : number of nodes asked for; both counts are odd, so that nodes lie on both centre lines.
    bias : 0 (uniform) to 5. x = (width/2) sinh(bias s) / sinh(bias), s in [-1, 1]: the spacing at the edge is cosh(bias)
        times that at the centre line. bias_x and bias_y override it for one direction.

    Raises GridError for sizes, nodes or biases out of range.
    """
    width, height = _positive("width_mm", width_mm), _positive("height_mm", height_mm)
    count = _node_count(nodes)
    bias_across = _bias("bias_x", bias if bias_x is None else bias_x)
    bias_along = _bias("bias_y", bias if bias_y is None else bias_y)
    ni, nj = _counts(count, width / height, row_step=2, column_step=2, intervals_i=-1)
    xi, eta = np.arange(ni) / (ni - 1), np.arange(nj) / (nj - 1)
    # 2 i - (n - 1) is odd about the centre without rounding, and so is sinh: mirror images are exact.
    x = 0.5 * width * _centred(np.arange(1 - ni, ni, 2) / (ni - 1), bias_across)
    y = 0.5 * height * _centred(np.arange(1 - nj, nj, 2) / (nj - 1), bias_along)
    u = np.ascontiguousarray(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1))
    rows, columns = np.arange(ni), np.arange(nj)
    edges = {
        "left": _line(np.zeros_like(columns), columns),
        "right": _line(np.full_like(columns, ni - 1), columns),
        "bottom": _line(rows, np.zeros_like(rows)),
        "top": _line(rows, np.full_like(rows, nj - 1)),
    }
    return Grid("rectangle", u, False, edges, xi, eta, width)


def annulus(inner_radius_mm: float, outer_radius_mm: float, nodes: int, bias: float = 1.0) -> Grid:
    """Mesh of the annulus about the origin; i runs clockwise from the +x axis (closed), j outward.

    bias : 0 to 5. Radii with R^(1 - bias) linear in eta: 0 is uniform, 1 (default) logarithmic, where all cells have one
        aspect ratio and are about square; larger values crowd the nodes further at the inner circle.

    The number of rows is a multiple of 4, so that nodes lie on both axes. Raises GridError for values out of range.
    """
    inner, outer = (
        _positive("inner_radius_mm", inner_radius_mm),
        _positive("outer_radius_mm", outer_radius_mm),
    )
    if inner >= outer:
        raise GridError(f"inner_radius_mm {inner:g} must be below outer_radius_mm {outer:g}")
    count, grading = _node_count(nodes), _bias("bias", bias)

    def position(s: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        radius = inner + (outer - inner) * _graded(eta, outer / inner, grading)
        angle = 0.5 * math.pi * s
        return radius * np.cos(angle), radius * np.sin(angle)

    ni, nj = _counts(count, 4.0 * _cell_ratio(position), row_step=4)
    eta = np.arange(nj) / (nj - 1)
    u = _four_quarters(position, ni, eta)
    rows = np.arange(ni)
    edges = {"inner": _line(rows, np.zeros_like(rows)), "outer": _line(rows, np.full_like(rows, nj - 1))}
    return Grid("annulus", u, True, edges, rows / ni, eta, outer)


def rectangle_with_hole(
    width_mm: float, height_mm: float, hole_radius_mm: float, nodes: int, bias: float = 1.0
) -> Grid:
    """O-mesh of a rectangle with a central circular hole; i runs clockwise from the +x axis (closed), j outward.

    The lines of constant i are straight, from the circle to the rectangle; those to the four corners (`breaks`) leave the
    circle at the angle of the corner and lie at the same xi at every node count.

    bias : 0 to 5. Grading along each line towards the hole: 0 is uniform, 1 (default) makes the spacing grow in proportion
        to the distance from the centre, so that cells are about square; larger values crowd the nodes further at the hole.

    Raises GridError for values out of range, and for a hole that does not fit into the rectangle.
    """
    width, height = _positive("width_mm", width_mm), _positive("height_mm", height_mm)
    hole = _positive("hole_radius_mm", hole_radius_mm)
    if 2.0 * hole >= min(width, height):
        raise GridError(
            f"hole_radius_mm {hole:g} must be below half the shorter side, {0.5 * min(width, height):g} mm:"
            " the hole is wider than the sheet"
        )
    count, grading = _node_count(nodes), _bias("bias", bias)
    corner = _corner_fraction(width, height)
    position = _hole_map(0.5 * width, 0.5 * height, hole, grading, corner)
    ni, nj = _counts(count, 4.0 * _cell_ratio(position), row_step=4 * corner.denominator)
    eta = np.arange(nj) / (nj - 1)
    u = _four_quarters(position, ni, eta)
    fraction = float(corner) / 4.0
    breaks = (fraction, 0.5 - fraction, 0.5 + fraction, 1.0 - fraction)
    rows = np.arange(ni)
    edges = {
        "hole": _line(rows, np.zeros_like(rows)),
        **_sides(ni, nj, ni * corner.numerator // (4 * corner.denominator)),
    }
    return Grid("rectangle-with-hole", u, True, edges, rows / ni, eta, max(width, height), breaks)


def _hole_map(
    half_width: float, half_height: float, hole: float, bias: float, corner: Fraction
) -> PositionMap:
    """Map of the first quarter: straight lines from the circle to the side x = half_width, then to y = half_height."""
    at_corner = float(corner)
    # tan(angle) = stretch tan(pi s / 2) is smooth round the whole circle and meets the corner's angle at s = corner.
    stretch = half_height / half_width / math.tan(0.5 * math.pi * at_corner)

    def position(s: np.ndarray, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        angle = np.arctan2(stretch * np.sin(0.5 * math.pi * s), np.cos(0.5 * math.pi * s))
        x_hole, y_hole = hole * np.cos(angle), hole * np.sin(angle)
        x_side = half_width * np.minimum(1.0, (1.0 - s) / (1.0 - at_corner))
        y_side = half_height * np.minimum(1.0, s / at_corner)
        ratio = 1.0 + np.hypot(x_side - x_hole, y_side - y_hole) / hole
        part = _graded(eta, ratio, bias)
        # This form of the blend gives both end points without rounding.
        return (1.0 - part) * x_hole + part * x_side, (1.0 - part) * y_hole + part * y_side

    return position


def _corner_fraction(width: float, height: float) -> Fraction:
    """Part of a quarter turn of xi that goes to the upright side, a fixed ratio of small integers.

    It lies midway between equal spacing on the circle (the corner's angle) and on the rectangle (the sides' lengths).
    """
    by_angle = math.atan2(height, width) / (0.5 * math.pi)
    by_length = height / (width + height)
    least = Fraction(1, LARGEST_DENOMINATOR)
    best = Fraction(0.5 * (by_angle + by_length)).limit_denominator(LARGEST_DENOMINATOR)
    return min(max(best, least), 1 - least)


def _sides(ni: int, nj: int, corner: int) -> dict[str, np.ndarray]:
    """Edges of the rectangle on the outermost column, clockwise, corners in both; `corner` is the first corner's row."""

    def part(start: int, stop: int) -> np.ndarray:
        rows = np.arange(start, stop + 1) % ni
        return _line(rows, np.full_like(rows, nj - 1))

    half = ni // 2
    return {
        "right": part(-corner, corner),
        "bottom": part(corner, half - corner),
        "left": part(half - corner, half + corner),
        "top": part(half + corner, ni - corner),
    }


def _four_quarters(position: PositionMap, ni: int, eta: np.ndarray) -> np.ndarray:
    """(ni, nj, 2) nodes of a closed mesh from its first quarter, mirrored exactly; clockwise from the +x axis."""
    quarter = ni // 4
    x, y = position((np.arange(quarter + 1) / quarter)[:, None], eta[None, :])
    x[-1] = 0.0  # cos(pi/2) is not zero in floating point; the sine of 0 is
    first = np.stack([x, -y], axis=-1)
    half = np.concatenate([first[:-1], first[::-1] * (-1.0, 1.0)])  # down to the -x axis, both ends included
    u = np.concatenate([half[:-1], half[:0:-1] * (1.0, -1.0)])
    return np.ascontiguousarray(u) + 0.0  # no negative zeros


def _centred(s: np.ndarray, bias: float) -> np.ndarray:
    """Odd map of [-1, 1] onto itself with the slope bias / sinh(bias) at the centre."""
    return np.sinh(bias * s) / math.sinh(bias) if bias > 1e-6 else s


def _graded(eta: np.ndarray, ratio: np.ndarray | float, bias: float) -> np.ndarray:
    """Map of [0, 1] onto itself: (R - 1) / (ratio - 1) with R from 1 to ratio and R^(1 - bias) linear in eta."""
    power = 1.0 - bias
    growth = np.log(ratio)
    if abs(power) < 1e-6:
        return np.expm1(eta * growth) / np.expm1(growth)
    return np.expm1(np.log1p(eta * np.expm1(power * growth)) / power) / np.expm1(growth)


def _cell_ratio(position: PositionMap) -> float:
    """Mean (geometric, over the logical square) of |du/ds| / |du/deta|: the ratio of counts that makes cells square."""
    s, eta = np.linspace(0.0, 1.0, 65), np.linspace(0.0, 1.0, 65)
    u = np.stack(np.broadcast_arrays(*position(s[:, None], eta[None, :])), axis=-1)
    along = np.linalg.norm(np.diff(u, axis=0), axis=-1)
    across = np.linalg.norm(np.diff(u, axis=1), axis=-1)
    return math.exp(float(np.log(along).mean() - np.log(across).mean()))


def _counts(
    nodes: int, ratio: float, row_step: int, column_step: int = 1, intervals_i: int = 0
) -> tuple[int, int]:
    """Node counts (ni, nj) near `nodes` in product with intervals in i over intervals in j near `ratio`.

    ni is a multiple of row_step less intervals_i (-1: odd counts of an open mesh, ni - 1 intervals; 0: closed, ni intervals);
    nj - 1 is a multiple of column_step. Among the pairs within 5 % of `nodes` the squarest cells win, count errors weighing in.
    """
    fewest_columns = 3  # two zones across, so that second differences exist
    ideal = math.sqrt(nodes * ratio)
    most = max(nodes / fewest_columns, 2.0 * row_step)
    low, high = min(max(ideal / 8.0, row_step), most / 2.0), min(8.0 * ideal + 8.0 * row_step, most)
    intervals = row_step * np.arange(max(1, int(low / row_step)), int(high / row_step) + 2)
    ni = intervals - intervals_i
    columns = column_step * np.rint((nodes / ni - 1.0) / column_step)
    columns = np.maximum(columns, fewest_columns - 1)
    count_error = np.abs(ni * (columns + 1.0) / nodes - 1.0)
    # Four times the count error: 2 % off in the count is as bad as cells longer by 8 %.
    cost = (
        np.abs(np.log(intervals / columns / ratio))
        + 4.0 * count_error
        + 1e3 * np.maximum(count_error - 0.05, 0.0)
    )
    best = int(np.argmin(cost))
    return int(ni[best]), int(columns[best]) + 1


def _line(rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    return np.stack([rows, columns], axis=-1).astype(np.int64)


def _positive(name: str, value: float) -> float:
    if not (math.isfinite(value) and value > 0.0):
        raise GridError(f"{name} must be positive and finite, not {value}")
    return float(value)


def _bias(name: str, value: float) -> float:
    if not 0.0 <= value <= LARGEST_BIAS:
        raise GridError(f"{name} must lie between 0 and {LARGEST_BIAS:g}, not {value}")
    return float(value)


def _node_count(nodes: int) -> int:
    if not math.isfinite(nodes) or nodes != int(nodes):
        raise GridError(f"nodes must be a whole number, not {nodes}")
    if nodes < FEWEST_NODES:
        raise GridError(f"nodes must be at least {FEWEST_NODES}, not {nodes}: fewer resolve no shape")
    if nodes > MOST_NODES:
        raise GridError(
            f"nodes must be at most {MOST_NODES}, not {nodes}: the fields would not fit into memory"
        )
    return int(nodes)
