"""A sheet's mesh in scaled coordinates, its named edges and circles; what a sheet is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from skfem import Mesh


@dataclass(frozen=True)
class Circle:
    """A circular edge in mesh coordinates."""

    centre: tuple[float, float]
    radius: float


@dataclass(frozen=True)
class SheetMesh:
    """A triangulation (or rectangles) of a plane sheet.

    mesh : scikit-fem mesh; its coordinates are (position - centre_mm) / length_mm.
    edges : edge name -> facets, int64. circles : edge name -> the circle that its straight facets stand for.
    """

    mesh: Mesh
    edges: Mapping[str, np.ndarray]
    length_mm: float
    circles: Mapping[str, Circle] = field(default_factory=dict)
    centre_mm: tuple[float, float] = (0.0, 0.0)

    @property
    def positions_mm(self) -> np.ndarray:
        """(vertices, 2) float64, mm."""
        return np.ascontiguousarray(self.length_mm * self.mesh.p.T + np.array(self.centre_mm))

    @property
    def cells(self) -> np.ndarray:
        """(cells, 3 or 4) int64, vertices counter-clockwise."""
        cells = self.mesh.t.T.astype(np.int64)
        x, y = self.mesh.p[:, cells[:, :3].T]
        clockwise = (x[1] - x[0]) * (y[2] - y[0]) < (x[2] - x[0]) * (y[1] - y[0])
        cells[clockwise] = cells[clockwise, ::-1]
        return cells

    def tangents(self, edge: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Vertices (k,) of an edge, one entry per facet and end, the unit tangents (2, k) and curvatures (k,) there.

        The curvature is 1 / radius of a circle, whose tangent is the circle's and not the facet's; 0 elsewhere.
        """
        ends = self.mesh.facets[:, self.edges[edge]]
        vertices = ends.ravel()
        if edge in self.circles:
            circle = self.circles[edge]
            radial = self.mesh.p[:, vertices] - np.array(circle.centre)[:, None]
            radial /= np.linalg.norm(radial, axis=0)
            return vertices, np.stack([-radial[1], radial[0]]), np.full(len(vertices), 1.0 / circle.radius)
        along = self.mesh.p[:, ends[1]] - self.mesh.p[:, ends[0]]
        along /= np.linalg.norm(along, axis=0)
        return vertices, np.tile(along, 2), np.zeros(len(vertices))


@dataclass(frozen=True)
class PlateMaterial:
    """An isotropic sheet in plane stress.

    young_MPa : Y, MPa. poisson : -1 < nu <= 1/2. thickness_mm : h, mm.
    """

    young_MPa: float
    poisson: float
    thickness_mm: float

    @property
    def c(self) -> float:
        """c / Y of S = c tr(E) 1 + 2 mu E: nu / (1 - nu^2)."""
        return self.poisson / (1.0 - self.poisson**2)

    @property
    def two_mu(self) -> float:
        """2 mu / Y: 1 / (1 + nu)."""
        return 1.0 / (1.0 + self.poisson)

    def bending(self, length_mm: float) -> float:
        """h^2 / (12 L^2): the ratio of bending to membrane stiffness for lengths in units of L."""
        return self.thickness_mm**2 / (12.0 * length_mm**2)
