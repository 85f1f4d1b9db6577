"""Triangulations of a rectangle, an annulus and a rectangle with a hole, and rectangles of a rectangle.

Every mesh maps onto itself under reflection in both axes, so that modes have the parity that the sheet gives them.
Circles are drawn as polygons with their vertices on the circle: an area is wrong by a part of (facet / radius)^2 / 6.
"""

from __future__ import annotations

import math

import numpy as np
from skfem import Mesh, MeshQuad, MeshTri

from femref.sheet_mesh import Circle, SheetMesh

_RECTANGLE_EDGES = ("left", "right", "bottom", "top")


def rectangle(
    width_mm: float,
    height_mm: float,
    nodes: int,
    grading: float = 0.0,
    aspect: float = 1.0,
    cells: str = "triangles",
) -> SheetMesh:
    """A rectangle, width along x, height along y, centred.

    nodes : about the number of vertices. grading : 0 for even lines, towards 1 for lines that gather at the edges.
    aspect : height over width of a cell in the middle. cells : "triangles" or "rectangles".
    """
    length = max(width_mm, height_mm) / 2.0
    a, b = width_mm / (2.0 * length), height_mm / (2.0 * length)
    columns = max(1, round((math.sqrt(nodes * a / b * aspect) - 1.0) / 2.0))
    rows = max(1, round((nodes / (2 * columns + 1) - 1.0) / 2.0))
    x, y = a * _symmetric_lines(columns, grading), b * _symmetric_lines(rows, grading)
    if cells == "rectangles":
        mesh: Mesh = MeshQuad.init_tensor(x, y)
    else:
        mesh = _triangles(x, y)
    return SheetMesh(mesh, _straight_edges(mesh, a, b), length)


