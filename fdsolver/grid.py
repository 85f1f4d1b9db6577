"""Logically rectangular meshes: node positions, zone and node areas, quality, and what is refused.

A zone (i, j) has the corners a = (i, j), b = (i+1, j), c = (i+1, j+1), d = (i, j+1), counter-clockwise. Zone
areas are those of the Green's-theorem differences (Taylor et al. 2014, Eq. 58). The meshes
of the three shapes are made in `fdsolver.meshes`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np


class GridError(ValueError):
    """A mesh that cannot be made or must not be used; the message names the quantity or the zone."""


@dataclass(frozen=True, eq=False)
class Grid:
    """A structured mesh of quadrilateral zones on the flat reference sheet.

    shape : "rectangle", "annulus" or "rectangle-with-hole".
    u : (ni, nj, 2) float64, C-contiguous, mm. Reference positions of the nodes.
    closed : the first index runs round; row ni-1 is followed by row 0, which is not repeated.
    edges : edge name -> (m, 2) int64, node indices (i, j) in order along the edge.
    xi : (ni,) logical coordinate of the rows, rising, in [0, 1] (open) or [0, 1) (closed).
    eta : (nj,) logical coordinate of the columns, rising, in [0, 1].
    length_mm : scaling length L of the problem, mm.
    breaks : values of xi at which the map (xi, eta) -> u has a kink; empty for a smooth map.

    Raises GridError for arrays of the wrong shape or type, positions that are not finite, edges that name no
    node, and for a zone whose area is not positive (named by its indices and place).
    """

    shape: str
    u: np.ndarray
    closed: bool
    edges: Mapping[str, np.ndarray]
    xi: np.ndarray
    eta: np.ndarray
    length_mm: float
    breaks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        _check_positions(self.u, self.closed)
        _check_logical("xi", self.xi, self.ni, self.closed)
        _check_logical("eta", self.eta, self.nj, False)
        _check_edges(self.edges, self.ni, self.nj)
        if not (np.isfinite(self.length_mm) and self.length_mm > 0.0):
            raise GridError(f"length_mm must be positive and finite, not {self.length_mm}")
        if not all(0.0 <= value <= 1.0 for value in self.breaks):
            raise GridError(f"breaks must lie between 0 and 1, not {self.breaks}")
        _check_areas(self.zone_area, self.u)

    @property
    def ni(self) -> int:
        """Number of node rows (first index)."""
        return self.u.shape[0]

    @property
    def nj(self) -> int:
        """Number of node columns (second index)."""
        return self.u.shape[1]

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return self.ni * self.nj

    @property
    def zones(self) -> int:
        """Number of zones."""
        return (self.ni if self.closed else self.ni - 1) * (self.nj - 1)

    @cached_property
    def zone_area(self) -> np.ndarray:
        """(zone rows, nj - 1) float64, mm^2. Half the cross product of each zone's diagonals [58]."""
        a, b, c, d = zone_corners(self.u, self.closed)
        p, q = c - a, d - b
        return 0.5 * (p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0])

    @cached_property
    def node_area(self) -> np.ndarray:
        """(ni, nj) float64, mm^2. A quarter of the areas of the zones that meet at the node.

        The sum is the area of the sheet (of the polygon that the mesh covers).
        """
        quarter = 0.25 * self.zone_area
        row = np.zeros((quarter.shape[0], self.nj))
        row[:, :-1] += quarter
        row[:, 1:] += quarter
        if self.closed:
            return row + np.roll(row, 1, axis=0)
        area = np.zeros((self.ni, self.nj))
        area[:-1] += row
        area[1:] += row
        return area


@dataclass(frozen=True)
class Quality:
    """How far the zones are from squares.

    smallest_angle_deg : smallest inner angle of any zone, degrees; 90 is best; a folded corner is negative.
    largest_aspect : largest ratio of a zone's two mid-lines (means of opposite edge vectors); 1 is best.
    smallest_zone_area_mm2 : mm^2.
    """

    smallest_angle_deg: float
    largest_aspect: float
    smallest_zone_area_mm2: float


