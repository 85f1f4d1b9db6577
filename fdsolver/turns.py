"""Turns of edges by more than half a circle, which the positions of the edges cannot tell from shorter ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid

HALF = 180.0  # degrees: at half a circle both ways round are equally long


def largest_turn(edges: Mapping[str, EdgeCondition]) -> float:
    """The largest turn of one supported edge against another, degrees; 0 without two of them.

    Its sign is that of the turn of the edge whose name comes first in the alphabet: of inner against outer.
    """
    turns = [edge.rotate_deg for _, edge in sorted(edges.items()) if edge.support != "free"]
    between = [first - second for k, second in enumerate(turns) for first in turns[:k]]
    return max(between, key=abs, default=0.0)


def found_turn(grid: Grid, r: np.ndarray) -> float:
    """By how much the inner circle of an annulus is turned against the outer one, along its radial lines, degrees.

    r : (ni, nj, 3) float64, mm. Turns of single cells are taken the shorter way round.
    """
    turned = np.angle((r[..., 0] + 1j * r[..., 1]) * (grid.u[..., 0] - 1j * grid.u[..., 1]))
    steps = np.angle(np.exp(1j * np.diff(turned, axis=1)))
    return -float(np.degrees(steps.sum(axis=1).mean()))


def turn_warnings(edges: Mapping[str, EdgeCondition], grid: Grid, r: np.ndarray) -> list[str]:
    """A sentence about a turn of more than half a circle, and of which turn the state r (ni, nj, 3), mm, is."""
    turn = largest_turn(edges)
    if abs(turn) <= HALF:
        return []
    shorter = turn - 2.0 * HALF * round(turn / (2.0 * HALF))
    sentence = (
        f"The edges are turned by {turn:g} degrees against each other, and stand where a turn by {shorter:g} degrees"
        " puts them: nothing but the way of the iteration tells the two apart."
    )
    if grid.shape == "annulus":
        sentence += f" The state found is that of a turn by {round(found_turn(grid, r), 1):g} degrees."
    return [sentence]
