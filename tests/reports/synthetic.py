"""Result folders made from formulas, so that the report can be tested without a solver.

The shapes are plausible, not solutions: what is tested is that the report shows what the folders hold.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from cases.results import probe, write_result
from cases.scene import load_scene
from cases.schema import Scene
from fdsolver.fields import zone_fields
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.meshes import annulus, rectangle, rectangle_with_hole
from fdsolver.result import Reaction, Solution, Status
from reports.run import ReportRun
from tensionfield.annulus import AnnulusProblem, AnnulusSolution, solve_annulus

WRINKLED_METHODS = ("koiter", "koiter-published")
WAVE_NUMBER = 0.4  # 1/mm, of the pulled strip's wrinkles
GOLDEN = 2.399963  # radians: phases of successive seeds fill the circle
MESH_ERROR = 40.0  # of second order: over the number of nodes
SHEAR_HALF_WAVE, SHEAR_AMPLITUDE = 16.0, 0.25  # mm, across the wrinkles
FLAT_COSTS = 1e-3  # N mm, gained by wrinkling


def write_synthetic(
    folder: Path,
    run: ReportRun,
    nodes: int,
    status: Status = Status.CONVERGED,
    title: str | None = None,
    planned: int | None = None,
) -> None:
    """Write the result folder of one planned run, made from a formula.

    planned : node count that the scene asks for, if the run ended on a coarser mesh.
    """
    overrides = dict(run.overrides) | {"mesh.nodes": planned or nodes} | ({"title": title} if title else {})
    scene = load_scene(run.scene, overrides)
    grid = make_grid(scene, nodes)
    sheet = Sheet(scene.material.young_MPa, scene.material.poisson, scene.sheet.thickness_mm)
    r = positions(grid, scene, "membrane" if run.part == "flat" else run.method, run.seed)
    solution = Solution(
        method=run.method,
        status=status,
        message=status.sentence,
        grid=grid,
        sheet=sheet,
        r=r,
        steps=1200,
        force_evaluations=1300,
        residual=7.5e-9 if status is Status.CONVERGED else 3e-4,
        seconds=1.5,
        cpu_seconds=1.6,
        seconds_compile=0.5,
        energy_N_mm={
            "total": 41.0 + (FLAT_COSTS if run.part == "flat" else 0.0),
            "membrane": 40.5,
            "bending": 0.5,
        },
        reactions=made_up_reactions(scene, grid),
        zone=zone_fields(grid, sheet, r, relaxed=run.method in ("tension-field", "exact")),
        history=made_up_history(),
        hourglass={"out_of_plane": 0.0012, "in_plane": None},
        stability={"stable": True, "how": "re-kick", "lowest": None},
        warnings=("a made-up warning",) if run.method == "koiter" else (),
        levels=(),
        threads=1,
        seed=0,
    )
    snapshots = made_up_snapshots(r) if scene.solver.snapshots else {}
    solution = replace(solution, snapshots=snapshots, seed=run.seed)
    write_result(folder, solution, scene, probe(solution, scene), {}, "no-hash")


def made_up_snapshots(r: np.ndarray) -> dict[str, np.ndarray]:
    """Six shapes on the way to r, on both nested meshes of the history."""
    growth = np.array([1e-6, 1e-4, 1e-2, 0.3, 0.8, 1.0])
    shapes = np.repeat(r[None], 6, axis=0)
    shapes[..., 2] *= growth[:, None, None]
    return {
        "step": np.array([0, 100, 400, 20, 300, 580]),
        "level": np.array([0, 0, 0, 1, 1, 1]),
        "kinetic_N_mm": np.array([0.0, 1e-2, 1e-4, 1e-3, 1e-5, 1e-8]),
        "r": shapes,
    }


def make_grid(scene: Scene, nodes: int) -> Grid:
    """The mesh of a scene's shape."""
    sheet = scene.sheet
    if sheet.shape == "annulus":
        return annulus(sheet.inner_radius_mm, sheet.outer_radius_mm, nodes)
    if sheet.shape == "rectangle":
        return rectangle(sheet.width_mm, sheet.height_mm, nodes)
    return rectangle_with_hole(sheet.width_mm, sheet.height_mm, sheet.hole_radius_mm, nodes)


def made_up_reactions(scene: Scene, grid: Grid) -> dict[str, Reaction]:
    """A force and a moment for every supported edge."""
    supported = [name for name, edge in scene.edges.items() if edge.support != "free"]
    return {
        name: Reaction(
            np.array([0.0, 3.0, 2.5 + 1.0 / grid.nodes]), np.array([0.0, 0.0, 1234.5 + 100.0 / grid.nodes])
        )
        for name in supported
    }


