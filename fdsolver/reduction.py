"""Half, quarter and sector meshes: the part of a mesh that a symmetry leaves to solve, with ghost lines beyond it.

The part keeps one line of ghost nodes beyond each line of symmetry, whose positions are images of nodes inside. Its
energy counts the zones inside once and the nodes on a mirror line half; that times the number of parts is the energy of
the whole sheet, with the same discretisation, so a reduced run is the whole run kept symmetric.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fdsolver.grid import Grid, GridError
from fdsolver.symmetry import ROUND, Symmetry, mirror, rotation


@dataclass(frozen=True)
class Link:
    """A line of ghost nodes: its nodes are Q times those of the line `image`. axis : 0 rows, 1 columns of the mesh."""

    axis: int
    ghost: int
    image: int
    turn: np.ndarray


@dataclass(frozen=True)
class Reduction:
    """The part of a mesh that is solved.

    whole, part : meshes. rows, columns : the part's lines in the whole mesh. links : its ghost lines.
    held : (axis, line, component) that a mirror line holds. node_share : (ni, nj) of the part, 1 inside, 1/2 on a
    mirror line, 0 beyond. zone_share : 1 or 0. copies : number of parts. source, turn : for every node of the whole
    mesh the flat index of its node in the part and the (3, 3) map from there, (nodes,) and (nodes, 3, 3).
    """

    whole: Grid
    part: Grid
    rows: np.ndarray
    columns: np.ndarray
    links: tuple[Link, ...]
    held: tuple[tuple[int, int, int], ...]
    node_share: np.ndarray
    zone_share: np.ndarray
    copies: int
    source: np.ndarray
    turn: np.ndarray

    def restrict(self, field: np.ndarray) -> np.ndarray:
        """Values at the part's nodes, ghosts included, of a field (ni, nj, ...) on the whole mesh."""
        return np.ascontiguousarray(field[self.rows][:, self.columns])

    def unfold(self, r: np.ndarray) -> np.ndarray:
        """Positions (ni, nj, 3) on the whole mesh of the part's positions."""
        placed = np.einsum("nkl,nl->nk", self.turn, r.reshape(-1, 3)[self.source])
        return placed.reshape(self.whole.ni, self.whole.nj, 3)


