"""Hard cases of pushed columns: many waves are equilibria, one of them is stable, and its energy is known.

A strip without lateral contraction, pinned at its ends and shortened by the strain e, buckles at Euler's c = (k h)^2 /
12, k = pi / length, and from there on bears no more than Y c: its energy is Y h A (c e - c^2 / 2), but for parts of e.
In n half-waves it would bear n^2 times as much: in equilibrium too, and unstable.
"""

from __future__ import annotations

import functools

import numpy as np

from cases.hard import Finding, HardCase, about, at_least
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.meshes import rectangle
from fdsolver.model import KOITER
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.relax import Settings

LENGTH, WIDTH, YOUNG, THICKNESS = 20.0, 4.0, 3500.0, 0.02  # mm, mm, MPa, mm
EULER = (np.pi / LENGTH * THICKNESS) ** 2 / 12.0
NODES = 500  # 50 cells along it
MESH_ERROR = 0.005  # of the critical load: second order, 1e-3 on this mesh, and parts of e
FAMILY = "pushed column"


def grid(nodes: int) -> Grid:
    """The strip."""
    return rectangle(LENGTH, WIDTH, nodes)


def column(times: float) -> Problem:
    """The strip shortened by so many times Euler's strain."""
    share = 0.5 * times * EULER * LENGTH
    moves = {"left": share, "right": -share}
    edges = {name: EdgeCondition("pinned", move_mm=(move, 0.0, 0.0)) for name, move in moves.items()}
    return Problem(Sheet(YOUNG, 0.0, THICKNESS), edges, grid(NODES), grid, perturbation=1e-6)


def in_waves(problem: Problem, times: float, waves: int) -> Problem:
    """Started in so many half-waves A sin(n k x), whose (n k A)^2 / 4 takes up what is beyond their critical strain."""
    mesh = grid(NODES)
    k = waves * np.pi / LENGTH
    height = 2.0 / k * np.sqrt((times - waves**2) * EULER)
    x = mesh.u[..., 0] - mesh.u[..., 0].min()
    r = np.concatenate([mesh.u, (height * np.sin(k * x))[..., None]], axis=-1)
    return Problem(
        problem.sheet, problem.edges, mesh, lambda nodes: mesh, perturbation=0.0, initial=(mesh, r)
    )


def _find(times: float, waves: int) -> Finding:
    problem = column(times)
    solution = solve(in_waves(problem, times, waves) if waves else problem, KOITER, Settings(tolerance=1e-7))
    energy = YOUNG * THICKNESS * LENGTH * WIDTH * EULER**2 * (times - 0.5)
    return Finding(
        solution,
        (
            about("energy, N mm", solution.energy_N_mm["total"], energy, MESH_ERROR),
            at_least("shown stable", float(solution.stability["stable"] is True), 1.0),
        ),
    )


def column_cases() -> list[HardCase]:
    """Columns under up to 300 times Euler's load, from noise and from higher waves."""
    loads = [(times, 0, f"{times:g} times Euler's strain, from noise") for times in (2.0, 12.0, 100.0, 300.0)]
    waves = [
        (times, n, f"{times:g} times Euler's strain, started in {n} half-waves")
        for times, n in ((12.0, 2), (12.0, 3), (100.0, 2), (100.0, 5))
    ]
    reason = "Euler's column: the stress stays at the critical one of a single half-wave"
    return [
        HardCase(
            f"column-{times:g}" + (f"-waves-{n}" if n else ""),
            FAMILY,
            title,
            ("converged",),
            reason,
            functools.partial(_find, times, n),
        )
        for times, n, title in (*loads, *waves)
    ]
