"""What `wrinkle plan` foretells against what runs in processes of their own take."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from cases import load_scene
from cases.plan import plan
from cases.scene_text import scene_toml
from cases.schema import Scene
from tests.benchmarks.effects_runs import write_rows
from tests.benchmarks.random_scenes import random_scenes
from tests.benchmarks.record import Verification

SCENES = {
    "stretch": ("koiter", {"mesh.nodes": 20_000}),
    "shear": ("koiter", {"mesh.nodes": 8_000}),
    "hole": ("koiter", {"mesh.nodes": 8_000}),
    "hole, finer": ("koiter", {"mesh.nodes": 20_000}),
    "hole, tension field": ("tension-field", {"mesh.nodes": 10_000}),
    "annulus": ("tension-field", {"mesh.nodes": 20_000}),
    "annulus, plate": ("koiter", {"mesh.nodes": 12_000}),
}
UNTUNED, SEED = 6, 99  # scenes that no constant of the plan was fitted to
WITHIN = 2.0


def outcome(scene: Scene, method: str, folder: Path) -> dict[str, Any]:
    """result.json of a run in a process of its own, whose peak memory is the run's."""
    text = folder.with_suffix(".toml")
    text.parent.mkdir(parents=True, exist_ok=True)
    text.write_text(scene_toml(scene), encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "cases",
        "run",
        str(text),
        "--method",
        method,
        "--out",
        str(folder),
        "--force",
    ]
    subprocess.run(command, check=False, capture_output=True)
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))


def row(what: str, scene: Scene, method: str, folder: Path) -> dict[str, Any]:
    """Foretold and found, side by side."""
    began = time.process_time()
    foretold = plan(scene, method)
    took = time.process_time() - began
    found = outcome(scene, foretold.method, folder)
    return {
        "what": what,
        "method": foretold.method,
        "nodes": found["nodes"],
        "status": found["status"],
        "plan_cpu_seconds": took,
        "steps": [foretold.steps, found["steps"]],
        "cpu_seconds": [foretold.cpu_seconds, found["cpu_seconds"]],
        "memory_MB": [foretold.memory_MB, found["peak_memory_MB"]],
        "nodes_per_wrinkle": [foretold.nodes_per_wrinkle, found["nodes_per_wrinkle"]],
        "warnings": list(foretold.warnings),
    }


def off_by(pair: list[float]) -> float:
    """The factor between what was foretold and what was found, 1 or more; 1 where there is nothing to do."""
    small, large = sorted(pair)
    return large / small if small > 0 else (1.0 if large == 0 else float("inf"))


def test_a_plan_is_right_within_a_factor_of_two(verify: Verification) -> None:
    """`wrinkle plan` on the four scenes and on random scenes that nobody tuned it for, against runs"""
    drawn = random_scenes(UNTUNED, SEED)
    cases = [
        (name, load_scene(name.split(",")[0], changes), method) for name, (method, changes) in SCENES.items()
    ]
    fine = {"mesh.nodes": 8_000, "solver.tolerance": 1e-7, "solver.max_steps": 20_000}
    cases += [(each.what, each.scene(**fine), "auto") for each in drawn]
    rows: list[dict[str, Any]] = []
    for k, (what, scene, method) in enumerate(cases):
        rows.append(row(what, scene, method, verify.root / "effects" / f"plan-{k}"))
        write_rows(verify.root, "plan", rows)
    at_rest = [each for each in rows if each["status"] == "converged"]
    for each in at_rest:
        verify.note(f"{each['what']}: steps foretold over found", each["steps"][0] / max(each["steps"][1], 1))
        cpu = each["cpu_seconds"]
        verify.note(f"{each['what']}: CPU seconds foretold over found", cpu[0] / cpu[1])
        verify.below(
            f"{each['what']}: memory", off_by(each["memory_MB"]), WITHIN, "asked for: a factor of two"
        )
        verify.below(f"{each['what']}: steps", off_by(each["steps"]), WITHIN, "asked for: a factor of two")
    verify.above("runs that came to rest", len(at_rest), len(SCENES) + 3, "fewer say little")
