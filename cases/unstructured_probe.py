"""Stretches along paths and heights along sections of a finite-element result, as `cases.probe` does on grids.

Heights are interpolated linearly between vertices, stretches (one per cell) through their area means at the vertices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cases.probe import Columns, ProbeError, Section
from cases.schema import Line
from cases.unstructured import FiniteElementMesh, FiniteElementSolution

SAMPLES = 401
_RAYS = 48
# barycentric coordinates of a point on the sheet's edge, or of a circle beside the polygon that stands for it
_INSIDE = -0.05
_CHUNK = 64


@dataclass(frozen=True)
class Found:
    """Points located in triangles.

    index : (k,) of the points that are on the sheet. vertices, weight : (k, 3). cell : (k,).
    """

    index: np.ndarray
    vertices: np.ndarray
    weight: np.ndarray
    cell: np.ndarray

    def interpolate(self, values: np.ndarray) -> np.ndarray:
        """(k,) values at the points, from one per vertex."""
        return (values[self.vertices] * self.weight).sum(axis=1)


def locate(mesh: FiniteElementMesh, points: np.ndarray, everywhere: bool = False) -> Found:
    """The triangles (halves of quadrilaterals) that hold the points (k, 2), mm.

    Points off the sheet are left out, or (everywhere) get the triangle that they are least outside of.
    """
    triangles = (
        mesh.cells
        if mesh.cells.shape[1] == 3
        else np.concatenate([mesh.cells[:, :3], mesh.cells[:, [0, 2, 3]]])
    )
    origin = mesh.u[triangles[:, 0]]
    sides = np.stack([mesh.u[triangles[:, 1]] - origin, mesh.u[triangles[:, 2]] - origin], axis=-1)
    inverse = np.linalg.inv(sides)
    best, weights = np.empty(len(points), dtype=np.int64), np.empty((len(points), 3))
    for start in range(0, len(points), _CHUNK):
        part = slice(start, start + _CHUNK)
        local = np.einsum("tab,ptb->pta", inverse, points[part, None] - origin)
        barycentric = np.concatenate([1.0 - local.sum(axis=-1, keepdims=True), local], axis=-1)
        best[part] = barycentric.min(axis=-1).argmax(axis=1)
        weights[part] = barycentric[np.arange(len(local)), best[part]]
    on = np.flatnonzero(everywhere | (weights.min(axis=1) >= _INSIDE))
    return Found(on, triangles[best[on]], weights[on], best[on] % mesh.zones)


def sample_section(mesh: FiniteElementMesh, r: np.ndarray, line: Line) -> Section:
    """Heights along a line, r : (n, 3) mm. Raises ProbeError if no point of the line is on the sheet."""
    s, points = _line(line)
    found = locate(mesh, points)
    if not found.index.size:
        raise ProbeError("no point of the line is on the sheet")
    z = found.interpolate(r[:, 2])
    closed = line.radius_mm is not None and found.index.size == len(s)
    if closed and mesh.shape == "annulus":
        z = z - z[:-1].mean()
    spacing = np.sqrt(mesh.zone_area[found.cell] * (2.0 if mesh.cells.shape[1] == 3 else 1.0))
    x, y = points[found.index].T
    return Section(s[found.index], x, y, z, spacing, closed)


def path_columns(solution: FiniteElementSolution, name: str, line: Line) -> Columns:
    """The columns of paths/NAME.csv, for the `radius` of an annulus as means round circles."""
    mesh = solution.grid
    if mesh.shape == "annulus" and name == "radius":
        return _ring_columns(solution)
    s, points = _line(line)
    found = locate(mesh, points)
    if not found.index.size:
        raise ProbeError(f"no point of the path {name} is on the sheet")
    x, y = points[found.index].T
    return {"s_mm": s[found.index], "x_mm": x, "y_mm": y, **_stretches(solution, found)}


def _ring_columns(solution: FiniteElementSolution) -> Columns:
    """Means round circles midway between those of the mesh; R_mm is the radius."""
    mesh = solution.grid
    vertex_radius = np.unique(np.round(np.linalg.norm(mesh.u, axis=1), 9))
    radius = 0.5 * (vertex_radius[1:] + vertex_radius[:-1])
    angle = 2.0 * np.pi * np.arange(_RAYS) / _RAYS
    points = (radius[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)).reshape(-1, 2)
    found = locate(mesh, points)
    values = {name: np.full(len(points), np.nan) for name in ("stretch_major", "stretch_minor", "state")}
    for name, column in _stretches(solution, found).items():
        values[name][found.index] = column
    major, minor, state = (values[name].reshape(len(radius), _RAYS) for name in values)
    return {
        "R_mm": radius,
        "stretch_major": np.nanmean(major, axis=1),
        "stretch_minor": np.nanmean(minor, axis=1),
        "stretch_major_spread": np.nanmax(major, axis=1) - np.nanmin(major, axis=1),
        "state": np.nanmedian(state, axis=1).astype(np.int8),
    }


def _stretches(solution: FiniteElementSolution, found: Found) -> Columns:
    zone = solution.zone
    return {
        "stretch_major": found.interpolate(vertex_means(solution.grid, zone.stretch_major)),
        "stretch_minor": found.interpolate(vertex_means(solution.grid, zone.stretch_minor)),
        "state": zone.state[found.cell],
    }


def vertex_means(mesh: FiniteElementMesh, values: np.ndarray) -> np.ndarray:
    """(n,) means, by area, of the values (m,) of the cells that meet at each vertex."""
    corners = mesh.cells.shape[1]
    weighted = np.repeat(mesh.zone_area * values / corners, corners)
    return np.bincount(mesh.cells.ravel(), weighted, minlength=mesh.nodes) / mesh.node_area


def _line(line: Line) -> tuple[np.ndarray, np.ndarray]:
    """Distances (k,) and positions (k, 2), mm, of even samples of a line."""
    part = np.linspace(0.0, 1.0, SAMPLES)
    if line.radius_mm is not None:
        angle = 2.0 * np.pi * part
        return line.radius_mm * angle, line.radius_mm * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    if line.start_mm is None or line.end_mm is None:
        raise ProbeError("a line needs from_mm and to_mm, or radius_mm")
    start, end = np.array(line.start_mm), np.array(line.end_mm)
    return float(np.linalg.norm(end - start)) * part, start + part[:, None] * (end - start)
