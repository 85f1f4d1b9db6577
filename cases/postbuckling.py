"""The method `postbuckling`: a scene as a problem of bicubic finite elements, and its equilibrium as a solution.

Where the supports are mirror images, the sheet is solved on one side of the planes of symmetry, and the stability of
the whole sheet is examined in all classes of symmetry. A state of a quarter sheet that is found so is an equilibrium of
the whole one; whether it is stable there is what the classes that break the symmetry say.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from cases.postbuckling_scene import (
    default_vertices,
    mesh_of,
    mirrors_of,
    rigid_move_mm,
    supports_of,
)
from cases.postbuckling_solution import solution_of, whole_of
from cases.schema import Scene
from cases.unstructured import FiniteElementSolution
from fdsolver.relax import Progress
from fdsolver.result import Status

if TYPE_CHECKING:
    from femref.newton import Outcome
    from femref.postbuckle import Postbuckled, SheetProblem

# A slide of the wrinkles under their envelope costs next to nothing. Its eigenvalue is what the mesh makes of zero,
# 1e-3 of the flat sheet's most negative one on coarse meshes; the next one is a tenth of it. Below this it is neutral.
NEUTRAL = 1e-2
# Of one Newton solve: ten are usual, a hundred mean that it will not end.
MOST_ITERATIONS = 300


@dataclass
class Clock:
    """Reports to the progress display and stops the solve at the time limit."""

    scene: Scene
    progress: Callable[[Progress], None] | None
    started: float
    nodes: int
    step: int = 0

    def proceed(self, residual: float) -> bool:
        """Called before each Newton iteration: report it; False once the time has run out."""
        seconds = time.perf_counter() - self.started
        self.step += 1
        if self.progress is not None:
            tolerance = self.scene.solver.tolerance or 0.0
            self.progress(
                Progress(
                    0, 1, self.nodes, self.step, residual, tolerance, self.step / max(seconds, 1e-9), seconds
                )
            )
        return seconds < self.scene.solver.max_seconds


def solve_postbuckling(
    scene: Scene, threads: int, seed: int, progress: Callable[[Progress], None] | None = None
) -> FiniteElementSolution:
    """The wrinkled equilibrium of a scene on its mesh, by way of coarser ones.

    Raises NotCertified of `femref` if a factorisation cannot count eigenvalues, ValueError for a scene that
    `postbuckling_scene.unfit` names.
    """
    from femref.newton import NewtonSettings
    from femref.postbuckle import solve

    started, started_cpu = time.perf_counter(), time.process_time()
    vertices = scene.mesh.vertices or default_vertices(scene)
    problem = sheet_problem(scene, vertices)
    clock = Clock(scene, progress, started, vertices)
    assert scene.solver.tolerance is not None, "the runner resolves the tolerance"
    settings = NewtonSettings(
        scene.solver.tolerance, min(scene.solver.max_steps, MOST_ITERATIONS), clock.proceed
    )
    found = solve(problem, settings, scene.solver.levels)
    levels = [whole_of(level, rigid_move_mm(scene)) for level in found]
    stability = stability_of(scene, found[-1])
    status = _status(found[-1], stability)
    solution = solution_of(scene, levels, status, stability, clock.step)
    return replace(
        solution,
        message=_message(status, found[-1]),
        seconds=time.perf_counter() - started,
        cpu_seconds=time.process_time() - started_cpu,
        threads=threads,
        seed=seed,
    )


def sheet_problem(scene: Scene, vertices: int) -> SheetProblem:
    """The scene on a mesh of about so many vertices, or the part of it that its symmetry leaves."""
    from femref.postbuckle import SheetProblem

    mirrors = mirrors_of(scene)
    return SheetProblem(
        mesh_of(scene, vertices, mirrors),
        scene.material.young_MPa,
        scene.material.poisson,
        scene.sheet.thickness_mm,
        supports_of(scene, mirrors),
        mirrors,
        mode_of(scene),
    )


def mode_of(scene: Scene) -> int:
    """Which mode starts the wrinkles: that of start.from = "mode:2", or the lowest."""
    source = scene.start.source or ""
    return int(source.removeprefix("mode:")) if source.startswith("mode:") else 1


def stability_of(scene: Scene, found: Postbuckled) -> dict[str, object]:
    """Whether the state is stable: its lowest eigenvalue in every class of symmetry, N/mm^3.

    Of a scene whose reduction was asked for only its own class is examined.
    """
    from femref.inertia import NotCertified
    from femref.postbuckle import lowest_modes

    problem = found.problem
    if not found.converged:
        return {"stable": None, "how": "not examined: the run has not converged", "lowest": None}
    mirrors, whole = problem.mirrors, not scene.symmetry.asked
    classes = [
        replace(mirrors, turned_x=bool(x), turned_y=bool(y))
        for x in range(1 + (whole and mirrors.x != 0))
        for y in range(1 + (whole and mirrors.y != 0))
    ]
    energy, lowest = problem.energy(), []
    scale = abs(found.flat.lowest) if found.flat is not None else 0.0
    for each in classes:
        try:
            _, values, _ = lowest_modes(energy, found.state.q, ~problem.held(each), 2, 0.1 * scale)
        except NotCertified as reason:
            return {"stable": None, "how": f"not certified: {reason}", "lowest": None}
        lowest.append(values)
    smallest = float(min(values[0] for values in lowest))
    wrinkled = bool(found.state.q[..., 2].any())
    stiff = float(
        min(value for values in lowest for value in values if abs(value) > NEUTRAL * scale or not wrinkled)
    )
    where = f"{len(classes)} symmetry classes of the whole sheet" if len(classes) > 1 else "the solved part"
    how = f"lowest eigenvalue of the exact Hessian, N/mm^3, in {where}, the number below it by inertia"
    if smallest != stiff:
        how += f"; besides it the wrinkles slide at {smallest:.1e}, which is neutral"
    return {"stable": stiff > 0.0, "how": how, "lowest": stiff}


def _status(found: Postbuckled, stability: dict[str, object]) -> Status:
    if not found.converged:
        return _failures()[found.state.outcome]
    flat = not found.state.q[..., 2].any()
    return Status.UNSTABLE_FLAT if flat and stability["stable"] is False else Status.CONVERGED


def _failures() -> dict[Outcome, Status]:
    from femref.newton import Outcome

    return {
        Outcome.CONVERGED: Status.STALLED,  # but only a part of the load was reached
        Outcome.ITERATION_LIMIT: Status.STEP_LIMIT,
        Outcome.STALLED: Status.STALLED,
        Outcome.SINGULAR: Status.STALLED,
        Outcome.NOT_FINITE: Status.NOT_FINITE,
        Outcome.STOPPED: Status.TIME_LIMIT,
    }


def _message(status: Status, found: Postbuckled) -> str:
    if found.converged:
        return status.sentence
    reached = "" if found.reached >= 1.0 else f" {100.0 * found.reached:.3g} % of the load was reached."
    return f"{status.sentence} {found.state.outcome.value}{reached}"
