"""Which runs show what accuracy costs: every method on every mesh, and at one mesh every other way to iterate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args

from cases.methods import METHODS, methods_of
from cases.scene import load_scene
from cases.schema import Scene, Solver
from cases.study_points import Choices, Point, make_points

MESHES = (1000, 2000, 4000, 8000, 16_000, 32_000, 64_000)
ELEMENT_MESHES = (400, 800, 1600, 3200, 6400)  # vertices: an element costs a hundred times a zone
NODES_PER_VERTEX = 6  # of the finest mesh over the vertices of the finest elements, at least
OPTIONS_MESH = (
    8000  # where the other ways to iterate are compared: large enough to tell, small enough for the slow
)
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
RELAXED = ("tension-field", "membrane", "koiter")  # by the engine with its dampings and masses
PRINTED = "koiter-published"
MAX_SECONDS = 120.0
PERTURBED = "start.perturbation"


@dataclass(frozen=True)
class Extent:
    """How much is measured.

    meshes : node counts of the finite-difference methods, rising. options : whether the other ways to iterate are
    measured too. repeats : runs of a short case, at least 1. max_seconds : limit of each run; a run that meets it stays
    in the table as such.
    """

    meshes: Sequence[int] = MESHES
    options: bool = True
    repeats: int = 3
    max_seconds: float = MAX_SECONDS

    @property
    def vertices(self) -> tuple[int, ...]:
        """Vertices of the finite-element meshes that go with the meshes."""
        return tuple(count for count in ELEMENT_MESHES if count * NODES_PER_VERTEX <= max(self.meshes))


EVERYTHING = Extent()


@dataclass(frozen=True)
class CostRun:
    """One line of the table: a point, and what sets it apart. series : runs on different meshes, otherwise alike."""

    point: Point
    series: str
    option: str


def plan(
    source: str,
    changes: Mapping[str, object],
    methods: Sequence[str] | None = None,
    extent: Extent = EVERYTHING,
) -> list[CostRun]:
    """The runs for a scene. source : built-in name or path. changes : dotted scene keys, as of `--set`.

    methods : names; None takes all that fit the scene.
    """
    changes = {**changes, "solver.max_seconds": extent.max_seconds}
    scene = load_scene(source, dict(changes))
    runs: list[CostRun] = []
    for method in methods_of(scene) if methods is None else methods:
        nodes = extent.vertices if METHODS[method].finite_elements else extent.meshes
        runs += _series(source, changes, method, nodes, {}, "")
        middle = min(extent.meshes, key=lambda count: abs(count - OPTIONS_MESH))
        for option, change in options_of(method, scene) if extent.options else ():
            runs += _series(source, changes, method, [middle], change, option)
    return list({run.point.name: run for run in runs}.values())


def options_of(method: str, scene: Scene) -> list[tuple[str, dict[str, object]]]:
    """The other ways of a method to iterate: one key at a time away from the scene's own choice."""
    if method == PRINTED:
        return [(f"published {word}", {"solver.published": word}) for word in _others(scene, "published")]
    if method not in RELAXED:
        return []
    keys = ("damping", "mass", *(key for key in ("finish",) if key in Solver.model_fields))
    found: list[tuple[str, dict[str, object]]] = [
        (f"{key} {word}", {f"solver.{key}": word}) for key in keys for word in _others(scene, key)
    ]
    found.append(("one mesh", {"solver.levels": 1}))
    usual = scene.solver.tolerance or METHODS[method].tolerance
    found += [
        (f"tolerance {x:.0e}", {"solver.tolerance": x}) for x in TOLERANCES if not 0.5 < x / usual < 2.0
    ]
    return found


def _others(scene: Scene, key: str) -> list[Any]:
    """The choices of a solver key but the scene's own."""
    words = get_args(Solver.model_fields[key].annotation)
    return [word for word in words if word is not type(None) and word != getattr(scene.solver, key)]


def _series(
    source: str,
    changes: Mapping[str, object],
    method: str,
    nodes: Sequence[int],
    change: Mapping[str, object],
    option: str,
) -> list[CostRun]:
    """Runs of one method and option on several meshes."""
    points = make_points(source, [{**changes, **change}], Choices([method], list(nodes)), source)
    return [CostRun(point, f"{method}, {option}" if option else method, option) for point in points]


def repeat(run: CostRun, number: int) -> CostRun:
    """The same run once more, into a folder of its own."""
    return replace(run, point=replace(run.point, name=f"{run.point.name}-repeat-{number}"))
