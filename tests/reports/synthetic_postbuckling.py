"""Result folders of post-buckled runs made from formulas: waves under an envelope, errors that fall with the mesh."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np

from cases.bicubic import stored_mesh
from cases.postbuckling_scene import mesh_of
from cases.results import probe, write_result
from cases.scene import load_scene
from cases.unstructured import FiniteElementSolution
from fdsolver.material import Sheet
from fdsolver.result import Reaction, Status, ZoneFields
from femref.held import Mirrors
from reports.run import ReportRun
from tests.reports.synthetic import positions

MESHES = (0.25, 0.5, 1.0)  # vertices of the nested meshes over those of the finest
HEIGHT_MM, BENDING, GAINED, FORCE_N = 0.3, 0.5, 1e-3, 2.5
MESH_ERROR = 20.0  # relative, of fourth order: over the square of the vertices


def made_up_quantities(vertices: float, wrinkled: bool) -> dict[str, float]:
    """What one mesh measures; a flat sheet has no heights."""
    error = 1.0 + MESH_ERROR / vertices**2
    found = {
        "energy_N_mm.total": 41.0,
        "energy_N_mm.bending": BENDING * error * wrinkled,
        "energy_N_mm.gained": GAINED * error * wrinkled,
        "reactions.top.force_N.y": FORCE_N,
    }
    if wrinkled:
        for name, value in (("envelope_mm", HEIGHT_MM), ("rms_mm", 0.1), ("wavelength_mm", 14.0)):
            found[f"sections.midsection.{name}"] = value * error
    return found


def write_synthetic_postbuckling(
    folder: Path, run: ReportRun, vertices: int, status: Status = Status.CONVERGED
) -> None:
    """Write the result folder of one planned post-buckling run."""
    scene = load_scene(run.scene, {**run.overrides, "mesh.vertices": vertices})
    lines = mesh_of(scene, vertices, Mirrors())
    mesh = stored_mesh(lines, scene.sheet.shape)
    ni, nj = lines.shape
    grid = SimpleNamespace(u=mesh.u.reshape(ni, nj, 2), ni=ni, nj=nj, nodes=mesh.nodes)
    r = positions(grid, scene, "koiter").reshape(-1, 3)
    wrinkled = bool(np.ptp(r[:, 2]) > 1e-6)
    one = np.ones(mesh.zones)
    counts = [round(part * mesh.nodes) for part in MESHES]
    measured = [made_up_quantities(count, wrinkled) for count in counts]
    material = Sheet(scene.material.young_MPa, scene.material.poisson, scene.sheet.thickness_mm)
    force = Reaction(np.array([0.0, FORCE_N, 0.0]), np.zeros(3))
    solution = FiniteElementSolution(
        method="postbuckling",
        status=status,
        message=status.sentence,
        grid=mesh,
        sheet=material,
        r=r,
        steps=12,
        force_evaluations=12,
        residual=1e-10,
        seconds=3.0,
        cpu_seconds=3.0,
        seconds_compile=0.0,
        energy_N_mm={"total": 41.0, "membrane": 40.5, "bending": measured[-1]["energy_N_mm.bending"]},
        reactions={"top": force} if "top" in scene.edges else {"inner": force},
        zone=ZoneFields(1.1 * one, one, 0.1 * one, 0.0 * one, np.full(mesh.zones, 2, dtype=np.int8)),
        history={},
        hourglass={},
        stability={"stable": True, "how": "by inertia", "lowest": 1e-6},
        warnings=(),
        levels=tuple(
            {"nodes": count, "unknowns": 3 * count, "quantities": found}
            for count, found in zip(counts, measured, strict=True)
        ),
        threads=1,
        seed=0,
        modes=np.zeros((0, mesh.nodes)),
        errors=tuple(
            {
                "quantity": name,
                "value": value,
                "discretisation": 2.0 * MESH_ERROR / mesh.nodes**2 * abs(value),
            }
            for name, value in measured[-1].items()
        ),
    )
    write_result(folder, solution, scene, probe(solution, scene), {}, "no-hash")