def zone_corners(field: np.ndarray, closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Values of a nodal field (ni, nj, ...) at the zones' corners a, b, c, d, (zone rows, nj - 1, ...)."""
    following = np.roll(field, -1, axis=0) if closed else field[1:]
    first = field if closed else field[:-1]
    return first[:, :-1], following[:, :-1], following[:, 1:], first[:, 1:]


def quality(grid: Grid) -> Quality:
    """Smallest angle, largest aspect ratio and smallest area of the zones of `grid`."""
    corners = zone_corners(grid.u, grid.closed)
    smallest_angle = min(
        float(_angle(corners[(k + 1) % 4] - corners[k], corners[(k - 1) % 4] - corners[k]).min())
        for k in range(4)
    )
    a, b, c, d = corners
    along = np.linalg.norm(b - a + c - d, axis=-1)
    across = np.linalg.norm(d - a + c - b, axis=-1)
    aspect = np.maximum(along, across) / np.minimum(along, across)
    return Quality(smallest_angle, float(aspect.max()), float(grid.zone_area.min()))


def _angle(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Angle from `first` to `second`, counter-clockwise, degrees in (-180, 180]."""
    cross = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return np.degrees(np.arctan2(cross, (first * second).sum(axis=-1)))


def _check_positions(u: np.ndarray, closed: bool) -> None:
    if u.ndim != 3 or u.shape[2] != 2:
        raise GridError(f"node positions must have the shape (ni, nj, 2), not {u.shape}")
    if u.dtype != np.float64 or not u.flags.c_contiguous:
        raise GridError("node positions must be a C-contiguous array of float64")
    # Fewer rows leave no zone, or (closed) make opposite zones share both of their node rows.
    rows = 3 if closed else 2
    if u.shape[0] < rows or u.shape[1] < 2:
        raise GridError(
            f"a mesh needs at least {rows} rows and 2 columns of nodes, not {u.shape[0]} x {u.shape[1]}"
        )
    finite = np.isfinite(u).all(axis=-1)
    if not finite.all():
        i, j = np.argwhere(~finite)[0]
        raise GridError(f"node ({i}, {j}) has the position {tuple(u[i, j].tolist())}, which is not finite")


def _check_logical(name: str, values: np.ndarray, count: int, closed: bool) -> None:
    if values.shape != (count,):
        raise GridError(f"{name} must have the shape ({count},), not {values.shape}")
    if not (values[0] >= 0.0 and values[-1] <= 1.0 and (np.diff(values) > 0.0).all()):
        raise GridError(f"{name} must rise within 0 to 1")
    if closed and values[-1] >= 1.0:
        raise GridError(f"{name} must stay below 1 in a closed direction")


def _check_edges(edges: Mapping[str, np.ndarray], ni: int, nj: int) -> None:
    for name, nodes in edges.items():
        if nodes.ndim != 2 or nodes.shape[1] != 2 or nodes.dtype != np.int64:
            raise GridError(f"edge {name} must be an int64 array of shape (m, 2)")
        if (nodes < 0).any() or (nodes >= (ni, nj)).any():
            raise GridError(f"edge {name} names a node outside the mesh of {ni} x {nj} nodes")


def _check_areas(area: np.ndarray, u: np.ndarray) -> None:
    good = (area > 0.0) & np.isfinite(area)
    if good.all():
        return
    bad = np.argwhere(~good)
    i, j = bad[0]
    x, y = 0.25 * (u[i, j] + u[i, j + 1] + u[(i + 1) % len(u), j] + u[(i + 1) % len(u), j + 1])
    raise GridError(
        f"zone ({i}, {j}) at ({x:.6g}, {y:.6g}) mm has the area {area[i, j]:.6g} mm^2;"
        f" every zone area must be positive and finite ({len(bad)} of {area.size} zones are not)"
    )
