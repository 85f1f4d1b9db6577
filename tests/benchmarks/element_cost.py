"""What one finite-element solve takes, measured in a process of its own, so that its peak memory is its own.

python -m tests.benchmarks.element_cost METHOD SOLVER VERTICES [parts] prints one row as JSON.
"""

from __future__ import annotations

import json
import sys
import time

from scipy.sparse import csc_array

from cases import load_scene, run
from cases.finite_elements import plate_material, sheet_mesh, supports_of
from cases.machine import peak_memory_MB
from cases.postbuckling import sheet_problem
from femref.bicubic import flat
from femref.direct import using
from femref.inertia import factorise
from femref.newton import free_hessian
from femref.plate_matrices import PlateSpace, bending_stiffness

SCENE = "stretch"
SMALL = 400  # vertices of a first run, which compiles


def buckling_matrix(vertices: int) -> csc_array:
    """Bending stiffness of the strip by Argyris triangles."""
    scene = load_scene(SCENE)
    space = PlateSpace(sheet_mesh(scene, vertices), plate_material(scene), supports_of(scene))
    return bending_stiffness(space)


def postbuckling_matrix(vertices: int) -> csc_array:
    """Hessian of the unstrained quarter strip by bicubic elements."""
    problem = sheet_problem(load_scene(SCENE), vertices)
    return free_hessian(problem.energy(), flat(problem.mesh), ~problem.held())


MATRICES = {"buckling": buckling_matrix, "postbuckling": postbuckling_matrix}


def measure(method: str, solver: str, vertices: int, whole: bool) -> dict[str, object]:
    """Unknowns, CPU seconds of assembly, of one factorisation and of the whole solve, entries and peak memory."""
    assemble = MATRICES[method]
    with using(solver):
        factorise(assemble(SMALL))
        started = time.process_time()
        matrix = assemble(vertices)
        assembled = time.process_time()
        factors = factorise(matrix)
        row: dict[str, object] = {
            "method": method,
            "solver": solver,
            "vertices": vertices,
            "unknowns": matrix.shape[0],
            "assemble_s": assembled - started,
            "factorise_s": factors.seconds,
            "factor_entries": factors.entries,
            "whole_s": None,
            "value": None,
        }
        del factors, matrix
        if whole:
            run(load_scene(SCENE), method, nodes=SMALL)
            solution = run(load_scene(SCENE), method, nodes=vertices)
            assert solution.status.value == "converged", solution.message
            row["whole_s"] = solution.cpu_seconds
            # what both solvers must agree on
            row["value"] = (
                solution.critical[0]["factor"] if method == "buckling" else solution.energy_N_mm["bending"]
            )
    return row | {"peak_MB": peak_memory_MB()}


if __name__ == "__main__":
    print(json.dumps(measure(sys.argv[1], sys.argv[2], int(sys.argv[3]), "parts" not in sys.argv[4:])))
