"""A run with effects left out beside full runs of its scene: its audit, its cost, what it reports differently."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cases import run
from cases.effects import JUSTIFIED, NOT_JUSTIFIED, Effects, decide
from cases.methods import choose, effects_of
from cases.schema import Scene
from fdsolver.result import Solution, Status
from fdsolver.verdict import LEFT_OVER
from tests.benchmarks.differences import differences, reported
from tests.generated_code import operations_per_node

NOTHING = "nothing left out"
MOST_DIFFERENT = 1e-3  # of a reported quantity, relative: what "justified" promises
EVERYTHING_ON = {
    "effects.out_of_plane": "on",
    "effects.strain_gradient": "on",
    "effects.kinematics": "finite",
    "symmetry.reduce": "none",
}


@dataclass(frozen=True)
class Comparison:
    """A lean run against full ones. differences : quantity -> relative, beyond the range of the full runs."""

    what: str
    why: str
    effects: Effects
    lean: Solution
    full: Sequence[Solution]
    differences: Mapping[str, float]
    operations: tuple[int, int]

    @property
    def verdict(self) -> str:
        """The audit's verdict on everything that was left out together."""
        verdicts = {effect.justified for effect in self.effects.values()} - {None}
        if not verdicts:
            return NOTHING
        return NOT_JUSTIFIED if NOT_JUSTIFIED in verdicts else JUSTIFIED

    @property
    def largest(self) -> tuple[str, float]:
        """The quantity that differs most, and by how much."""
        return max(self.differences.items(), key=lambda item: item[1], default=("", 0.0))

    @property
    def comparable(self) -> bool:
        """Whether all runs came to rest."""
        return all(each.status is Status.CONVERGED for each in (self.lean, *self.full))

    @property
    def wrong(self) -> bool:
        """Whether "justified" was said of a run that reports something else than the full ones."""
        return self.justified and self.largest[1] > MOST_DIFFERENT

    @property
    def justified(self) -> bool:
        """Whether "justified" was said, and can be held against full runs."""
        return self.verdict == JUSTIFIED and self.comparable

    @property
    def less_work(self) -> float:
        """Node-steps times operations per node of the full run over those of the lean one."""
        lean, full = self.operations
        return node_steps(self.full[0]) * full / (max(node_steps(self.lean), self.lean.grid.nodes) * lean)

    @property
    def less_time(self) -> float:
        """CPU seconds of the full run over those of the lean one."""
        return self.full[0].cpu_seconds / self.lean.cpu_seconds

    def row(self) -> dict[str, Any]:
        """The comparison for the report."""
        quantity, difference = self.largest
        return {
            "what": self.what,
            "method": self.lean.method,
            "why": self.why,
            "nodes": self.lean.grid.nodes,
            "effects": {name: vars(effect) for name, effect in self.effects.items()},
            "verdict": self.verdict,
            "wrong": self.wrong,
            "comparable": self.comparable,
            "cpu_seconds": self.lean.cpu_seconds,
            "cpu_seconds_full": self.full[0].cpu_seconds,
            "less_work": self.less_work,
            "status": self.lean.status.value,
            "status_full": [each.status.value for each in self.full],
            "largest": {"quantity": quantity, "difference": difference},
            "differences": dict(self.differences),
        }


def node_steps(solution: Solution) -> float:
    """Steps times nodes over all nested meshes."""
    return float(sum(level["nodes"] * level["steps"] for level in solution.levels))


def compare(what: str, lean: Scene, full: Scene, method: str = "auto", seeds: int = 2) -> Comparison:
    """Run a scene as it leaves effects out, and with everything on: by several seeds where the plate wrinkles."""
    chosen, why = choose(lean, method)
    assert chosen.model is not None
    solution = run(lean, chosen.name)
    assert isinstance(solution, Solution)
    complete = [run(full, "koiter", seed=0)]
    at_rest = complete[0].status is solution.status is Status.CONVERGED  # else nothing can be compared
    if at_rest and wrinkles(complete[0], full):
        complete += [run(full, "koiter", seed=seed) for seed in range(1, seeds)]
    found = differences(reported(solution, lean), [reported(each, full) for each in complete], full)
    models = [decide(scene, model())[0] for scene, model in ((lean, chosen.model), (full, koiter))]
    counts = [operations_per_node(model) for model in models]
    effects = effects_of(chosen, solution, lean)
    return Comparison(what, why, effects, solution, complete, found, (counts[0], counts[1]))


def koiter() -> Any:
    """The model of everything on."""
    from fdsolver.model import KOITER

    return KOITER


def wrinkles(solution: Solution, scene: Scene) -> bool:
    """Whether a result depends on its seed: it left the plane of its load, or is compressed in space."""
    if any(edge.move_mm[2] for edge in scene.edges.values()):
        return bool(solution.zone.stress_minor.min() < 0.0)
    return bool(np.abs(solution.r[..., 2]).max() > LEFT_OVER * scene.sheet.thickness_mm)


def write_rows(root: Path, name: str, rows: Sequence[Mapping[str, Any]]) -> None:
    """Leave rows for the report in ROOT/effects/NAME.json."""
    folder = root / "effects"
    folder.mkdir(parents=True, exist_ok=True)
    unfinished = folder / f"{name}.part"
    unfinished.write_text(json.dumps(list(rows), indent=1), encoding="utf-8")
    unfinished.replace(folder / f"{name}.json")