def annulus(inner_radius_mm: float, outer_radius_mm: float, nodes: int, grading: float = 0.0) -> SheetMesh:
    """A ring about the origin; grading gathers the circles at both rims."""
    ratio = inner_radius_mm / outer_radius_mm
    mean = math.pi * (1.0 + ratio) / (1.0 - ratio)
    rings = max(2, round(math.sqrt(nodes / mean)))
    sectors = 4 * max(2, round(nodes / (4.0 * (rings + 1))))
    part = 0.5 * (1.0 + _symmetric_lines((rings + 1) // 2, grading))
    radius = ratio + (1.0 - ratio) * part
    angle = 2.0 * np.pi * np.arange(sectors) / sectors
    position = radius[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    mesh = MeshTri(position.reshape(-1, 2).T.copy(), _ring_triangles(len(radius), sectors))
    distance = np.linalg.norm(mesh.p[:, mesh.facets], axis=0)
    circles = {"inner": Circle((0.0, 0.0), ratio), "outer": Circle((0.0, 0.0), 1.0)}
    edges = {
        name: np.flatnonzero((np.abs(distance - circle.radius) < 1e-9).all(axis=0))
        for name, circle in circles.items()
    }
    return SheetMesh(mesh, edges, outer_radius_mm, circles)


def rectangle_with_hole(
    width_mm: float, height_mm: float, hole_radius_mm: float, nodes: int, grading: float = 0.5
) -> SheetMesh:
    """A rectangle with a central circular hole, its cells between rays; grading gathers them at the hole."""
    length = max(width_mm, height_mm) / 2.0
    a, b, hole = width_mm / (2.0 * length), height_mm / (2.0 * length), hole_radius_mm / length
    columns, rows, rays = _holed_counts(a, b, hole, nodes)
    rim = _rectangle_rim(a, b, columns, rows)
    angle = np.arctan2(rim[:, 1], rim[:, 0])
    circle = hole * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    part = np.linspace(0.0, 1.0, rays + 1)
    part = (1.0 - grading) * part + grading * part**2
    position = circle + part[:, None, None] * (rim - circle)
    mesh = MeshTri(position.reshape(-1, 2).T.copy(), _ring_triangles(rays + 1, len(rim)))
    distance = np.linalg.norm(mesh.p[:, mesh.facets], axis=0)
    edges = _straight_edges(mesh, a, b)
    edges["hole"] = np.flatnonzero((np.abs(distance - hole) < 1e-9).all(axis=0))
    return SheetMesh(mesh, edges, length, {"hole": Circle((0.0, 0.0), hole)})


def _holed_counts(a: float, b: float, hole: float, nodes: int) -> tuple[int, int, int]:
    """Cells along half the width, half the height and a ray, as even as they go, for about this many vertices."""

    def counts(size: float) -> tuple[int, int, int]:
        lengths = a, b, 0.5 * (a + b) - hole
        columns, rows, rays = (max(2, round(length / size)) for length in lengths)
        return columns, rows, rays

    def miss(size: float) -> float:
        columns, rows, rays = counts(size)
        return abs(4 * (columns + rows) * (rays + 1) - nodes)

    largest = math.sqrt(4.0 * a * b / nodes) * 2.0
    return counts(min(np.linspace(0.2 * largest, largest, 200), key=miss))


def _symmetric_lines(half: int, grading: float) -> np.ndarray:
    """2 half + 1 values from -1 to 1, symmetric; grading 1 puts them as cosines."""
    even = np.linspace(-1.0, 1.0, 2 * half + 1)
    lines = (1.0 - grading) * even + grading * np.sin(0.5 * np.pi * even)
    lines = 0.5 * (lines - lines[::-1])
    lines[[0, -1]] = -1.0, 1.0
    return lines


def _triangles(x: np.ndarray, y: np.ndarray) -> Mesh:
    """Each cell halved by its diagonal towards the middle of the sheet."""
    number = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    p = np.stack(np.meshgrid(x, y, indexing="ij")).reshape(2, -1)
    i, j = (index.ravel() for index in np.indices((len(x) - 1, len(y) - 1)))
    corner = number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]
    rising = (x[i] + x[i + 1] < 0.0) == (y[j] + y[j + 1] < 0.0)
    first = np.where(rising, [corner[0], corner[1], corner[2]], [corner[0], corner[1], corner[3]])
    second = np.where(rising, [corner[0], corner[2], corner[3]], [corner[1], corner[2], corner[3]])
    return MeshTri(p, np.concatenate([first, second], axis=1))


def _ring_triangles(rings: int, sectors: int) -> np.ndarray:
    """(3, cells) vertices of rings x sectors of nodes, cells halved alternately so that reflections keep the mesh."""
    number = np.arange(rings * sectors).reshape(rings, sectors)
    i, k = (index.ravel() for index in np.indices((rings - 1, sectors)))
    following = (k + 1) % sectors
    corner = number[i, k], number[i + 1, k], number[i + 1, following], number[i, following]
    rising = k % 2 == 0
    first = np.where(rising, [corner[0], corner[1], corner[2]], [corner[0], corner[1], corner[3]])
    second = np.where(rising, [corner[0], corner[2], corner[3]], [corner[1], corner[2], corner[3]])
    return np.concatenate([first, second], axis=1)


def _rectangle_rim(a: float, b: float, columns: int, rows: int) -> np.ndarray:
    """Points (n, 2) round a rectangle from (a, 0) counter-clockwise, corners and axes included."""
    upward = np.stack([np.full(rows, a), b * np.arange(rows) / rows], axis=-1)
    leftward = np.stack([a * (1.0 - np.arange(2 * columns) / columns), np.full(2 * columns, b)], axis=-1)
    downward = np.stack([np.full(rows, -a), b * (1.0 - np.arange(rows) / rows)], axis=-1)
    half = np.concatenate([upward, leftward, downward])
    return np.concatenate([half, -half])


def _straight_edges(mesh: Mesh, a: float, b: float) -> dict[str, np.ndarray]:
    x, y = mesh.p[:, mesh.facets]
    lines = (x + a, x - a, y + b, y - b)
    return {
        name: np.flatnonzero((np.abs(line) < 1e-9).all(axis=0))
        for name, line in zip(_RECTANGLE_EDGES, lines, strict=True)
    }
