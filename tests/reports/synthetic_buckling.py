"""Result folders of buckling runs made from formulas: plane waves as modes, factors that rise in pairs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cases.buckling import critical_entries
from cases.finite_elements import sheet_mesh, zone_fields
from cases.results import probe, write_result
from cases.scene import load_scene
from cases.unstructured import FiniteElementMesh, FiniteElementSolution
from fdsolver.material import Sheet
from fdsolver.result import Reaction, Status
from femref.parity import parities
from femref.prestress import PlaneState
from reports.run import ReportRun

COUNT = 10
FIRST = {"stretch": 0.25, "shear": 2e-4, "hole": 7e-6}  # factors of the scenes' order
MESH_ERROR = 2.0  # over the number of vertices


def made_up_factors(scene: str, vertices: int) -> np.ndarray:
    """Five pairs, each farther than the last, and an error that falls with the vertices."""
    pairs = np.repeat(1.0 + 0.5 * np.arange(COUNT // 2), 2) * (1.0 + 1e-3 * (np.arange(COUNT) % 2))
    return FIRST[scene] * pairs * (1.0 + MESH_ERROR / vertices)


def made_up_modes(u: np.ndarray) -> np.ndarray:
    """(vertices, COUNT): cosines and sines along the shorter side, finer from pair to pair."""
    half = np.ptp(u, axis=0) / 2.0
    short = int(half.argmin())
    phase = np.pi * u[:, short] / half[short]
    fade = np.cos(0.5 * np.pi * u[:, 1 - short] / half[1 - short])
    return np.stack(
        [fade * (np.sin if k % 2 else np.cos)((2 + k // 2) * phase) for k in range(COUNT)], axis=1
    )


def write_synthetic_buckling(
    folder: Path, run: ReportRun, vertices: int, status: Status = Status.CONVERGED
) -> None:
    """Write the result folder of one planned buckling run."""
    scene = load_scene(run.scene, {**run.overrides, "mesh.vertices": vertices})
    sheet = sheet_mesh(scene, vertices, scene.solver.element == "bogner-fox-schmit")
    u, count = sheet.positions_mm, len(sheet.positions_mm)
    factor = made_up_factors(run.scene, count)
    found = parities(sheet.mesh, factor, made_up_modes(u))
    grid = FiniteElementMesh(scene.sheet.shape, u, sheet.cells)
    flat = np.zeros((2, 2, len(sheet.cells), 1))
    state = PlaneState(flat, flat, np.zeros_like(u), {}, 1.0, 0.0, np.zeros(0))
    force = Reaction(np.array([0.0, 1.0, 0.0]), np.zeros(3))
    material = Sheet(scene.material.young_MPa, scene.material.poisson, scene.sheet.thickness_mm)
    solution = FiniteElementSolution(
        method="buckling",
        status=status,
        message=status.sentence,
        grid=grid,
        sheet=material,
        r=np.column_stack([u, np.zeros(count)]),
        steps=5,
        force_evaluations=0,
        residual=1e-12,
        seconds=2.0,
        cpu_seconds=2.0,
        seconds_compile=0.0,
        energy_N_mm={"total": 1.0, "membrane": 1.0, "bending": 0.0},
        reactions={"top": force, "bottom": force},
        zone=zone_fields(scene, state),
        history={"factor": factor},
        hourglass={},
        stability={"stable": False, "how": "the inertia certifies", "lowest": float(factor[0])},
        warnings=("a made-up warning of buckling",),
        levels=({"nodes": count, "unknowns": 6 * count, "factor_entries": 90 * count},),
        threads=1,
        seed=0,
        modes=(found.modes / np.abs(found.modes).max(axis=0)).T,
        critical=critical_entries(scene, factor, found),
        errors=tuple(
            {"quantity": f"buckling factor {k + 1}", "value": value, "discretisation": 0.01 * value}
            for k, value in enumerate(factor)
        ),
    )
    write_result(folder, solution, scene, probe(solution, scene), {}, "no-hash")
