"""From a scene to the solvers' types: sheet, mesh, edge conditions, boundary-value problem."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cases.schema import AnnulusSheet, HoleSheet, Scene
from cases.unstructured import FiniteElementSolution
from fdsolver import meshes
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import Model
from fdsolver.problem import Problem
from fdsolver.relax import Settings
from fdsolver.symmetry import Symmetry, refuse_unsymmetric


def grid_of(scene: Scene) -> Callable[[int], Grid]:
    """Node count -> mesh of the scene's sheet."""
    sheet, bias = scene.sheet, scene.mesh.bias
    sectors = scene.symmetry.reduce.partition("sector:")[2]
    # Without a bias of its own a scene gets the default of its shape.
    options = {} if bias is None else {"bias": bias}

    def grid(nodes: int) -> Grid:
        if isinstance(sheet, AnnulusSheet):
            return meshes.annulus(
                sheet.inner_radius_mm, sheet.outer_radius_mm, nodes, sectors=int(sectors or 1), **options
            )
        if isinstance(sheet, HoleSheet):
            return meshes.rectangle_with_hole(
                sheet.width_mm, sheet.height_mm, sheet.hole_radius_mm, nodes, **options
            )
        ratio = scene.mesh.cell_ratio or 1.0
        return meshes.rectangle(sheet.width_mm, sheet.height_mm, nodes, cell_ratio=ratio, **options)

    return grid


def sheet_of(scene: Scene) -> Sheet:
    """Material and thickness of a scene."""
    return Sheet(scene.material.young_MPa, scene.material.poisson, scene.sheet.thickness_mm)


def edges_of(scene: Scene) -> dict[str, EdgeCondition]:
    """Edge conditions of a scene."""
    return {
        name: EdgeCondition(edge.support, edge.move_mm, edge.rotate_deg, edge.grow_mm)
        for name, edge in scene.edges.items()
    }


def symmetry_of(scene: Scene, model: Model) -> Symmetry | None:
    """What a run of a model keeps of the scene's symmetry; None where it solves the whole sheet.

    By itself only a relaxed membrane under axisymmetric loads keeps one: its energy is convex in the gradient, so the
    mean of an equilibrium over all rotations about the axis is another, of no more energy.
    """
    reduce, parity = scene.symmetry.reduce, scene.symmetry.parity
    if reduce == "auto" and not _is_axisymmetric(scene, model):
        return None
    if reduce == "none":
        return None
    if reduce in ("auto", "axisymmetric"):
        return Symmetry("sector", parity)
    if reduce.startswith("sector:"):
        return Symmetry("sector", parity, int(reduce.partition(":")[2]))
    return Symmetry(reduce, parity)


def _is_axisymmetric(scene: Scene, model: Model) -> bool:
    """Whether relaxed energy and loads leave one ray of nodes to solve, for a run that need not factorise the whole."""
    convex = model.relaxed and not model.bending
    whole = scene.start.source is not None or scene.solver.finish == "on"
    if not convex or whole or not isinstance(scene.sheet, AnnulusSheet):
        return False
    try:
        refuse_unsymmetric(Symmetry("sector"), edges_of(scene), "annulus", scene.sheet.size_mm)
    except ValueError:
        return False
    return True


def problem_of(scene: Scene, model: Model, seed: int) -> Problem:
    """The boundary-value problem of a scene.

    Only a plate needs the random start: the membranes have no wrinkles to find, and a plane one stays exactly
    plane without it. Raises ResultError if the scene starts from a folder that holds no result.
    """
    make = grid_of(scene)
    perturbation = scene.start.perturbation if model.bending else 0.0
    return Problem(
        sheet_of(scene),
        edges_of(scene),
        make(scene.mesh.nodes),
        make,
        perturbation=perturbation,
        seed=seed,
        initial=_initial(scene),
        symmetry=symmetry_of(scene, model),
    )


def _initial(scene: Scene) -> tuple[Grid, np.ndarray] | None:
    """Mesh and positions (ni, nj, 3) mm of the result folder or the buckling mode that the scene starts from.

    None if it names neither.
    """
    source = scene.start.source
    if source is None:
        return None
    if source.startswith("mode:"):
        from cases.mode_start import mode_state

        return mode_state(scene, int(source.removeprefix("mode:")))
    from cases.results import ResultError, load_result

    solution = load_result(source)
    if isinstance(solution, FiniteElementSolution):
        raise ResultError(
            f"The result in {source} is one of finite elements; a run starts from a structured mesh."
        )
    return solution.grid, solution.r


def settings_of(scene: Scene, tolerance: float, threads: int = 1) -> Settings:
    """How a scene asks to be relaxed. tolerance : that of the scene, or of the method where the scene has none."""
    solver = scene.solver
    return Settings(
        tolerance=tolerance,
        damping=solver.damping,
        mass=solver.mass,
        levels=solver.levels,
        thicken=solver.thicken,
        thinning=solver.thinning,
        finish=solver.finish,
        max_steps=solver.max_steps,
        max_seconds=solver.max_seconds,
        threads=threads,
        snapshots=solver.snapshots,
    )
