"""Point location and interpolation on a structured lattice of points in the reference plane.

Positions and fields are interpolated by the same polynomials in index space, and a point is found by
inverting the interpolated positions. A field that is linear in (x, y) is therefore reproduced exactly on any
mesh, kinked ones included.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from fdsolver.grid import Grid, zone_corners

# Newton converges in 4 to 6 steps inside a smooth mesh; the rest is for points beside a kinked mesh line.
_NEWTON_STEPS = 40


@dataclass(frozen=True)
class Places:
    """Points located on a lattice.

    index : (m, 2) float64, lattice coordinates (rows, columns); the row of a closed lattice may be any real
        number.
    rate : (m, 2, 2) float64, 1/mm, d(index)/d(x, y).
    distance_mm : (m,) distance from the wanted point to the lattice's nearest found point; about 0 inside.
    """

    index: np.ndarray
    rate: np.ndarray
    distance_mm: np.ndarray


@dataclass(frozen=True, eq=False)
class Lattice:
    """A logically rectangular set of points.

    positions : (n, m, 2) float64, mm.
    closed : row n - 1 is followed by row 0.
    degree : of the interpolating polynomials in each direction (1: second order, 3: fourth order).
    margin : how far beyond the outermost points a place may lie, in index units (extrapolation).
    """

    positions: np.ndarray
    closed: bool
    degree: int
    margin: float

    @cached_property
    def _monomials(self) -> np.ndarray:
        """(degree + 1, degree + 1): coefficients of the Lagrange polynomials on 0 .. degree."""
        return np.linalg.inv(np.vander(np.arange(self.degree + 1.0), increasing=True))

    def locate(self, points: np.ndarray) -> Places:
        """Find points (m, 2), mm, on the lattice by Newton's method from the nearest lattice point."""
        rows, columns, _ = self.positions.shape
        nearest = cKDTree(self.positions.reshape(-1, 2)).query(points)[1]
        index = np.stack(np.divmod(nearest, columns), axis=-1).astype(float)
        best, rate = index.copy(), np.zeros((len(points), 2, 2))
        distance = np.full(len(points), np.inf)
        for step in range(_NEWTON_STEPS):
            position, slope = self._evaluate(index)
            miss = points - position
            inverse = np.linalg.inv(slope)
            size = np.linalg.norm(miss, axis=-1)
            closer = size < distance
            best[closer], rate[closer], distance[closer] = index[closer], inverse[closer], size[closer]
            # Beside a kink full steps may alternate between its two sides; shorter ones later settle there.
            factor = 1.0 if step < 10 else 0.5
            move = factor * np.clip((inverse @ miss[..., None])[..., 0], -2.0, 2.0)
            if np.abs(move).max(initial=0.0) < 1e-13:
                break
            index = self._confine(index + move)
        return Places(best, rate, distance)

    def interpolate(self, field: np.ndarray, places: Places) -> np.ndarray:
        """Values (m, ...) of a field (n, m, ...) given at the lattice points."""
        rows, columns, along, across, _, _ = self._stencil(places.index)
        values = field[rows[:, :, None], columns[:, None, :]]
        return np.einsum("pa,pb,pab...->p...", along, across, values)

    def nearest(self, field: np.ndarray, places: Places) -> np.ndarray:
        """Values (m, ...) of a field at the lattice points nearest in index space."""
        n, m = self.positions.shape[:2]
        rows = np.rint(places.index[:, 0]).astype(int)
        rows = rows % n if self.closed else np.clip(rows, 0, n - 1)
        return field[rows, np.clip(np.rint(places.index[:, 1]).astype(int), 0, m - 1)]

    def _evaluate(self, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions (m, 2) and their slopes d(x, y)/d(index), (m, 2, 2)."""
        rows, columns, along, across, d_along, d_across = self._stencil(index)
        values = self.positions[rows[:, :, None], columns[:, None, :]]
        position = np.einsum("pa,pb,pabk->pk", along, across, values)
        by_row = np.einsum("pa,pb,pabk->pk", d_along, across, values)
        by_column = np.einsum("pa,pb,pabk->pk", along, d_across, values)
        return position, np.stack([by_row, by_column], axis=-1)

    def _stencil(self, index: np.ndarray) -> tuple[np.ndarray, ...]:
        n, m = self.positions.shape[:2]
        first_row = np.floor(index[:, 0]).astype(int) - (self.degree - 1) // 2
        if not self.closed:
            first_row = np.clip(first_row, 0, n - 1 - self.degree)
        first_column = np.floor(index[:, 1]).astype(int) - (self.degree - 1) // 2
        first_column = np.clip(first_column, 0, m - 1 - self.degree)
        along, d_along = self._weights(index[:, 0] - first_row)
        across, d_across = self._weights(index[:, 1] - first_column)
        offsets = np.arange(self.degree + 1)
        rows = (first_row[:, None] + offsets) % n
        return rows, first_column[:, None] + offsets, along, across, d_along, d_across

    def _weights(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        power = np.arange(self.degree + 1)
        value = t[:, None] ** power
        slope = power * t[:, None] ** np.maximum(power - 1, 0)
        return value @ self._monomials, slope @ self._monomials

    def _confine(self, index: np.ndarray) -> np.ndarray:
        n, m = self.positions.shape[:2]
        if not self.closed:
            index[:, 0] = np.clip(index[:, 0], -self.margin, n - 1 + self.margin)
        index[:, 1] = np.clip(index[:, 1], -self.margin, m - 1 + self.margin)
        return index


def node_lattice(grid: Grid) -> Lattice:
    """The nodes of a mesh; cubic, or as high as its node counts allow; nothing outside the sheet."""
    degree = min(3, grid.ni - 1, grid.nj - 1)
    return Lattice(grid.u, grid.closed, degree, margin=0.0)


def zone_lattice(grid: Grid) -> Lattice:
    """The zone centres (means of the four nodes); linear; edges are reached by extrapolating half a zone."""
    centres = zone_centres(grid)
    degree = min(1, centres.shape[0] - 1, centres.shape[1] - 1)
    # Half a zone to the edge, and as much again for the sagitta of a curved edge on a coarse mesh.
    return Lattice(centres, grid.closed, degree, margin=1.0)


def zone_centres(grid: Grid) -> np.ndarray:
    """(zone rows, nj - 1, 2) mm. Mean of the positions of each zone's four nodes."""
    a, b, c, d = zone_corners(grid.u, grid.closed)
    return 0.25 * (a + b + c + d)
