"""`wrinkle run --accuracy 1%`: refine mesh and tolerance until the run's own error estimate is small enough."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from cases.errors import SHARE, errors_of
from cases.methods import METHODS, choose, with_numbers
from cases.problems import Problem, SceneError, shown
from cases.results import ResultError, read_document
from cases.runner import run
from cases.scene import load_scene
from cases.scene_text import scene_hash
from cases.schema import Scene
from cases.unstructured import AnySolution, FiniteElementSolution
from fdsolver.relax import Progress
from fdsolver.result import Status

FIRST_NODES = 6500  # three nested meshes of at least 400 nodes each
LEVELS = 3
MOST_NODES = 1_000_000
LEAST_GROWTH, LARGEST_GROWTH = 2.0, 16.0  # of the node count from one trial to the next
MARGIN = 0.8  # aim below the target: the next estimate has an error of its own
SMALLEST, LARGEST = 1e-6, 0.5
THICKENED = (
    "leaves --accuracy nothing to go by: the coarser meshes carry a thicker sheet, so their results tell no error;"
    " give --nodes, or --set solver.{}"
)
# what --accuracy promises; energies of bending, wavelengths and the smallest stretches are too soft for a promise
PROMISED = re.compile(
    r"energy_N_mm\.total|reactions\..*|stretch\.major_max|out_of_plane_mm\.rms|sections\..*\.(rms|amplitude)_mm"
)


@dataclass(frozen=True)
class Reached:
    """How close a result is. worst : its largest relative error, None if none could be estimated. quantity : of which.
    order : observed there. tighten : whether iterations rather than the mesh are to blame. refused : quantities whose
    error the meshes do not tell.
    """

    worst: float | None
    quantity: str
    order: float | None
    tighten: bool
    refused: tuple[str, ...]


def read_accuracy(text: str) -> float:
    """The relative error that `1%` or `0.01` asks for. Raises SceneError."""
    number, percent = text.strip().removesuffix("%"), text.strip().endswith("%")
    try:
        value = float(number) / (100.0 if percent else 1.0)
    except ValueError:
        value = math.nan
    if not SMALLEST <= value <= LARGEST:
        message = "must be a relative error from 0.0001% to 50%, as 1% or 0.01"
        raise SceneError([Problem("", "--accuracy", shown(text), message)])
    return value


def run_to_accuracy(
    scene: Scene,
    method: str,
    accuracy: float,
    seed: int = 0,
    threads: int = 1,
    tolerance: float | None = None,
    out: Path | str | None = None,
    force: bool = False,
    progress: Callable[[Progress], None] | None = None,
    strict: bool = False,
) -> AnySolution:
    """Solve a scene on ever finer meshes until every promised quantity's estimated error is below `accuracy`.

    out : holds the last mesh's result. The rest as of `cases.run`.

    Raises SceneError where the nested meshes of a run cannot be compared (solver.thicken, solver.thinning), before
    anything is solved.

    Returns the last solution, with a warning if its error is above `accuracy` or not known: at the largest mesh, or
    when a run does not converge or the time limit of the scene is used up.
    """
    chosen = choose(scene, method)[0]
    for key, default in {"thicken": False, "thinning": ()}.items():
        value = getattr(scene.solver, key)
        if value != default and chosen.bending:
            message = THICKENED.format(f"{key}={shown(default)}")
            raise SceneError([Problem(scene.name, f"solver.{key}", shown(value), message)])
    if scene.solver.levels is None:
        scene = replace(scene, solver=scene.solver.model_copy(update={"levels": LEVELS}))
    nodes, started = _first(scene, chosen.name, seed, tolerance, out)
    tolerance, spent = started, 0.0
    while True:
        solution = run(
            scene,
            chosen.name,
            nodes,
            seed,
            threads,
            tolerance,
            out,
            force=force,
            progress=progress,
            strict=strict,
        )
        if chosen.name == "exact":
            return solution
        force, spent = True, spent + solution.seconds
        reached = judge(_errors(solution, scene, out))
        close = reached.worst is not None and reached.worst <= accuracy and not reached.refused
        stop = (
            solution.status is not Status.CONVERGED
            or nodes >= MOST_NODES
            or spent >= scene.solver.max_seconds
        )
        if close or stop:
            return solution if close else _warned(solution, accuracy, reached)
        if reached.tighten:
            tolerance = (tolerance or METHODS[chosen.name].tolerance) / 10.0
        nodes = next_nodes(nodes, accuracy, reached)


def judge(errors: Sequence[Mapping[str, Any]]) -> Reached:
    """The largest relative error among the promised quantities, from the entries `errors` of a result."""
    worst, quantity, order, tighten, refused = None, "", None, False, []
    for error in errors:
        name, value = error["quantity"], _size(error, errors)
        if not PROMISED.fullmatch(name):
            continue
        if error["discretisation"] is None:
            refused.append(name)
            continue
        iteration = error["iteration"] or 0.0
        relative = (error["discretisation"] + iteration) / value
        if worst is None or relative > worst:
            worst, quantity, order = relative, name, error["order"]
            tighten = iteration > SHARE * error["discretisation"]
    return Reached(worst, quantity, order, tighten, tuple(refused))


def _size(error: Mapping[str, Any], errors: Sequence[Mapping[str, Any]]) -> float:
    """What the error of a quantity is compared with: itself, but all forces (moments) with the largest of them."""
    kinds = [kind for kind in ("force_N", "moment_N_mm") if f".{kind}." in error["quantity"]]
    alike = [other for other in errors if kinds and f".{kinds[0]}." in other["quantity"]] or [error]
    return max(abs(other["value"]) for other in alike)


def next_nodes(nodes: int, accuracy: float, reached: Reached) -> int:
    """The node count at which the worst error should be below the target."""
    growth = 4.0
    if reached.worst is not None and reached.worst > accuracy:
        # nodes go with the mesh width to the power -2, errors with the power of the order; 1 where none was observed
        growth = (reached.worst / (MARGIN * accuracy)) ** (2.0 / min(reached.order or 1.0, 2.0))
    elif not reached.refused:
        growth = 1.0  # the tolerance alone was too large
    if growth > 1.0:
        growth = min(max(growth, LEAST_GROWTH), LARGEST_GROWTH)
    return min(round(nodes * growth), MOST_NODES)


def _first(
    scene: Scene, method: str, seed: int, tolerance: float | None, out: Path | str | None
) -> tuple[int, float | None]:
    """Where to begin: with the result that an earlier call left in `out`, or with the smallest mesh."""
    try:
        stored = load_scene(Path(out) / "scene.toml") if out is not None else None
        document = read_document(out) if out is not None else {}
    except (SceneError, ResultError):
        return FIRST_NODES, tolerance
    if stored is None or stored.solver.tolerance is None:
        return FIRST_NODES, tolerance
    same = with_numbers(scene, METHODS[method], stored.mesh.nodes, stored.solver.tolerance)
    if document.get("scene_hash") != scene_hash(same, method, seed=seed):
        return FIRST_NODES, tolerance
    return stored.mesh.nodes, stored.solver.tolerance


def _errors(solution: AnySolution, scene: Scene, out: Path | str | None) -> Sequence[Mapping[str, Any]]:
    """The error estimates of a solution; a stored one has them in its folder alone."""
    if out is not None:
        return read_document(out)["errors"]
    if isinstance(solution, FiniteElementSolution):
        return solution.errors
    return [asdict(error) for error in errors_of(solution, scene)]


def _warned(solution: AnySolution, accuracy: float, reached: Reached) -> AnySolution:
    """The solution with a sentence that says by how much the target was missed."""
    known = "unknown" if reached.worst is None else f"{100.0 * reached.worst:.2g} % ({reached.quantity})"
    text = f"The accuracy of {100.0 * accuracy:g} % was not shown: the largest estimated error is {known}"
    if reached.refused:
        text += f"; no estimate for {', '.join(reached.refused)}"
    return replace(solution, warnings=(*solution.warnings, f"{text}."))
