"""Runs of the paper's own scheme and of the conservative one that the benchmarks of the former share."""

from __future__ import annotations

from pathlib import Path

from cases import load_scene, run
from fdsolver.result import Solution
from tests.benchmarks.record import Verification

HEALTHY = ("filtered", "stabilised")  # variants whose ghost rows do not grow


def pulled(percent: float) -> dict[str, object]:
    """Keys of the strip pulled by a part of its 254 mm, %."""
    return {"edges.top.move_mm": [0.0, 2.54 * percent, 0.0], "solver.levels": 1, "solver.tolerance": 1e-8}


def sheared(move_mm: float) -> dict[str, object]:
    """Keys of the sheet whose upper clamp moves sideways."""
    return {"edges.top.move_mm": [move_mm, 0.0, 0.0], "solver.levels": 1, "solver.tolerance": 1e-8}


def solved(
    verify: Verification, name: str, scene: str, method: str, nodes: int, keys: dict[str, object]
) -> tuple[Solution, Path]:
    """A run in a result folder of its own, and the folder."""
    folder = verify.folder(name)
    solution = run(load_scene(scene, {**keys, "mesh.nodes": nodes}), method=method, out=folder)
    assert isinstance(solution, Solution)
    return solution, folder
