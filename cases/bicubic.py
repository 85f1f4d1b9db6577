"""Bicubic finite-element results: their field rebuilt from what a result stores, and sections sampled from it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cases.probe import ProbeError, Section, line_points
from cases.schema import Line
from cases.unstructured import FiniteElementMesh, FiniteElementSolution

if TYPE_CHECKING:
    from femref.bicubic import Mesh

# Samples of a section; the field is smooth between vertices, so their number need not follow the mesh.
SAMPLES = 2001
_KINDS = (1, 0, 2)  # r,x  r,y  r,xy as stored, in the order r,y  r,x  r,xy of the nodal values


def stored_mesh(mesh: Mesh, shape: str) -> FiniteElementMesh:
    """Vertices, line by line of constant x, and quadrilaterals of a tensor-product mesh."""
    x, y = np.meshgrid(mesh.x, mesh.y, indexing="ij")
    u = np.stack([y * np.cos(x), y * np.sin(x)] if mesh.polar else [x, y], axis=-1)
    ni, nj = mesh.shape
    near, lower = np.meshgrid(np.arange(ni if mesh.polar else ni - 1), np.arange(nj - 1), indexing="ij")
    far = (near + 1) % ni
    corners = [near * nj + lower, far * nj + lower, far * nj + lower + 1, near * nj + lower + 1]
    # angle and radius are a left-handed pair
    cells = np.stack(corners[::-1] if mesh.polar else corners, axis=-1).reshape(-1, 4)
    return FiniteElementMesh(shape, u.reshape(-1, 2), cells.astype(np.int64))


def stored_derivatives(mesh: Mesh, values: np.ndarray) -> np.ndarray:
    """r,x  r,y  r,xy (n, 3, 3) at the vertices, of nodal values (ni, nj, 4, 3)."""
    from femref.bicubic import derivative_scales

    derivatives = (values / derivative_scales(mesh)[..., None])[:, :, [2, 1, 3]]
    return np.ascontiguousarray(derivatives.reshape(-1, 3, 3))


def field_of(solution: FiniteElementSolution) -> tuple[Mesh, np.ndarray]:
    """The mesh and the nodal values (ni, nj, 4, 3) of a stored bicubic result.

    Raises ValueError for a result without derivatives.
    """
    from femref.bicubic import Mesh, derivative_scales

    if solution.derivatives is None:
        raise ValueError("this result has no bicubic field")
    u, polar = solution.grid.u, solution.grid.shape == "annulus"
    # along the first line of vertices the angle, or x, does not change
    along = np.hypot(*u.T) if polar else u[:, 1]
    nj = int(np.argmin(np.diff(along) > 0.0)) + 1
    x = np.unwrap(np.arctan2(u[::nj, 1], u[::nj, 0])) if polar else u[::nj, 0]
    mesh = Mesh(x.copy(), along[:nj].copy(), polar)
    ni = len(x)
    values = np.empty((ni, nj, 4, 3))
    values[:, :, 0] = solution.r.reshape(ni, nj, 3)
    values[:, :, 1:] = solution.derivatives.reshape(ni, nj, 3, 3)[:, :, _KINDS]
    return mesh, values * derivative_scales(mesh)[..., None]


def sample_bicubic_section(solution: FiniteElementSolution, line: Line) -> Section:
    """Heights of the bicubic field along a line. Raises ProbeError if no point of the line is on the sheet."""
    mesh, values = field_of(solution)
    return sample_field(mesh, values, line)


def sample_field(mesh: Mesh, values: np.ndarray, line: Line) -> Section:
    """Heights of a bicubic field, nodal values (ni, nj, 4, 3), along a line.

    Raises ProbeError if no point of the line is on the sheet.
    """
    from femref.bicubic import evaluate

    s, points = line_points(line, SAMPLES)
    x, y = points.T
    if mesh.polar:
        start = mesh.breaks[0][0]
        x, y = start + np.mod(np.arctan2(y, x) - start, 2.0 * np.pi), np.hypot(x, y)
    ends = mesh.breaks
    slack = [1e-9 * (axis[-1] - axis[0]) for axis in ends]
    on = np.ones(len(s), dtype=bool)
    for place, axis, margin in zip((x, y), ends, slack, strict=True):
        on &= (place >= axis[0] - margin) & (place <= axis[-1] + margin)
    if not on.any():
        raise ProbeError("no point of the line is on the sheet")
    z = evaluate(mesh, values, x[on], y[on])[:, 2]
    closed = line.radius_mm is not None and bool(on.all())
    if closed and mesh.polar:
        z = z - z[:-1].mean()
    return Section(s[on], points[on, 0], points[on, 1], z, _spacing(mesh, x[on], y[on], s[on]), closed)


def _spacing(mesh: Mesh, x: np.ndarray, y: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Half the distance along the line between mesh lines of the family crossed more often, (k,) mm.

    Half, because a field has two unknowns per line here, its value and its slope, against one on a grid.
    """
    rate = np.zeros(len(s))
    for place, axis in zip((np.unwrap(x) if mesh.polar else x, y), mesh.breaks, strict=True):
        number = np.interp(place, axis, np.arange(len(axis), dtype=float))
        rate = np.maximum(rate, np.abs(np.gradient(number, s)))
    return 0.5 / np.maximum(rate, 1e-12)
