"""The ghost nodes of the published scheme: a layer outside the sheet that carries the tangent plane of its edges.

At the nodes of free and pinned edges the moment is made to vanish by (74), M_kab nu_a nu_b = -c dF_ka/dt nu_a, an
explicit rule for the ghosts beside the sheet's own motion. Averaged over the exterior zones and with one velocity for
neighbouring ghosts, it moves a ghost along the edge's normal n by

    n . v_ghost = n . (v[-1] + 2 v + v[+1]) / 4 - (spacing / c) M_nu_nu

with the velocities v of the edge's nodes. With c = D / (rate spacing) the offset w = n . (r_ghost - 2 r_edge +
r_inside), which is the curvature across the edge times spacing^2, settles by the factor 1 - rate in a step. What the
paper leaves open is settled so:

- Along the tangent plane nothing follows from (74), as M is along n: there a ghost continues the sheet, at 2 r_edge -
  r_inside, as in the reference state.
- Corner ghosts continue the twist: the mixed difference of the exterior corner zone is that of the zone within.
- At a clamped edge the ghost mirrors the node inside: the slope across the edge is zero.

A wave k (per node) along the edge sees M_nu_nu = D (cos^2(k/2) - nu s sin^2(k/2)) w / spacing^2, s = (spacing / node
distance)^2: the averages over exterior zones hide short waves of the ghosts from the curvature across the edge, not
from that along it. So with nu > 0 the offsets of short waves grow without bound, whatever c. A filtered ghost line
loses a sixteenth of its fourth difference in every step, 1 - sin^4(k/2), which takes out the shortest wave and changes
smooth offsets by a term of fourth order; with rate <= 1 / (2 (nu s)^2) every wave decays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fdsolver.rows import compiled

RATE = 0.5  # share of a wrong offset that one step takes away, where short waves do not ask for less
FOLDED = 0.5  # zigzag of a ghost row, in spacings, that is no shape of the sheet


@dataclass(frozen=True)
class GhostLayer:
    """Ghosts of the four edges: rows 0 and -1 (along the first mesh direction), columns 0 and -1 of the extended mesh.

    row_rate, column_rate : (2, nj + 2), (2, ni + 2) float64. rate spacing^2 / D, scaled, at the nodes of the edges.
    row_spacing, column_spacing : (2,) float64. Spacing across the edge / L.
    row_clamped, column_clamped : whether the edge is clamped. filtered : whether the ghost lines are.
    """

    row_rate: np.ndarray
    column_rate: np.ndarray
    row_spacing: np.ndarray
    column_spacing: np.ndarray
    row_clamped: tuple[bool, bool]
    column_clamped: tuple[bool, bool]
    filtered: bool

    def place(self, r: np.ndarray) -> None:
        """Put all ghosts of r (3, ni + 2, nj + 2) straight on from the sheet; at clamped edges mirrored."""
        for side in (0, 1):
            continue_line(*_line(r, side), self.row_clamped[side])
            continue_line(*_line(r.transpose(0, 2, 1), side), self.column_clamped[side])
        place_corners(r, *self.row_clamped, *self.column_clamped)

    def follow(self, r: np.ndarray, v: np.ndarray, row_edges: np.ndarray, column_edges: np.ndarray) -> None:
        """Move the ghosts of r by one step [74], after the step of the sheet with velocities v.

        r, v : (3, ni + 2, nj + 2). row_edges, column_edges : of `published.band`, at the positions before that step.
        """
        for side in (0, 1):
            rows, speeds = _line(r, side), v[:, 1 if side == 0 else -2, 1:-1]
            _follow(rows, speeds, row_edges[side], self.row_rate[side], self.row_clamped[side], self.filtered)
            turned = r.transpose(0, 2, 1)
            columns, speeds = _line(turned, side), v[:, 1:-1, 1 if side == 0 else -2]
            _follow(
                columns,
                speeds,
                column_edges[side],
                self.column_rate[side],
                self.column_clamped[side],
                self.filtered,
            )
        place_corners(r, *self.row_clamped, *self.column_clamped)

    def roughness(self, r: np.ndarray) -> tuple[float, float, float, float]:
        """Largest zigzag of the ghosts of rows 0, -1 and columns 0, -1, in spacings across the edge; 0 if clamped."""
        lines = [_line(r, 0), _line(r, 1), _line(r.transpose(0, 2, 1), 0), _line(r.transpose(0, 2, 1), 1)]
        spacings, clamped = (
            (*self.row_spacing, *self.column_spacing),
            (*self.row_clamped, *self.column_clamped),
        )
        a, b, c, d = (
            0.0 if given else zigzag(*line) / h
            for line, h, given in zip(lines, spacings, clamped, strict=True)
        )
        return a, b, c, d


def _line(r: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ghosts, nodes of the edge and nodes inside at the first (side 0) or last row, (3, n) without the corners."""
    ghost, edge, inside = (0, 1, 2) if side == 0 else (-1, -2, -3)
    return r[:, ghost, 1:-1], r[:, edge, 1:-1], r[:, inside, 1:-1]


