"""Small meshes of every kind for tests of the discrete operators."""

from __future__ import annotations

import dataclasses

import numpy as np

from fdsolver import meshes
from fdsolver.grid import Grid


def jittered(grid: Grid, share: float, seed: int) -> Grid:
    """The mesh with every node off the edges moved at random by up to `share` of its cell's size."""
    random = np.random.default_rng(seed)
    moved = random.uniform(-share, share, grid.u.shape) * np.sqrt(grid.node_area)[..., None]
    return dataclasses.replace(
        grid, u=np.ascontiguousarray(grid.u + np.where(inside(grid)[..., None], moved, 0.0))
    )


def sheared(grid: Grid, tangent: float) -> Grid:
    """The mesh with every node moved by tangent * y along x: a parallelogram of skewed zones."""
    return dataclasses.replace(grid, u=np.ascontiguousarray(grid.u @ np.array([[1.0, 0.0], [tangent, 1.0]])))


def inside(grid: Grid) -> np.ndarray:
    """(ni, nj) bool: nodes that are on no edge of the sheet."""
    result = np.ones(grid.u.shape[:2], dtype=bool)
    result[:, [0, -1]] = False
    if not grid.closed:
        result[[0, -1]] = False
    return result


def small_meshes() -> dict[str, Grid]:
    """One mesh of each kind, about 110 nodes."""
    rectangle = meshes.rectangle(20.0, 12.0, 110)
    annulus = meshes.annulus(60.0, 250.0, 110)
    return {
        "uniform": rectangle,
        "biased": meshes.rectangle(20.0, 12.0, 110, bias=1.5),
        "skewed": sheared(rectangle, 0.6),
        "jittered": jittered(rectangle, 0.2, seed=1),
        "annulus": annulus,
        "jittered annulus": jittered(annulus, 0.2, seed=2),
        "hole": meshes.rectangle_with_hole(125.0, 50.0, 15.0, 150),
    }
