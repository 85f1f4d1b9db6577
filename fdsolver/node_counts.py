"""Numbers of rows and columns that give a mesh square cells and the number of nodes asked for."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fdsolver.grid import GridError

FEWEST_NODES = 100
MOST_NODES = 50_000_000
FEWEST_COLUMNS = 3  # two zones across, so that second differences exist
COUNT_TOLERANCE = 0.0499  # 5 %, and clear of rounding

# (s, eta) -> (x, y) on the unit square, broadcasting over arrays.
PositionMap = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def checked_node_count(nodes: int) -> int:
    """`nodes` as an int; raises GridError unless it is a whole number from FEWEST_NODES to MOST_NODES."""
    if nodes < FEWEST_NODES:
        raise GridError(f"nodes must be at least {FEWEST_NODES}, not {nodes}: fewer resolve no shape")
    if not nodes <= MOST_NODES:  # also NaN
        raise GridError(f"nodes must be at most {MOST_NODES}, not {nodes}: more would not fit into memory")
    if nodes != int(nodes):
        raise GridError(f"nodes must be a whole number, not {nodes}")
    return int(nodes)


def cell_ratio(position: PositionMap) -> float:
    """Intervals in s over intervals in eta that make the cells of a map square.

    That is |du/ds| / |du/deta|, as the geometric mean over the logical square.
    """
    s, eta = np.linspace(0.0, 1.0, 65), np.linspace(0.0, 1.0, 65)
    u = np.stack(np.broadcast_arrays(*position(s[:, None], eta[None, :])), axis=-1)
    along = np.linalg.norm(np.diff(u, axis=0), axis=-1)
    across = np.linalg.norm(np.diff(u, axis=1), axis=-1)
    return math.exp(float(np.log(along).mean() - np.log(across).mean()))


def interval_counts(
    nodes: int, ratio: float, closed: bool, row_step: int, column_step: int = 1
) -> tuple[int, int]:
    """Numbers of intervals (rows, columns) of a mesh of about `nodes` nodes.

    nodes : ni * nj aimed at; ni = intervals if closed, else intervals + 1; nj = intervals + 1.
    ratio : intervals of the rows over intervals of the columns that makes the cells square.
    row_step, column_step : each number of intervals is a multiple of its step.

    Among the pairs within COUNT_TOLERANCE of `nodes` the squarest cells win, the error of the count weighing
    in; if there is no such pair (below 400 nodes) the nearest count wins.
    """
    ideal = math.sqrt(nodes * ratio)
    most = nodes / FEWEST_COLUMNS
    low = max(1, int(min(ideal / 8.0, most / 2.0) / row_step))
    high = int(min(8.0 * ideal, most) / row_step) + 1
    rows = row_step * np.arange(low, max(high, low) + 1)
    node_rows = rows if closed else rows + 1
    columns = column_step * np.rint((nodes / node_rows - 1.0) / column_step)
    columns = np.maximum(columns, FEWEST_COLUMNS - 1)
    error = np.abs(node_rows * (columns + 1.0) / nodes - 1.0)
    # Factor 4: a count that is off by 2 % is as bad as cells that are longer by 8 %.
    cost = np.abs(np.log(rows / columns / ratio)) + 4.0 * error
    cost += 1e6 * np.maximum(error - COUNT_TOLERANCE, 0.0)
    best = int(np.argmin(cost))
    return int(rows[best]), int(columns[best])
