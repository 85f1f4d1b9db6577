"""A boundary-value problem: sheet, mesh, edge conditions and the start."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.symmetry import Symmetry


@dataclass(frozen=True)
class Problem:
    """All that a relaxation needs to know of a scene.

    grid_of : node count -> Grid of the same shape and map, for the coarser levels of a nested run.
    perturbation : amplitude of the random out-of-plane start at the free nodes, in units of grid.length_mm.
    seed : of that perturbation.
    symmetry : what the state is assumed to keep; only a part of the mesh is then solved. None: the whole sheet.
    initial : mesh and positions (ni, nj, 3), mm, of a state to start from instead of the uniform start; None: uniform.
    """

    sheet: Sheet
    edges: Mapping[str, EdgeCondition]
    grid: Grid
    grid_of: Callable[[int], Grid]
    perturbation: float = 1e-6
    seed: int = 0
    symmetry: Symmetry | None = None
    initial: tuple[Grid, np.ndarray] | None = None
