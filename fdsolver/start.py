"""The start of a relaxation: edge movements carried smoothly into the sheet, and the random perturbation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid, GridError
from fdsolver.membrane import zone_constants
from fdsolver.transfer import prolong

SAME_SIZE = 1e-2  # of the sheet: the outermost nodes of a coarse ring lie beside the axes


def fixed_nodes(grid: Grid, edges: Mapping[str, EdgeCondition]) -> np.ndarray:
    """(ni, nj) bool: nodes on pinned or clamped edges."""
    fixed = np.zeros((grid.ni, grid.nj), dtype=bool)
    for name, condition in edges.items():
        if condition.support != "free":
            fixed[tuple(grid.edges[name].T)] = True
    return fixed


def moved(u: np.ndarray, grow: np.ndarray, turn: np.ndarray, move: np.ndarray) -> np.ndarray:
    """Positions u grown radially, turned about the z axis and translated.

    u : (..., 2) mm. grow : (...) mm. turn : (...) rad. move : (..., 3) mm. Returns (..., 3) mm.
    """
    radius = np.linalg.norm(u, axis=-1)
    x, y = np.moveaxis(u * (1.0 + grow / np.where(radius > 0.0, radius, 1.0))[..., None], -1, 0)
    turned = np.stack(
        [x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn), 0.0 * x], axis=-1
    )
    return turned + move


def smooth_start(grid: Grid, edges: Mapping[str, EdgeCondition]) -> np.ndarray:
    """Positions in which the movements of the supported edges fade harmonically into the sheet.

    The growth, the angle and the translation are each harmonic in the reference plane, so a uniform pull starts
    from an affine state and a twist from a twisted, not a shrunken, sheet. Returns (ni, nj, 3) float64, mm.
    """
    fixed, given = _movements(grid, edges)
    parameters = _harmonic(grid, fixed, given) if fixed.any() else given
    return _moved_by(grid, parameters)


def held_positions(grid: Grid, edges: Mapping[str, EdgeCondition]) -> np.ndarray:
    """Where the edges hold their nodes: (ni, nj, 3) float64, mm, of which the rows of other nodes mean nothing."""
    return _moved_by(grid, _movements(grid, edges)[1])


def _moved_by(grid: Grid, parameters: np.ndarray) -> np.ndarray:
    return moved(grid.u, parameters[..., 0], parameters[..., 1], parameters[..., 2:])


def _movements(grid: Grid, edges: Mapping[str, EdgeCondition]) -> tuple[np.ndarray, np.ndarray]:
    """The supported nodes (ni, nj), and growth, angle and translation (ni, nj, 5) there, mm and rad.

    Where two supported edges meet, the first named one decides.
    """
    given = np.zeros((grid.ni, grid.nj, 5))
    fixed = np.zeros((grid.ni, grid.nj), dtype=bool)
    for name, condition in edges.items():
        if condition.support == "free":
            continue
        nodes = tuple(grid.edges[name].T)
        new = ~fixed[nodes]
        nodes = (nodes[0][new], nodes[1][new])
        given[nodes] = (condition.grow_mm, np.radians(condition.rotate_deg), *condition.move_mm)
        fixed[nodes] = True
    return fixed, given


def carried_start(grid: Grid, edges: Mapping[str, EdgeCondition], source: Grid, r: np.ndarray) -> np.ndarray:
    """Positions of another state of the same sheet, with the edges where these conditions want them.

    source, r : mesh and (source.ni, source.nj, 3) positions, mm, of that state. What the supported edges move further
    is carried harmonically into the sheet, so that a state found at one pull starts the run at another.

    Returns (ni, nj, 3) float64, mm. Raises GridError if the two meshes are not of one sheet.
    """
    differ = np.abs(_extent(grid) - _extent(source)) > SAME_SIZE * _extent(grid)
    if grid.shape != source.shape or differ.any():
        raise GridError(
            f"the start is a {source.shape} of {_described(source)}, the scene a {grid.shape} of {_described(grid)}"
        )
    flat = np.zeros((source.ni, source.nj, 3))
    flat[..., :2] = source.u
    carried = prolong(r - flat, source, grid)
    carried[..., :2] += grid.u
    fixed = fixed_nodes(grid, edges)
    if not fixed.any():
        return carried
    missing = np.where(fixed[..., None], held_positions(grid, edges) - carried, 0.0)
    return carried + _harmonic(grid, fixed, missing)


def _extent(grid: Grid) -> np.ndarray:
    """(2,) mm, size of the mesh along x and y."""
    return np.ptp(grid.u.reshape(-1, 2), axis=0)


def _described(grid: Grid) -> str:
    width, height = _extent(grid)
    return f"{width:.6g} x {height:.6g} mm"


def _harmonic(grid: Grid, fixed: np.ndarray, given: np.ndarray) -> np.ndarray:
    """Extend nodal values (ni, nj, k) from the fixed nodes so that the sum of A |grad|^2 over the zones is least."""
    g1x, g1y, g2x, g2y, area = zone_constants(grid).reshape(5, -1)
    number = np.arange(grid.ni * grid.nj).reshape(grid.ni, grid.nj)
    far = np.roll(number, -1, axis=0) if grid.closed else number[1:]
    near = number if grid.closed else number[:-1]
    corners = np.stack([near[:, :-1], far[:, :-1], far[:, 1:], near[:, 1:]]).reshape(4, -1)
    zones = np.arange(area.size)
    root = np.sqrt(area)
    rows = []
    for first, second in ((g1x, g2x), (g1y, g2y)):
        weights = root * np.stack([-first, -second, first, second])
        rows.append(
            coo_matrix((weights.ravel(), (np.tile(zones, 4), corners.ravel())), (zones.size, number.size))
        )
    stiffness = sum((g.T @ g for g in rows), start=0.0 * (rows[0].T @ rows[0])).tocsc()
    # The zone gradient does not see a checkerboard; where supports leave it free this picks the smooth extension.
    free, values = ~fixed.ravel(), given.reshape(number.size, -1).copy()
    shift = 1e-12 * stiffness.diagonal().max()
    inner = stiffness[free][:, free]
    inner.setdiag(inner.diagonal() + shift)
    values[free] = splu(inner.tocsc()).solve(-np.ascontiguousarray(stiffness[free][:, ~free] @ values[~free]))
    return values.reshape(given.shape)


def perturb(r: np.ndarray, grid: Grid, fixed: np.ndarray, amplitude: float, seed: int) -> np.ndarray:
    """Add a random out-of-plane displacement, uniform in (-1, 1) amplitude L, at the free nodes.

    r : (ni, nj, 3) mm. amplitude : in units of grid.length_mm. Returns a new array.
    """
    noise = np.random.default_rng(seed).uniform(-1.0, 1.0, fixed.shape)
    perturbed = r.copy()
    perturbed[..., 2] += np.where(fixed, 0.0, amplitude * grid.length_mm * noise)
    return perturbed
