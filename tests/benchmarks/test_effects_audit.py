"""Effects left out: runs by `auto` against runs with everything on, random scenes against full runs, quarter models."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from cases import load_scene
from cases.effects import JUSTIFIED, EffectError, decide
from cases.methods import choose
from cases.schema import Scene
from tests.benchmarks.effects_runs import (
    EVERYTHING_ON,
    NOTHING,
    Comparison,
    compare,
    write_rows,
)
from tests.benchmarks.random_scenes import RandomScene, random_scenes
from tests.benchmarks.record import Verification

RESOLVED = {"sheet.thickness_mm": 0.5}  # wrinkles that the mesh resolves
TIGHT = {"solver.tolerance": 1e-8}  # the same for both, so that only the models differ
PROBLEMS: Mapping[str, tuple[str, dict[str, Any]]] = {
    "stretch": ("stretch", {"mesh.nodes": 10_000}),
    "shear": ("shear", {"mesh.nodes": 10_000, "solver.tolerance": 1e-6}),
    "hole": ("hole", {"mesh.nodes": 6_000, "solver.tolerance": 1e-6}),
    "annulus": ("annulus", {"mesh.nodes": 12_000, "solver.tolerance": 1e-6}),
    "strip-tension": ("strip-tension", {"mesh.nodes": 20_000}),
    "stretch by 1.5 %": ("stretch", {"mesh.nodes": 20_000, "edges.top.move_mm": [0.0, 3.81, 0.0]}),
    "shear-rails": ("shear-rails", {"mesh.nodes": 5_000}),
    "annulus-lift": ("annulus-lift", {"mesh.nodes": 20_000}),
    "annulus-shrink": ("annulus-shrink", {"mesh.nodes": 12_000, **RESOLVED, "solver.tolerance": 1e-6}),
    "annulus-twist": ("annulus-twist", {"mesh.nodes": 12_000, **RESOLVED, "solver.tolerance": 1e-6}),
}
RANDOM, SEED = 20, 2014


def test_auto_against_everything_on(verify: Verification) -> None:
    """Four scenes and six verification problems as `auto` solves them, against runs with everything on"""
    found = {}
    for name, (scene, changes) in PROBLEMS.items():
        lean = load_scene(scene, {**TIGHT, **changes})
        full = load_scene(scene, {**TIGHT, **changes, **EVERYTHING_ON})
        found[name] = one = compare(name, lean, full)
        quantity, difference = one.largest
        verify.note(f"{name}: verdict", one.verdict)
        verify.note(f"{name}: largest difference, of {quantity}", difference)
        verify.note(f"{name}: times less CPU", one.less_time)
        verify.equal(f"{name}: wrongly justified", one.wrong, False, "never a justified with more than 0.1 %")
        write_rows(verify.root, "table", [each.row() for each in found.values()])
    work = "operations times node-steps, counted: times depend on the machine"
    for name in ("strip-tension", "annulus-lift"):
        verify.equal(f"{name}: verdict", found[name].verdict, JUSTIFIED, "nothing in it wrinkles")
        verify.above(f"{name}: times less work without bending", found[name].less_work, 2.5, work)
    for name in ("strip-tension", "stretch by 1.5 %"):
        verify.equal(f"{name}: verdict", found[name].verdict, JUSTIFIED, "its flat state is stable")
        verify.above(f"{name}: times less work in the plane", found[name].less_work, 1.4, work)


def leanest(drawn: RandomScene) -> Scene:
    """A random scene as `auto` solves it; where that leaves nothing out, without the strain gradient if allowed.

    A relaxed membrane gets its own default residual: a sheet in its plane comes to rest easily.
    """
    scene = drawn.scene()
    method, _ = choose(scene, "auto")
    assert method.model is not None
    if method.model().relaxed:
        return drawn.scene(**{"solver.tolerance": method.tolerance})
    if not all(effect.on for effect in decide(scene, method.model())[1].values()):
        return scene
    try:
        lean = drawn.scene(**{"effects.strain_gradient": "off"})
        decide(lean, method.model())
    except EffectError:
        return scene
    return lean


def test_random_scenes_are_judged_as_full_runs_judge_them(verify: Verification) -> None:
    """Twenty random scenes: the audit's verdict on what was left out against full runs"""
    found: list[Comparison] = []
    for drawn in random_scenes(RANDOM, SEED):
        found.append(compare(drawn.what, leanest(drawn), drawn.scene(**EVERYTHING_ON)))
        write_rows(verify.root, "random", [each.row() for each in found])
    wrong = [each.what for each in found if each.wrong]
    justified = [each for each in found if each.justified]
    verify.equal("wrongly justified", "; ".join(wrong), "", "what the audit is for")
    verify.above("justified", len(justified), 8, "asked for: at least eight of twenty")
    verify.note("not justified", RANDOM - len(justified) - sum(each.verdict == NOTHING for each in found))
    largest = max((each.largest[1] for each in justified), default=0.0)
    verify.below("largest difference of a justified run", largest, 1e-3, "what justified means")


QUARTERS = {
    "stretch": ("koiter", {"mesh.nodes": 16_000}),
    # as thin as its scene has it, this mesh does not resolve its wrinkles, whose heights go with the seed by a quarter
    "hole": ("koiter", {"mesh.nodes": 8_000, **RESOLVED}),
}


@pytest.mark.parametrize("name", QUARTERS)
def test_a_quarter_model_at_a_quarter_of_the_cost(verify: Verification, name: str) -> None:
    """A quarter of a rectangle against the whole sheet, both by the plate with everything on"""
    method, changes = QUARTERS[name]
    quarter = load_scene(name, {**changes, "symmetry.reduce": "quarter"})
    one = compare(f"{name}, quarter", quarter, load_scene(name, {**changes, **EVERYTHING_ON}), method)
    write_rows(verify.root, f"quarter-{name}", [one.row()])
    whole, part = one.full[0], one.lean
    per_step = part.levels[-1]["nodes"] / whole.levels[-1]["nodes"]
    verify.note(f"{name}: verdict", one.verdict)
    verify.note(f"{name}: CPU seconds over those of the whole", part.cpu_seconds / whole.cpu_seconds)
    verify.note(f"{name}: steps over those of the whole", part.steps / whole.steps)
    verify.note(f"{name}: largest difference, of {one.largest[0]}", one.largest[1])
    verify.equal(f"{name}: wrongly justified", one.wrong, False, "never a justified with more than 0.1 %")
    verify.below(
        f"{name}: nodes per step over those of the whole",
        per_step,
        0.28,
        "a quarter, and its lines of ghosts",
    )
