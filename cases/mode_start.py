"""A buckling mode as the start of a relaxation, as Zheng (2009) starts from an eigenmode instead of at random."""

from __future__ import annotations

import numpy as np

from cases.buckling import solve_level
from cases.finite_elements import default_vertices
from cases.methods import MethodError
from cases.schema import Scene
from cases.unstructured import FiniteElementMesh
from cases.unstructured_probe import locate
from fdsolver.grid import Grid

# height of the mode, in thicknesses: enough to choose the wrinkles, too little to strain the sheet
AMPLITUDE = 1.0
_COARSER = 4
# interpolation between vertices is linear: more nodes than this would only repeat it
MOST_NODES = 5000


def mode_state(scene: Scene, number: int) -> tuple[Grid, np.ndarray]:
    """A structured mesh and the positions (ni, nj, 3) mm on it: the sheet under its load, flat and linear, and lifted
    by a buckling mode of one thickness.

    number : of the mode, 1 for the smallest positive factor.

    Raises MethodError if the sheet does not buckle, or not into so many modes as were looked for.
    """
    from cases.boundary import grid_of
    from femref.buckle import NoBuckling
    from femref.inertia import NotCertified
    from femref.parity import parities
    from femref.prestress import NoPrestress

    vertices = scene.mesh.vertices or default_vertices(scene)
    try:
        coarse = solve_level(scene, max(vertices // _COARSER, 100), None)
        found = solve_level(scene, vertices, coarse.factors.factor)
    except (NoBuckling, NoPrestress, NotCertified) as reason:
        raise MethodError(f"start.from = 'mode:{number}': {reason}") from reason
    modes = parities(found.sheet.mesh, found.factors.factor, found.modes).modes
    if number > modes.shape[1]:
        raise MethodError(f"start.from = 'mode:{number}': there are {modes.shape[1]} modes to start from.")
    mode = modes[:, number - 1] / np.abs(modes[:, number - 1]).max()
    lifted = np.column_stack([found.state.displacement_mm, AMPLITUDE * scene.sheet.thickness_mm * mode])
    grid = grid_of(scene)(min(scene.mesh.nodes, MOST_NODES))
    mesh = FiniteElementMesh(scene.sheet.shape, found.sheet.positions_mm, found.sheet.cells)
    r = np.zeros((grid.nodes, 3))
    r[:, :2] = grid.u.reshape(-1, 2)
    r += interpolated(mesh, lifted, r[:, :2])
    return grid, r.reshape(grid.ni, grid.nj, 3)


def interpolated(mesh: FiniteElementMesh, values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(k, ...) values at points (k, 2) from those (n, ...) at the vertices; beside a polygon those of its cells."""
    found = locate(mesh, points, everywhere=True)
    return np.einsum("kv,kv...->k...", found.weight, values[found.vertices])
