"""Holding an axisymmetric state: the mean round the rings of an annulus.

An unrelaxed membrane in compression has an axisymmetric equilibrium that is unstable: rounding alone grows into
mesh-sized wrinkles. Where the problem itself is axisymmetric and the model is not meant to buckle, the mean of the
force round every ring keeps to the state that is asked for.
"""

from __future__ import annotations

import numpy as np

from fdsolver.grid import Grid
from fdsolver.model import Model
from fdsolver.problem import Problem

ROUND = 1e-9  # sideways movement of an edge, over L, below which it is none


def is_axisymmetric(problem: Problem, model: Model) -> bool:
    """Whether every supported edge of an annulus only grows, turns and lifts, and the model does not buckle."""
    moves = [edge.move_mm for edge in problem.edges.values() if edge.support != "free"]
    sideways = max((max(abs(move[0]), abs(move[1])) for move in moves), default=0.0)
    annular = problem.grid.shape == "annulus"
    return annular and not model.buckles and not model.relaxed and sideways < ROUND * problem.grid.length_mm


def mean_round(grid: Grid, field: np.ndarray) -> np.ndarray:
    """The axisymmetric part of a vector field on an annulus.

    field : (3, ni, nj), in the plane (2, ni, nj), float64, Cartesian components. Returns the same shape: radial,
    circumferential and axial
    components averaged over the rows (the angle) of the mesh.
    """
    angle = np.arctan2(grid.u[..., 1], grid.u[..., 0])
    cosine, sine = np.cos(angle), np.sin(angle)
    radial = np.mean(field[0] * cosine + field[1] * sine, axis=0)
    around = np.mean(field[1] * cosine - field[0] * sine, axis=0)
    plane = [radial * cosine - around * sine, radial * sine + around * cosine]
    axial = [np.broadcast_to(np.mean(part, axis=0), cosine.shape) for part in field[2:]]
    return np.stack([*plane, *axial])