def _follow(
    line: tuple[np.ndarray, np.ndarray, np.ndarray],
    speed: np.ndarray,
    state: np.ndarray,
    rate: np.ndarray,
    clamped: bool,
    filtered: bool,
) -> None:
    if clamped:
        continue_line(*line, True)
    else:
        follow_line(*line, speed, state[:3, 1:-1], state[3, 1:-1], rate[1:-1], filtered)


@compiled
def follow_line(ghost, edge, inside, speed, normal, moment, rate, filtered):
    """One step of (74) for one line of ghosts. All (3, n) but moment and rate (n)."""
    n = ghost.shape[1]
    offset = np.empty(n)
    for j in range(n):
        before, after = max(j - 1, 0), min(j + 1, n - 1)
        offset[j] = -rate[j] * moment[j]
        for k in range(3):
            mean = 0.25 * (speed[k, before] + 2.0 * speed[k, j] + speed[k, after])
            offset[j] += normal[k, j] * (ghost[k, j] + mean - 2.0 * edge[k, j] + inside[k, j])
    for j in range(n):
        w = offset[j]
        if filtered:
            w -= fourth_difference(offset, j) / 16.0
        for k in range(3):
            ghost[k, j] = 2.0 * edge[k, j] - inside[k, j] + w * normal[k, j]


@compiled
def fourth_difference(values, j):
    """values[j - 2] - 4 values[j - 1] + 6 values[j] - ..., mirrored at the ends."""
    last = len(values) - 1
    a, b, c, d = abs(j - 2), abs(j - 1), last - abs(last - j - 1), last - abs(last - j - 2)
    return values[a] - 4.0 * values[b] + 6.0 * values[j] - 4.0 * values[c] + values[d]


@compiled
def continue_line(ghost, edge, inside, clamped):
    """Ghosts at 2 r_edge - r_inside; out of the plane, at a clamped edge, at the height of the node inside."""
    for j in range(ghost.shape[1]):
        for k in range(3):
            ghost[k, j] = 2.0 * edge[k, j] - inside[k, j]
        if clamped:
            ghost[2, j] = inside[2, j]


@compiled
def place_corners(r, first_row, last_row, first_column, last_column):
    """Ghosts at the four corners, by the mixed difference of the zone within; mirrored at clamped edges (flags)."""
    rows, columns = r.shape[1], r.shape[2]
    for g, e, i, row_clamped in ((0, 1, 2, first_row), (rows - 1, rows - 2, rows - 3, last_row)):
        for h, f, j, column_clamped in (
            (0, 1, 2, first_column),
            (columns - 1, columns - 2, columns - 3, last_column),
        ):
            for k in range(3):
                r[k, g, h] = r[k, g, f] + r[k, e, h] - r[k, i, f] - r[k, e, j] + r[k, i, j]
            if row_clamped:
                r[2, g, h] = r[2, i, h]
            elif column_clamped:
                r[2, g, h] = r[2, g, j]


@compiled
def zigzag(ghost, edge, inside):
    """Largest sixteenth of the fourth difference of r_ghost - 2 r_edge + r_inside along a line, any component."""
    n = ghost.shape[1]
    offset = np.empty(n)
    largest = 0.0
    for k in range(3):
        for j in range(n):
            offset[j] = ghost[k, j] - 2.0 * edge[k, j] + inside[k, j]
        for j in range(n):
            value = abs(fourth_difference(offset, j)) / 16.0
            # not "value > largest": a NaN must not pass for smooth
            largest = largest if value <= largest else value
    return largest
