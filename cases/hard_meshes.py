"""Hard cases of the mesh: flat, skewed, jittered and suddenly graded cells, even and odd numbers of them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from cases.hard import Finding, HardCase, about, at_most
from cases.hard_engine import relax_from
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER, Model
from fdsolver.problem import Problem
from fdsolver.relax import Settings
from tensionfield.relaxed import TENSION_FIELD

FAMILY = "mesh"
SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=0.1)
WIDTH, HEIGHT = 100.0, 50.0  # mm
STRETCH = (
    1.08,
    1.03,
)  # along x and y, imposed on all four edges: every zone of any mesh must show just these
REASON = (
    "the edges impose an affine map, which is the equilibrium on any mesh, with its energy in closed form"
)


def lattice(x: np.ndarray, y: np.ndarray) -> Grid:
    """The rectangle's mesh with mesh lines at x and y, mm."""
    u = np.ascontiguousarray(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1))
    i, j = np.arange(x.size), np.arange(y.size)
    edges = {
        "left": np.stack([0 * j, j], axis=1),
        "right": np.stack([0 * j + i[-1], j], axis=1),
        "bottom": np.stack([i, 0 * i], axis=1),
        "top": np.stack([i, 0 * i + j[-1]], axis=1),
    }
    return Grid("rectangle", u, False, edges, i / i[-1], j / j[-1], WIDTH)


def uniform(rows: int, columns: int) -> Grid:
    """Equal cells."""
    return lattice(np.linspace(-0.5, 0.5, rows) * WIDTH, np.linspace(-0.5, 0.5, columns) * HEIGHT)


def suddenly_graded(ratio: float) -> Grid:
    """Cells that become `ratio` times wider from one mesh line to the next, at the middle."""
    left = np.linspace(-0.5 * WIDTH, 0.0, int(20 * ratio) + 1)
    return lattice(
        np.concatenate([left, np.linspace(0.0, 0.5 * WIDTH, 21)[1:]]), np.linspace(-0.5, 0.5, 21) * HEIGHT
    )


def inner_nodes_moved(grid: Grid, shift: Callable[[np.ndarray], np.ndarray]) -> Grid:
    """The mesh with its inner nodes moved by shift(u); the outline stays."""
    u = grid.u.copy()
    u[1:-1, 1:-1] += shift(grid.u)[1:-1, 1:-1]
    return dataclasses.replace(grid, u=u)


def jittered(share: float) -> Grid:
    """Inner nodes moved at random by up to `share` of a cell."""
    random = np.random.default_rng(7)
    return inner_nodes_moved(
        uniform(41, 21), lambda u: random.uniform(-share, share, u.shape) * (WIDTH / 40.0, HEIGHT / 20.0)
    )


def skewed(degrees: float) -> Grid:
    """A parallelogram whose cells have the smallest angle `degrees`."""
    grid = uniform(41, 21)
    slope = 1.0 / np.tan(np.radians(degrees))
    return dataclasses.replace(grid, u=np.ascontiguousarray(grid.u @ np.array([[1.0, 0.0], [slope, 1.0]])))


MESHES: Mapping[str, tuple[str, Callable[[], Grid]]] = {
    "cells-100-to-1": ("cells 100 times longer than wide", lambda: uniform(401, 5)),
    "cells-1-to-100": ("cells 100 times wider than long", lambda: uniform(9, 401)),
    "skew-15": ("cells skewed to 15 degrees", lambda: skewed(15.0)),
    "skew-45": ("cells skewed to 45 degrees", lambda: skewed(45.0)),
    "jitter-20": ("nodes jittered by up to 20 % of a cell", lambda: jittered(0.2)),
    "jitter-35": ("nodes jittered by up to 35 % of a cell", lambda: jittered(0.35)),
    "graded-10": ("cells suddenly 10 times wider", lambda: suddenly_graded(10.0)),
    "even-cells": ("an even number of mesh lines", lambda: uniform(40, 20)),
    "few-cells": ("two cells across", lambda: uniform(81, 3)),
}


def affine_energy() -> float:
    """Energy density of the tense affine state, Y / (2 (1 - nu^2)) (E1^2 + E2^2 + 2 nu E1 E2) per volume, N/mm^2."""
    e1, e2 = (0.5 * (stretch**2 - 1.0) for stretch in STRETCH)
    nu = SHEET.poisson
    return 0.5 * SHEET.young_MPa / (1.0 - nu**2) * (e1**2 + e2**2 + 2.0 * nu * e1 * e2)


def affine_finding(grid: Grid, model: Model) -> Finding:
    """Impose the affine map on the outline, start the inside from a shrunken state, and compare."""
    outline = {"outline": np.unique(np.concatenate(list(grid.edges.values())), axis=0)}
    grid = dataclasses.replace(grid, edges=outline)
    target = np.concatenate([grid.u * STRETCH, np.zeros((grid.ni, grid.nj, 1))], axis=-1)
    problem = Problem(SHEET, {"outline": EdgeCondition("pinned")}, grid, lambda nodes: grid)
    solution = relax_from(
        problem,
        model,
        Settings(tolerance=1e-10, max_seconds=60.0),
        lambda level: level.scaled(np.where(level.fixed[..., None], target, 0.98 * target)),
    )
    energy = affine_energy() * SHEET.thickness_mm * float(grid.zone_area.sum())
    distance = float(np.abs(solution.r - target).max()) / WIDTH
    return Finding(
        solution,
        (
            about("energy, N mm", solution.energy_N_mm["total"], energy, 1e-9),
            at_most("largest distance from the affine map / width", distance, 1e-7),
        ),
    )


def _on_mesh(make: Callable[[], Grid], model: Model) -> Finding:
    return affine_finding(make(), model)


def mesh_cases() -> list[HardCase]:
    """Every mesh under every model."""
    return [
        HardCase(
            f"{name}-{model.name}",
            FAMILY,
            f"{title}, {model.name}",
            ("converged",),
            REASON,
            partial(_on_mesh, make, model),
        )
        for name, (title, make) in MESHES.items()
        for model in (KOITER, TENSION_FIELD)
    ]
