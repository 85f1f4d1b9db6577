"""Bending and geometric stiffness of a Kirchhoff plate, per unit of Y h, lengths in units of L.

bending    h^2/(12 L^2) integral of  c tr(k) tr(k') + 2 mu k : k' ,   k = second derivatives of w
geometric  integral of  S_ab w,a w',b                               S in units of Y
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, csr_array
from skfem import Basis, BilinearForm
from skfem.helpers import ddot, trace

from femref.plate_elements import ELEMENTS, PlateElement
from femref.sheet_mesh import PlateMaterial, SheetMesh
from femref.supports import free_combinations

# exact for second derivatives of quintics times themselves, and for slopes of quintics times linear stresses but one
_INTEGRATION = {"argyris": 8, "bogner-fox-schmit": 6, "morley": 4}


@dataclass(frozen=True)
class PlateSpace:
    """Deflections of a supported sheet.

    sheet : mesh. material : of the plate. supports : edge name -> "free", "pinned" or "clamped".
    element : "argyris", "morley" (triangles) or "bogner-fox-schmit" (rectangles).
    """

    sheet: SheetMesh
    material: PlateMaterial
    supports: Mapping[str, str]
    element: str = "argyris"

    @cached_property
    def basis(self) -> Basis:
        """The scikit-fem basis of the plate element."""
        plate: PlateElement = ELEMENTS[self.element]()
        return Basis(self.sheet.mesh, plate, intorder=_INTEGRATION[self.element], disable_doflocs=True)

    @cached_property
    def free(self) -> csr_array:
        """Z (unknowns, free): w = Z q meets the supports."""
        return free_combinations(self.sheet, self.basis, self.supports)

    @property
    def points(self) -> tuple[np.ndarray, np.ndarray]:
        """Local quadrature points and weights, where stresses are wanted."""
        return self.basis.X, self.basis.W

    def reduce(self, matrix: csr_array) -> csc_array:
        """Z^T matrix Z."""
        return csc_array(self.free.T @ matrix @ self.free)

    def vertex_heights(self, q: np.ndarray) -> np.ndarray:
        """(vertices, ...) deflections at the vertices of free unknowns q (free, ...)."""
        return (self.free @ q)[self.basis.dofs.nodal_dofs[0]]


def bending_stiffness(space: PlateSpace) -> csc_array:
    """(free, free) bending stiffness of the flat, unstrained plate."""
    material = space.material
    c, two_mu, scale = material.c, material.two_mu, material.bending(space.sheet.length_mm)

    @BilinearForm
    def form(w, v, _):  # type: ignore[no-untyped-def]
        return scale * (c * trace(w.hess) * trace(v.hess) + two_mu * ddot(w.hess, v.hess))

    return space.reduce(csr_array(form.assemble(space.basis)))


def geometric_stiffness(space: PlateSpace, stress: np.ndarray) -> csc_array:
    """(free, free) stiffness of the stress, times the deflection's slopes.

    stress : (2, 2, cells, points) in units of Y at `space.points`, or (2, 2) of a homogeneous state.
    """
    cells, points = space.basis.dx.shape
    everywhere = np.broadcast_to(
        stress if stress.ndim == 4 else stress[:, :, None, None], (2, 2, cells, points)
    )

    @BilinearForm
    def form(w, v, data):  # type: ignore[no-untyped-def]
        s = data["stress"]
        (wx, wy), (vx, vy) = w.grad, v.grad
        return s[0, 0] * wx * vx + s[0, 1] * (wx * vy + wy * vx) + s[1, 1] * wy * vy

    return space.reduce(csr_array(form.assemble(space.basis, stress=everywhere)))
