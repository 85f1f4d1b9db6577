"""The published scheme as a force that the relaxation engine takes: the kernel, its mesh with ghosts, their motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from fdsolver import membrane, published
from fdsolver.effects import Force
from fdsolver.grid import Grid, GridError
from fdsolver.material import Sheet
from fdsolver.published_ghosts import FOLDED, RATE, GhostLayer
from fdsolver.rows import MOST_COLUMNS, PITCH

VARIANTS = ("printed", "filtered", "stabilised")
WALL = 1e6  # energy / (Y h L^2) of a state whose ghost rows are folded: no relaxation may go there


@dataclass(frozen=True)
class PublishedForce(Force):
    """Force of the published scheme on one mesh with its ghost layer, in the engine's scaled units.

    Arrays of nodes are (..., ni + 2, nj + 2), those of zones (..., ni + 1, nj + 1). What `Force` has is there for
    `mass.nodal_masses`: the stiffness of the conservative plate, whose curvatures bound those of this scheme; exterior
    zones have no area.
    bending : (h / L)^2 / 12. geometry : zone constants, exterior ones included. areas : (2, ...), 1 / A [53] and area
        of the sheet at the node. hourglass : stiffness of the zones, 0 unless stabilised.
    row_edges, column_edges : normals and moments of the edges at the last evaluation (`published.band`).
    """

    bending: float
    geometry: np.ndarray
    areas: np.ndarray
    hourglass: np.ndarray
    stabilised: bool
    ghosts: GhostLayer
    row_edges: np.ndarray
    column_edges: np.ndarray

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        """Write Sigma / 2 [55, 77] into f, 0 at ghosts; return the (membrane, bending, hourglass) energy.

        r, f : (3, ni + 2, nj + 2) float64, C-contiguous. A state whose ghost rows zigzag by more than `FOLDED` has
        the bending energy `WALL`, which ends a run as diverged.
        """
        threads = self.scratch.shape[0]
        fields = (r.reshape(-1), f.reshape(-1), self.geometry.reshape(-1), self.areas.reshape(-1))
        mesh = (self.hourglass.reshape(-1), self.row_energy, self.rows, self.columns)
        place = (0, self.rows, self.scratch[0]) if threads == 1 else (self.scratch,)
        edges = (self.row_edges, self.column_edges)
        evaluate = published.band if threads == 1 else published.bands
        evaluate(self.law, self.bending, self.stabilised, *fields, *mesh, *place, *edges)
        published.add_edge_tractions(f, *edges)
        energy = self.row_energy.sum(axis=1)
        if max(self.ghosts.roughness(r)) > FOLDED:
            energy[1] += WALL
        return energy

    def follow(self, r: np.ndarray, v: np.ndarray) -> None:
        """Move the ghosts of r by one step [74] after the sheet's own step, whose velocities are v."""
        self.ghosts.follow(r, v, self.row_edges, self.column_edges)


def extended(grid: Grid) -> Grid:
    """The reference mesh with its ghosts, which continue the mesh lines by the spacing at the edge.

    Raises GridError for meshes that are not rectangles with mesh lines along their sides.
    """
    u = grid.u
    tensor = np.array_equal(u[..., 0], u[:, :1, 0] + 0.0 * u[..., 0])
    tensor &= np.array_equal(u[..., 1], u[:1, :, 1] + 0.0 * u[..., 1])
    if grid.shape != "rectangle" or not tensor:
        raise GridError(
            f"the published scheme is solved on rectangles, not on the shape {grid.shape}: the paper gives its ghost"
            " layer, corners included, for straight edges along the mesh lines only"
        )
    x, y = u[:, 0, 0], u[0, :, 1]
    x, y = (np.concatenate([[2 * s[0] - s[1]], s, [2 * s[-1] - s[-2]]]) for s in (x, y))
    wide = np.ascontiguousarray(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1))
    xi, eta = np.linspace(0.0, 1.0, len(x)), np.linspace(0.0, 1.0, len(y))
    return Grid("rectangle", wide, False, {}, xi, eta, grid.length_mm)


def contour_area(u: np.ndarray) -> np.ndarray:
    """A of [53] at the inner nodes of a mesh: half the quadrilateral of the neighbours. u : (ni, nj, 2)."""
    across, along = u[2:, 1:-1] - u[:-2, 1:-1], u[1:-1, 2:] - u[1:-1, :-2]
    return 0.25 * (across[..., 0] * along[..., 1] - across[..., 1] * along[..., 0])


