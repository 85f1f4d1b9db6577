"""Specialised kernels: the force of a model on a mesh, compiled with just the effects that are on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fdsolver import membrane, membrane_plane, plate, plate_linear, plate_plane
from fdsolver.bands import (
    membrane_bands,
    plane_bands,
    plate_bands,
    plate_linear_bands,
    plate_plane_bands,
)
from fdsolver.curvature import curvature_constants
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import Model
from fdsolver.moderate import under_moderate_rotation
from fdsolver.rows import MOST_COLUMNS, PITCH


@dataclass(frozen=True)
class Kernel:
    """One specialisation. band : on one thread; bands : on several. slots : rows of scratch that a thread needs."""

    band: Callable[..., None]
    bands: Callable[..., None]
    slots: int


# by number of displacement components, whether it is a plate, and kind of curvature; the kinematics come with the type
# of the law
KERNELS = {
    (2, False, "none"): Kernel(membrane_plane.band, plane_bands, membrane_plane.SLOTS),
    (2, True, "none"): Kernel(plate_plane.band, plate_plane_bands, plate_plane.SLOTS),
    (3, False, "none"): Kernel(membrane.band, membrane_bands, membrane.SLOTS),
    (3, True, "linear"): Kernel(plate_linear.band, plate_linear_bands, plate_linear.SLOTS),
    (3, True, "full"): Kernel(plate.band, plate_bands, plate.SLOTS),
}


@dataclass(frozen=True)
class Force:
    """Force and energy of a model on one mesh, in scaled units (lengths / L, stresses / Y).

    law : membrane law; relaxed : whether it carries no compression. components : 2 in the plane, 3 in space.
    zone : (5, zone rows, nj - 1) float64 of `membrane.zone_constants`.
    node, twist : float64 constants of `plate` or `plate_linear`; node None: nothing is curved. In its plane a plate
        keeps of twist the three fields of `plate.hourglass_constants`; None: no plate.
    bound : (ni, nj) float64, stiffness bound of a linear curvature; None where it depends on the state or is off.
    scratch : (threads, ...) float64, one flat array per thread.
    """

    kernel: Kernel
    law: tuple
    relaxed: bool
    components: int
    rows: int
    columns: int
    closed: bool
    zone: np.ndarray
    node: np.ndarray | None
    twist: np.ndarray | None
    bound: np.ndarray | None
    scratch: np.ndarray
    row_energy: np.ndarray

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        """Write the force -dE/dr on every node into f; return the (membrane, bending, hourglass) energy.

        r, f : (components, ni, nj) float64, C-contiguous. The energies are summed by rows in order: same bits for any
        number of threads.
        """
        threads = self.threads
        mesh = (self.zone.reshape(-1), self.row_energy, self.rows, self.columns, self.closed)
        place = (0, self.rows, self.scratch[0]) if threads == 1 else (self.scratch,)
        evaluate = self.kernel.band if threads == 1 else self.kernel.bands
        constants: list[np.ndarray | None] = [
            part.reshape(-1) for part in (self.node, self.twist) if part is not None
        ]
        if self.bound is not None and self.node is not None:
            constants.append(self.node[7:].reshape(-1) if len(self.node) > 7 else None)
        evaluate(self.law, r.reshape(-1), f.reshape(-1), *mesh, *place, *constants)
        return self.row_energy.sum(axis=1)

    @property
    def threads(self) -> int:
        """Bands of rows that run side by side."""
        return self.scratch.shape[0]

    @property
    def local(self) -> bool:
        """Whether the force on a node depends on nodes a few mesh lines away only."""
        return True

    def fold_stiffness(self, stiffness: np.ndarray) -> None:
        """Give the stiffness bounds of ghost nodes to the nodes that they follow; there are none here."""

    def hold(self, field: np.ndarray) -> None:
        """Put zero where a line of symmetry holds a component of a field (components, ni, nj); it holds none here."""

    def complete(self, field: np.ndarray) -> None:
        """Put the images of a field (components, ni, nj) on the ghost nodes of a symmetry; there are none here."""


def build_force(
    grid: Grid, sheet: Sheet, model: Model, supports: Mapping[str, str], threads: int = 1
) -> Force:
    """Return the force of a model on a mesh, specialised to its effects.

    supports : edge name -> "free", "pinned" or "clamped". threads : bands of rows that run side by side.

    Raises ValueError for rows longer than the kernels' scratch, and from `curvature_constants`.
    """
    if grid.nj > MOST_COLUMNS:
        raise ValueError(f"a mesh line has {grid.nj} nodes; the kernels take at most {MOST_COLUMNS}")
    law: tuple = model.law(sheet.poisson)
    node, twist, bound = None, None, None
    if model.curvature != "none":
        k = curvature_constants(grid, sheet, supports)
        twist = np.concatenate([k.C33[None], plate.hourglass_constants(grid)])
        node = (
            plate.node_constants(k) if model.curvature == "full" else plate_linear.linear_constants(grid, k)
        )
    elif model.bending:
        twist = plate.hourglass_constants(grid)
    if node is not None and twist is not None and model.curvature == "linear":
        bound = plate_linear.stiffness_bound(node, twist, grid.closed)
    kernel = KERNELS[model.components, model.bending, model.curvature]
    return Force(
        kernel=kernel,
        law=under_moderate_rotation(law) if model.moderate else law,
        relaxed=model.relaxed,
        components=model.components,
        rows=grid.ni,
        columns=grid.nj,
        closed=grid.closed,
        zone=membrane.zone_constants(grid),
        node=node,
        twist=twist,
        bound=bound,
        scratch=np.zeros((threads, kernel.slots * PITCH)),
        row_energy=np.zeros((3, grid.ni)),
    )
