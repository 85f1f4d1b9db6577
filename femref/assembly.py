"""Energy, gradient and Hessian of a sheet of bicubic elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import bsr_array, csc_array

from femref import elements
from femref.bicubic import KINDS, Mesh
from femref.koiter import moduli

BLOCK = 3 * KINDS  # unknowns of a node


@dataclass(frozen=True)
class SheetEnergy:
    """The Koiter energy of a sheet as a function of its nodal values q (ni, nj, 4, 3), mm.

    young_MPa, poisson, thickness_mm : of the sheet. bending : whether its energy has that part.
    load : (ni, nj, 4, 3) N, a dead load: its potential -load . q is part of the energy. None for no load.
    """

    mesh: Mesh
    young_MPa: float
    poisson: float
    thickness_mm: float
    bending: bool = True
    load: np.ndarray | None = None

    @cached_property
    def _moduli(self) -> np.ndarray:
        return moduli(self.young_MPa, self.poisson, self.thickness_mm)

    @cached_property
    def _tables(self) -> tuple[np.ndarray, ...]:
        along_x, along_y = self.mesh.axis_tables
        radius = along_y.place if self.mesh.polar else np.ones_like(along_y.place)
        return along_x.values, along_y.values, along_x.weight, along_y.weight, radius

    @cached_property
    def _pattern(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return _block_pattern(self.mesh)

    def energy(self, q: np.ndarray) -> np.ndarray:
        """(2,) N mm: membrane and bending, without the potential of the load."""
        return elements.energy(q, self._tables, self._moduli, not self.bending)

    def value(self, q: np.ndarray) -> float:
        """What is least in equilibrium: the energy and the potential of the load, N mm."""
        work = 0.0 if self.load is None else float((self.load * q).sum())
        return float(self.energy(q).sum()) - work

    def gradient(self, q: np.ndarray) -> np.ndarray:
        """Derivative of `value`, (ni, nj, 4, 3) N."""
        gradient = np.zeros_like(q)
        elements.add_gradient(q, self._tables, self._moduli, not self.bending, gradient)
        return gradient if self.load is None else gradient - self.load

    def hessian(self, q: np.ndarray) -> bsr_array:
        """Second derivative, N/mm, with blocks of one node each; unknowns in the order of q.ravel()."""
        pointers, columns, places = self._pattern
        data = np.zeros((len(columns), BLOCK, BLOCK))
        elements.add_hessian(q, self._tables, self._moduli, not self.bending, places, data)
        return bsr_array((data, columns, pointers), shape=(q.size, q.size))

    @cached_property
    def mass(self) -> csc_array:
        """Matrix of the integral of |r|^2, mm^2, in the order of q.ravel()."""
        pointers, columns, places = self._pattern
        data = np.zeros((len(columns), BLOCK, BLOCK))
        elements.add_mass(self._tables, places, data)
        return bsr_array((data, columns, pointers)).tocsc()


def _block_pattern(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Row pointers and columns of the node blocks, and the block (ex, ey, 4, 4) of every pair of element nodes."""
    ni, nj = mesh.shape
    ex, ey = (len(breaks) - 1 for breaks in mesh.breaks)
    i, j = np.meshgrid(np.arange(ex), np.arange(ey), indexing="ij")
    nodes = np.stack([(i + a) % ni * nj + j + b for a in range(2) for b in range(2)], axis=-1)
    pairs = nodes[..., :, None] * (ni * nj) + nodes[..., None, :]
    unique, places = np.unique(pairs, return_inverse=True)
    pointers = np.searchsorted(unique // (ni * nj), np.arange(ni * nj + 1)).astype(np.int32)
    columns = (unique % (ni * nj)).astype(np.int32)
    return pointers, columns, places.reshape(pairs.shape).astype(np.int64)
