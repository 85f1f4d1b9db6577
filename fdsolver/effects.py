"""Specialised kernels: the force of a model on a mesh, compiled with just the effects that are on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numba
import numpy as np

from fdsolver import membrane, plate
from fdsolver.curvature import curvature_constants
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import Model
from fdsolver.rows import MOST_COLUMNS, PITCH, threaded


@threaded
def membrane_bands(law, r, f, zone, energy, rows, columns, closed, scratch):
    """`membrane.band` on as many bands of rows as there are scratch arrays, one thread each."""
    bands = scratch.shape[0]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        membrane.band(law, r, f, zone, energy, rows, columns, closed, start, stop, scratch[k])


@threaded
def plate_bands(law, r, f, zone, energy, rows, columns, closed, scratch, node, twist):
    """`plate.band` on as many bands of rows as there are scratch arrays, one thread each."""
    bands = scratch.shape[0]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        plate.band(law, r, f, zone, energy, rows, columns, closed, start, stop, scratch[k], node, twist)


@dataclass(frozen=True)
class Force:
    """Force and energy of a model on one mesh, in scaled units (lengths / L, stresses / Y).

    law : membrane law; relaxed : whether it carries no compression.
    zone : (5, zone rows, nj - 1) float64 of `membrane.zone_constants`.
    node : (8, ni, nj), twist : (4, zone rows, nj - 1) float64, constants of `plate`; None: bending is off.
    scratch : (threads, ...) float64, one flat array per thread.
    """

    law: tuple
    relaxed: bool
    rows: int
    columns: int
    closed: bool
    zone: np.ndarray
    node: np.ndarray | None
    twist: np.ndarray | None
    scratch: np.ndarray
    row_energy: np.ndarray

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        """Write the force -dE/dr on every node into f; return the (membrane, bending, hourglass) energy.

        r, f : (3, ni, nj) float64, C-contiguous. The energies are summed by rows in order: same bits for any
        number of threads.
        """
        threads = self.scratch.shape[0]
        mesh = (self.zone.reshape(-1), self.row_energy, self.rows, self.columns, self.closed)
        place = (0, self.rows, self.scratch[0]) if threads == 1 else (self.scratch,)
        if self.node is None or self.twist is None:
            evaluate = membrane.band if threads == 1 else membrane_bands
            evaluate(self.law, r.reshape(-1), f.reshape(-1), *mesh, *place)
        else:
            evaluate = plate.band if threads == 1 else plate_bands
            bending = (self.node.reshape(-1), self.twist.reshape(-1))
            evaluate(self.law, r.reshape(-1), f.reshape(-1), *mesh, *place, *bending)
        return self.row_energy.sum(axis=1)


def build_force(
    grid: Grid, sheet: Sheet, model: Model, supports: Mapping[str, str], threads: int = 1
) -> Force:
    """Return the force of a model on a mesh, specialised to its effects.

    supports : edge name -> "free", "pinned" or "clamped". threads : bands of rows that run side by side.

    Raises ValueError for rows longer than the kernels' scratch, and from `curvature_constants`.
    """
    if grid.nj > MOST_COLUMNS:
        raise ValueError(f"a mesh line has {grid.nj} nodes; the kernels take at most {MOST_COLUMNS}")
    node, twist, slots = None, None, membrane.SLOTS
    if model.bending:
        k = curvature_constants(grid, sheet, supports)
        node = plate.node_constants(k)
        twist, slots = np.concatenate([k.C33[None], plate.hourglass_constants(grid)]), plate.SLOTS
    return Force(
        law=model.law(sheet.poisson),
        relaxed=model.relaxed,
        rows=grid.ni,
        columns=grid.nj,
        closed=grid.closed,
        zone=membrane.zone_constants(grid),
        node=node,
        twist=twist,
        scratch=np.zeros((threads, slots * PITCH)),
        row_energy=np.zeros((3, grid.ni)),
    )