def reduction(grid: Grid, symmetry: Symmetry) -> Reduction:
    """Cut the part of a mesh that a symmetry leaves to solve.

    Raises GridError for a mesh whose rows the sectors do not divide.
    """
    if symmetry.reduce == "sector":
        return _sector(grid, symmetry.sectors or grid.ni)
    mirrors = [mirror(axis, symmetry.parity) for axis in symmetry.axes]
    if grid.closed:
        return _closed_part(grid, symmetry)
    ni, nj = grid.ni, grid.nj
    rows, columns, links, held = np.arange(ni), np.arange(nj), [], []
    for axis, turn in zip(symmetry.axes, mirrors, strict=True):
        along, count = (0, ni) if axis == "x" else (1, nj)
        lines = np.arange(count // 2 - 1, count)
        rows, columns = (lines, columns) if along == 0 else (rows, lines)
        links.append(Link(along, 0, 2, turn))
        held += _held(along, 1, turn)
    return _mirrored_parts(grid, rows, columns, links, held, _group(mirrors))


def _held(along: int, line: int, turn: np.ndarray) -> list[tuple[int, int, int]]:
    return [(along, line, component) for component in range(3) if turn[component, component] < 0.0]


def _group(mirrors: list[np.ndarray]) -> list[np.ndarray]:
    """All products of mirror images."""
    group = [np.eye(3)]
    for turn in mirrors:
        group += [turn @ element for element in group]
    return group


def _closed_part(grid: Grid, symmetry: Symmetry) -> Reduction:
    """Half or quarter of a mesh that runs clockwise from the +x axis, with nodes on both axes."""
    quarter = grid.ni // 4
    first, last, begin, end = {
        "half-x": (3 * quarter, 5 * quarter, "x", "x"),
        "half-y": (2 * quarter, 4 * quarter, "y", "y"),
        "quarter": (0, quarter, "y", "x"),
    }[symmetry.reduce]
    rows = np.arange(first - 1, last + 2) % grid.ni
    turns = mirror(begin, symmetry.parity), mirror(end, symmetry.parity)
    count = len(rows)
    links = [Link(0, 0, 2, turns[0]), Link(0, count - 1, count - 3, turns[1])]
    held = _held(0, 1, turns[0]) + _held(0, count - 2, turns[1])
    group = _group([mirror(axis, symmetry.parity) for axis in symmetry.axes])
    return _mirrored_parts(grid, rows, np.arange(grid.nj), links, held, group)


def _sector(grid: Grid, sectors: int) -> Reduction:
    """One of equal sectors of an annulus, whose rows run clockwise."""
    if grid.ni % sectors:
        raise GridError(f"{sectors} sectors do not divide the {grid.ni} mesh rows of the ring")
    count = grid.ni // sectors
    step = -2.0 * math.pi / sectors
    rows = np.arange(-1, count + 1) % grid.ni
    links = [Link(0, 0, count, rotation(-step)), Link(0, count + 1, 1, rotation(step))]
    turns = np.array([rotation(k * step) for k in range(sectors)])
    sector, row = np.divmod(np.arange(grid.ni), count)
    source = (1 + row)[:, None] * grid.nj + np.arange(grid.nj)
    turn = np.repeat(turns[sector], grid.nj, axis=0)
    return _assemble(grid, rows, np.arange(grid.nj), links, [], sectors, (source.ravel(), turn))


def _mirrored_parts(
    grid: Grid,
    rows: np.ndarray,
    columns: np.ndarray,
    links: list[Link],
    held: list[tuple[int, int, int]],
    group: list[np.ndarray],
) -> Reduction:
    """The reduction of a mesh to some of its lines, whose mirror images make the whole."""
    images = _sources(grid, _part(grid, rows, columns), _shares(rows, columns, links, held) > 0.0, group)
    return _assemble(grid, rows, columns, links, held, len(group), images)


def _shares(
    rows: np.ndarray, columns: np.ndarray, links: list[Link], held: list[tuple[int, int, int]]
) -> np.ndarray:
    """(len(rows), len(columns)): 1 at nodes inside, 1/2 on a mirror line, 0 beyond."""
    share = np.ones((len(rows), len(columns)))
    for line in {(axis, line) for axis, line, _ in held}:
        _line(share, *line)[:] *= 0.5
    for link in links:
        _line(share, link.axis, link.ghost)[:] = 0.0
    return share


def _assemble(
    grid: Grid,
    rows: np.ndarray,
    columns: np.ndarray,
    links: list[Link],
    held: list[tuple[int, int, int]],
    copies: int,
    images: tuple[np.ndarray, np.ndarray],
) -> Reduction:
    """The reduction of a mesh to some of its lines. images : `source` and `turn` of the reduction."""
    zones = np.ones((len(rows) - 1, len(columns) - 1))
    for link in links:
        # between two sectors the zones of the far side are the sector's own
        if held or link.ghost == 0:
            _line(zones, link.axis, min(link.ghost, zones.shape[link.axis] - 1))[:] = 0.0
    part, share = _part(grid, rows, columns), _shares(rows, columns, links, held)
    return Reduction(grid, part, rows, columns, tuple(links), tuple(held), share, zones, copies, *images)


def _line(field: np.ndarray, axis: int, line: int) -> np.ndarray:
    """One mesh line of a field, a view."""
    return field[line] if axis == 0 else field[:, line]


def _part(grid: Grid, rows: np.ndarray, columns: np.ndarray) -> Grid:
    """The open mesh of some rows and columns of a mesh; what holds its edges stands with the whole mesh."""
    xi, eta = (np.linspace(0.0, 1.0, len(lines)) for lines in (rows, columns))
    return Grid(
        grid.shape, np.ascontiguousarray(grid.u[rows][:, columns]), False, {}, xi, eta, grid.length_mm
    )


def _sources(
    grid: Grid, part: Grid, owned: np.ndarray, group: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Where every node of the whole mesh has its image in the part, and the map from there."""
    inside = np.flatnonzero(owned)
    nodes = cKDTree(grid.u.reshape(-1, 2))
    source = np.full(grid.nodes, -1)
    turn = np.empty((grid.nodes, 3, 3))
    for element in group:
        found = nodes.query(part.u.reshape(-1, 2)[inside] @ element[:2, :2].T)
        distance, places = np.asarray(found[0]), np.asarray(found[1])
        if distance.max() > ROUND * grid.length_mm:
            raise GridError("the mesh does not have the symmetry that is asked of it")
        new = source[places] < 0
        source[places[new]], turn[places[new]] = inside[new], element
    if (source < 0).any():
        raise GridError("the images of the part do not cover the sheet")
    return source, turn
