"""`wrinkle cost`: error against time for every method, mesh and way to iterate of one scene.

Every run is a process of its own, alone on the machine; its folder carries the digest of the solvers' sources, so that
a second call solves only what is missing and a changed solver solves everything anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from cases.cost_plan import EVERYTHING, OPTIONS_MESH, CostRun, Extent, plan, repeat
from cases.cost_reference import Reference
from cases.cost_table import Measured, as_row, fronts, measure, sentences
from cases.files import json_text
from cases.folders import recover
from cases.interrupt import Interruption
from cases.machine import code, machine, source_digest, versions
from cases.methods import METHODS, methods_of
from cases.scene import load_scene
from cases.schema import Scene
from cases.study import TO_DO
from cases.study_points import Point
from cases.study_pool import solve_here
from cases.study_table import result_of
from fdsolver.checkpoint import make_folder, write_atomically

SOLVERS = ("fdsolver", "tensionfield", "femref")
REPEAT_SECONDS = 20.0  # of the longest run that is repeated
Say = Callable[[str], None]


@dataclass(frozen=True)
class Cost:
    """What `cost` found. omitted : what was left out -> why."""

    scene: str
    rows: list[Measured]
    references: list[Reference]
    sentences: list[str]
    omitted: dict[str, str]


def cost(
    source: str,
    out: Path | str,
    changes: Mapping[str, object] | None = None,
    methods: Sequence[str] | None = None,
    extent: Extent = EVERYTHING,
    say: Say | None = None,
    interruption: Interruption | None = None,
) -> Cost:
    """Run what is missing and write `out`/cost.csv and cost.json.

    source, changes : scene and dotted keys. methods : None takes all that fit. extent : meshes, options, repeats and
    the time limit of each run. say : called with a line per run.

    Raises SceneError for a scene that cannot be used, KeyboardInterrupt after an interruption (finished runs are kept).
    """
    out = Path(out)
    folder = out / "runs" / source_digest(SOLVERS)[:12]
    make_folder(folder)
    runs = plan(source, changes or {}, methods, extent)
    _solve([run.point for run in runs], folder, say, interruption)
    repeats = {run.point.name: _repeats(run, folder, extent.repeats) for run in runs}
    _solve([again.point for some in repeats.values() for again in some], folder, say, interruption)
    scene = load_scene(source, dict(changes or {}))
    pairs = [(run, repeats[run.point.name]) for run in runs]
    rows, found = measure(pairs, folder, scene.sheet.thickness_mm)
    result = Cost(scene.name, rows, found, sentences(rows, found), _omitted(scene, methods, extent))
    _write(result, out)
    return result


def _solve(points: Sequence[Point], folder: Path, say: Say | None, interruption: Interruption | None) -> None:
    """Solve what has no result yet, one at a time: two at once would disturb each other's times."""
    for point in points:
        recover(folder / point.name)
    to_do = [point for point in points if not point.refused and result_of(point, folder)["status"] in TO_DO]
    done = len(points) - len(to_do)

    def finished(point: Point) -> None:
        nonlocal done
        done += 1
        if say is not None:
            result = result_of(point, folder)
            used = f", {result['cpu_seconds']:.3g} s" if "cpu_seconds" in result else f": {result['message']}"
            say(f"[{done}/{len(points)}] {point.name}: {result['status']}{used}")

    solve_here(to_do, folder, 1, False, finished, interruption)


def _repeats(run: CostRun, folder: Path, count: int) -> list[CostRun]:
    """The repeats of a run that is short enough, so that there are `count` in all."""
    result = result_of(run.point, folder)
    short = "seconds" in result and result["seconds"] < REPEAT_SECONDS
    return [repeat(run, number) for number in range(2, count + 1)] if short else []


def _omitted(scene: Scene, methods: Sequence[str] | None, extent: Extent) -> dict[str, str]:
    """What the table does not have."""
    fitting = methods_of(scene)
    left = {
        method: "the scene has no such solution" if method not in fitting else "not asked for"
        for method in METHODS
        if method not in (fitting if methods is None else methods)
    }
    if extent.options:
        left["combinations of options"] = (
            f"damping, mass, tolerance and the like are changed one at a time, at about {OPTIONS_MESH} nodes"
        )
    else:
        left["other ways to iterate"] = "damping, mass, tolerance and the like were not asked for"
    left["finer meshes"] = (
        f"finite differences up to {max(extent.meshes)} nodes,"
        f" finite elements up to {max(extent.vertices, default=0)} vertices"
    )
    left["compilation"] = "kernels are compiled once per machine; the time stands in its own column"
    left["several threads"] = "every run has one thread; the scaling table has the others"
    return left


def _write(found: Cost, out: Path) -> None:
    """cost.csv, one row per run, and cost.json, everything else. Raises StorageError."""
    import pandas as pd

    table = pd.DataFrame([as_row(one) for one in found.rows]).to_csv(index=False)
    write_atomically(out / "cost.csv", lambda file: file.write(table.encode("utf-8")))
    quantities = dict.fromkeys(reference.quantity for reference in found.references)
    document: dict[str, Any] = {
        "scene": found.scene,
        "sentences": found.sentences,
        "references": [asdict(reference) for reference in found.references],
        "pareto": {
            name: {
                model: [one.run.point.name for one in front]
                for model, front in fronts(found.rows, name).items()
            }
            for name in quantities
        },
        "omitted": found.omitted,
        "rows": [as_row(one) for one in found.rows],
        "versions": versions(),
        "machine": machine(),
        "code": code(),
    }
    write_atomically(out / "cost.json", lambda file: file.write(json_text(document).encode("utf-8")))
