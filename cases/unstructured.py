"""What a finite-element method returns: a mesh without rows, the sheet on it, modes and critical factors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fdsolver.result import Answer, Solution


@dataclass(frozen=True)
class FiniteElementMesh:
    """Triangles or quadrilaterals of a plane sheet; `nodes` and `zones` are counts, as of a Grid.

    shape : of the sheet, as in a scene. u : (n, 2) float64, mm, reference positions of the vertices.
    cells : (m, 3) or (m, 4) int64, vertices counter-clockwise.

    Raises ValueError for arrays that are none of these.
    """

    shape: str
    u: np.ndarray
    cells: np.ndarray

    def __post_init__(self) -> None:
        if self.u.ndim != 2 or self.u.shape[1] != 2 or not np.isfinite(self.u).all():
            raise ValueError(f"u must be finite and of the shape (n, 2), not {self.u.shape}")
        if self.cells.ndim != 2 or self.cells.shape[1] not in (3, 4) or self.cells.size == 0:
            raise ValueError(f"cells must have the shape (m, 3) or (m, 4), not {self.cells.shape}")
        if self.cells.min() < 0 or self.cells.max() >= len(self.u):
            raise ValueError(f"cells name vertices outside 0 to {len(self.u) - 1}")

    @property
    def nodes(self) -> int:
        """Number of vertices."""
        return len(self.u)

    @property
    def zones(self) -> int:
        """Number of cells."""
        return len(self.cells)

    @cached_property
    def zone_area(self) -> np.ndarray:
        """(m,) float64, mm^2, of each cell by the shoelace formula."""
        x, y = self.u[self.cells].transpose(2, 0, 1)
        return 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)

    @cached_property
    def node_area(self) -> np.ndarray:
        """(n,) float64, mm^2. The cells' areas shared equally among their vertices."""
        corners = self.cells.shape[1]
        share = np.repeat(self.zone_area / corners, corners)
        return np.bincount(self.cells.ravel(), share, minlength=self.nodes)


@dataclass(frozen=True, kw_only=True)
class FiniteElementSolution(Answer):
    """The answer of a finite-element method: r is (n, 3), the fields of `zone` (m,), one value per cell.

    grid : the mesh. modes : (k, n) float64, heights of the buckling modes at the vertices, largest 1; k = 0 where there
        are none.
    critical : one mapping per mode, ascending: `factor` of the scene's own load, `parity` and what else is known.
    errors : entries of `errors` in result.json.
    derivatives : (n, 3, 3) float64, r,x  r,y  r,xy at the vertices of a bicubic field (by angle and radius on an
        annulus); None for other elements.
    """

    grid: FiniteElementMesh
    modes: np.ndarray
    critical: tuple[Mapping[str, Any], ...] = ()
    errors: tuple[Mapping[str, Any], ...] = ()
    derivatives: np.ndarray | None = None


AnySolution = Solution | FiniteElementSolution
