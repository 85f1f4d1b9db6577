"""The start of a relaxation: edge movements carried smoothly into the sheet, and the random perturbation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.membrane import zone_constants


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
    from an affine state and a twist from a twisted, not a shrunken, sheet. Where two supported edges meet, the first
    named one decides. Returns (ni, nj, 3) float64, mm.
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
    parameters = _harmonic(grid, fixed, given) if fixed.any() else given
    return moved(grid.u, parameters[..., 0], parameters[..., 1], parameters[..., 2:])


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