def build_published(
    grid: Grid, sheet: Sheet, supports: Mapping[str, str], plain: Force, variant: str
) -> PublishedForce:
    """Return the published scheme on a mesh.

    supports : edge name -> "free", "pinned" or "clamped". plain : the conservative plate on the same mesh.
    variant : "printed", "filtered" (ghost lines filtered) or "stabilised" (and with a stiffness against checkerboards).

    Raises ValueError for another variant and for rows longer than the kernel's scratch, GridError from `extended`.
    """
    if variant not in VARIANTS:
        raise ValueError(f"the published scheme is {', '.join(VARIANTS)}, not {variant!r}")
    if grid.nj + 2 > MOST_COLUMNS:
        raise ValueError(f"a mesh line has {grid.nj} nodes; the kernel takes at most {MOST_COLUMNS - 2}")
    assert plain.node is not None and plain.twist is not None, "a plate has bending constants"
    wide = extended(grid)
    geometry = membrane.zone_constants(wide)
    zone = geometry.copy()
    zone[4] = np.pad(zone[4, 1:-1, 1:-1], 1)
    bending = (sheet.thickness_mm / grid.length_mm) ** 2 / 12.0
    stiffness = np.zeros_like(zone[4])
    if variant == "stabilised":
        stiffness[1:-1, 1:-1] = hourglass_stiffness(grid, bending / (1.0 - sheet.poisson**2))
    areas = np.zeros((2, *wide.u.shape[:2]))
    areas[0, 1:-1, 1:-1] = grid.length_mm**2 / contour_area(wide.u)
    areas[1, 1:-1, 1:-1] = grid.node_area / grid.length_mm**2
    twist = np.pad(plain.twist, ((0, 0), (1, 1), (1, 1)))
    twist[0] += 0.25 * stiffness
    inherited = {field.name: getattr(plain, field.name) for field in fields(Force)}
    inherited |= {
        "rows": grid.ni + 2,
        "columns": grid.nj + 2,
        "zone": zone,
        "node": np.pad(plain.node, ((0, 0), (1, 1), (1, 1))),
        "twist": twist,
        "scratch": np.zeros((plain.scratch.shape[0], published.SLOTS * PITCH)),
        "row_energy": np.zeros((3, grid.ni + 2)),
    }
    return PublishedForce(
        **inherited,
        bending=bending,
        geometry=geometry,
        areas=areas,
        hourglass=stiffness,
        stabilised=variant == "stabilised",
        ghosts=ghost_layer(grid, sheet, supports, filtered=variant != "printed"),
        row_edges=np.zeros((2, 7, grid.nj + 2)),
        column_edges=np.zeros((2, 7, grid.ni + 2)),
    )


def hourglass_stiffness(grid: Grid, stiffness: float) -> np.ndarray:
    """D dx dy (1/dx^2 + 1/dy^2)^2 / 4 of every zone, scaled: what a node second difference of its size would have.

    stiffness : D, scaled. Returns (ni - 1, nj - 1) float64.
    """
    dx = np.diff(grid.u[:, 0, 0])[:, None] / grid.length_mm
    dy = np.diff(grid.u[0, :, 1])[None, :] / grid.length_mm
    return stiffness * dx * dy * (dx**-2 + dy**-2) ** 2 / 4.0


def ghost_layer(grid: Grid, sheet: Sheet, supports: Mapping[str, str], filtered: bool) -> GhostLayer:
    """The ghosts of a rectangle: spacings, rates and supports of its four edges."""
    stiffness = (sheet.thickness_mm / grid.length_mm) ** 2 / 12.0 / (1.0 - sheet.poisson**2)

    def edges(across: np.ndarray, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        spacing = np.abs(np.array([across[1] - across[0], across[-1] - across[-2]]))
        steps = np.pad(np.diff(along), 1, mode="edge")
        short = np.minimum(steps[:-1], steps[1:])
        growth = np.maximum(abs(sheet.poisson) * (spacing[:, None] / short) ** 2, 1.0)
        rate = RATE / growth ** (2 if filtered else 1)
        return np.pad(rate * spacing[:, None] ** 2 / stiffness, ((0, 0), (1, 1))), spacing

    x, y = grid.u[:, 0, 0] / grid.length_mm, grid.u[0, :, 1] / grid.length_mm
    row_rate, row_spacing = edges(x, y)
    column_rate, column_spacing = edges(y, x)
    clamped = {name: supports.get(name) == "clamped" for name in ("left", "right", "bottom", "top")}
    return GhostLayer(
        row_rate=row_rate,
        column_rate=column_rate,
        row_spacing=row_spacing,
        column_spacing=column_spacing,
        row_clamped=(clamped["left"], clamped["right"]),
        column_clamped=(clamped["bottom"], clamped["top"]),
        filtered=filtered,
    )