def made_up_history() -> dict[str, np.ndarray]:
    """Two nested meshes with a residual that falls."""
    step = np.concatenate([np.arange(0, 600, 20), np.arange(0, 600, 20)])
    level = np.repeat([0, 1], 30)
    residual = 10.0 ** (-1.0 - 7.0 * step / 600.0)
    return {
        "level": level,
        "step": step,
        "energy": 40.0 + residual,
        "kinetic": residual,
        "residual": residual,
        "restart": np.zeros(60, dtype=np.int64),
    }


def positions(grid: Grid, scene: Scene, method: str, seed: int = 0) -> np.ndarray:
    """(ni, nj, 3) mm: a smooth shape, with wrinkles for the plate."""
    flat = np.concatenate([grid.u, np.zeros((grid.ni, grid.nj, 1))], axis=-1)
    if scene.sheet.shape == "annulus":
        return _ring(flat, scene, method)
    x, y = flat[..., 0], flat[..., 1]
    half = 0.5 * scene.sheet.height_mm
    top, bottom = scene.edges["top"].move_mm, scene.edges["bottom"].move_mm
    part = (y + half) / (2.0 * half)
    r = flat + (1.0 - part[..., None]) * np.array(bottom) + part[..., None] * np.array(top)
    pull = (top[1] - bottom[1]) / (2.0 * half)
    r[..., 0] -= 0.5 * pull * x * (1.0 - (y / half) ** 4)
    if method in WRINKLED_METHODS:
        r[..., 2] += (
            _sheared(x, y, top) if scene.name == "shear" else _pulled(x, y / half, pull, seed, grid.nodes)
        )
    return r


def _pulled(x: np.ndarray, y: np.ndarray, pull: float, seed: int, nodes: int) -> np.ndarray:
    """Wrinkles along the pull from 2 % to 23 %, highest half-way, with a phase from the seed and a mesh's error."""
    amplitude = 0.3 * max(0.0, 1.0 - ((pull - 0.125) / 0.105) ** 2) * (1.0 + MESH_ERROR / nodes)
    return amplitude * np.cos(WAVE_NUMBER * x + GOLDEN * seed) * np.exp(-((2.0 * y) ** 2) - (x / 25.0) ** 2)


def _sheared(x: np.ndarray, y: np.ndarray, top: tuple[float, float, float]) -> np.ndarray:
    """Wrinkles at 45 degrees, twice as high near the upright edges; none under the smallest load with a pre-stretch."""
    if top[0] < 0.1 < top[0] + 2.0 * top[1]:
        return np.zeros_like(x)
    return (
        SHEAR_AMPLITUDE
        * (1.0 + (np.abs(x) > 126.0))
        * np.sin(np.pi * (x - y) / (SHEAR_HALF_WAVE * np.sqrt(2.0)))
    )


def _ring(flat: np.ndarray, scene: Scene, method: str) -> np.ndarray:
    radius, angle = np.hypot(flat[..., 0], flat[..., 1]), np.arctan2(flat[..., 1], flat[..., 0])
    inner, outer = scene.sheet.inner_radius_mm, scene.sheet.outer_radius_mm
    edge = scene.edges["inner"]
    solution = _solved(scene.name, edge.rotate_deg, edge.move_mm[2], edge.grow_mm)
    # rounding must not put a rim's nodes outside the sheet
    new_radius, turn, height = solution.position(np.clip(radius, inner, outer))
    if method in WRINKLED_METHODS:
        part = (radius - inner) / (outer - inner)
        height = height + 3.0 * np.sin(np.pi * part) * np.sin(48.0 * angle)
    if method != "exact":  # an error of second order in the mesh
        height = height * (1.0 + 1.0 / flat[..., 0].size)
    return np.stack([new_radius * np.cos(angle + turn), new_radius * np.sin(angle + turn), height], axis=-1)


@cache
def _solved(name: str, rotate_deg: float, lift_mm: float, grow_mm: float) -> AnnulusSolution:
    scene = load_scene(name)
    return solve_annulus(
        AnnulusProblem(
            inner_radius_mm=scene.sheet.inner_radius_mm,
            outer_radius_mm=scene.sheet.outer_radius_mm,
            poisson=scene.material.poisson,
            young_MPa=scene.material.young_MPa,
            thickness_mm=scene.sheet.thickness_mm,
            twist_deg=rotate_deg,
            lift_mm=lift_mm,
            inner_grow_mm=grow_mm,
        )
    )
