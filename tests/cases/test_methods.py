"""Methods: chosen, refused, their numbers, and what a run says about its wrinkles."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cases import load_scene, run
from cases import methods as methods_module
from cases.advice import advice
from cases.methods import METHODS, MethodError, Task, choose, methods_of
from fdsolver import meshes
from fdsolver.result import Solution, Status
from tests.cases.made import Fake, made_solution


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"nodes": 1}, "nodes must be a whole number from 400 to 50000000, not 1."),
        ({"nodes": 10**9}, "nodes must be a whole number from 400 to 50000000, not 1000000000."),
        ({"nodes": 500.0}, "nodes must be a whole number from 400 to 50000000, not 500.0."),
        ({"seed": -1}, "seed must be a whole number from 0 to 2^63 - 1, not -1."),
        ({"seed": True}, "seed must be a whole number from 0 to 2^63 - 1, not True."),
        ({"threads": 0}, "threads must be a whole number from 1 to 1024, not 0."),
        ({"tolerance": 0.0}, "tolerance must be a residual from 1e-14 to 0.1, not 0.0."),
        ({"tolerance": float("nan")}, "tolerance must be a residual from 1e-14 to 0.1, not nan."),
        ({"method": "tension"}, "There is no method 'tension'; there are auto, tension-field"),
    ],
    ids=str,
)
def test_bad_numbers_and_names_write_nothing(words: dict, sentence: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with pytest.raises(MethodError, match=re.escape(sentence)):
        run(load_scene("strip-tension"), **({"method": "exact", "out": out} | words))
    assert not out.exists()


def test_the_published_scheme_is_for_rectangles() -> None:
    with pytest.raises(MethodError, match="koiter-published cannot solve this: it is for rectangles"):
        choose(load_scene("annulus"), "koiter-published")
    assert choose(load_scene("shear"), "koiter-published")[0].name == "koiter-published"


def test_a_part_of_a_symmetric_sheet_is_refused_by_name_where_it_cannot_be_solved() -> None:
    """The published scheme and the finisher know whole sheets only; neither drops the symmetry in silence."""
    quarter = {"symmetry.reduce": "quarter", "mesh.nodes": 600}
    with pytest.raises(MethodError, match="symmetry.reduce = 'quarter' cannot be solved by koiter-published"):
        choose(load_scene("stretch", quarter), "koiter-published")
    finished = load_scene("stretch", {**quarter, "solver.finish": "on"})
    for method in ("koiter", "tension-field", "membrane"):
        with pytest.raises(MethodError, match=f"part of a symmetric sheet cannot be solved by {method}"):
            choose(finished, method)
        assert choose(load_scene("stretch", quarter), method)[0].name == method


@pytest.mark.parametrize(
    ("method", "key", "value"),
    [
        ("tension-field", "symmetry.reduce", "half-x"),
        ("tension-field", "start.from", "mode:1"),
        ("exact", "start.from", "runs/other"),
        ("koiter", "effects.kinematics", "moderate"),
        ("koiter", "effects.out_of_plane", "off"),
        ("koiter", "effects.strain_gradient", "off"),
    ],
)
def test_keys_that_would_be_dropped_are_refused(method: str, key: str, value: str) -> None:
    with pytest.raises(MethodError, match=re.escape(f"{key} = '{value}'")):
        choose(load_scene("annulus", {key: value}), method)


def test_what_a_membrane_lacks_anyway_may_be_off() -> None:
    scene = load_scene("annulus", {"effects.bending": "off", "effects.strain_gradient": "off"})
    assert choose(scene, "tension-field")[0].name == "tension-field"


def test_auto_says_what_it_chose_and_why() -> None:
    """Thin sheets wrinkle too finely for a coarse mesh; thick ones do not."""
    thin = load_scene("annulus", {"mesh.nodes": 2000, "sheet.thickness_mm": 0.001})
    thick = load_scene("annulus", {"mesh.nodes": 2000, "sheet.thickness_mm": 20.0})
    for scene, name, reason in ((thin, "tension-field", "cannot resolve"), (thick, "koiter", "resolves")):
        method, why = choose(scene, "auto")
        assert method.name == name
        assert reason in why
    still = load_scene("annulus", {"edges.inner.move_mm": [0, 0, 0], "edges.inner.rotate_deg": 0})
    assert choose(still, "auto")[0].name == "koiter"


def test_a_turn_beyond_half_a_circle_is_in_the_warnings_of_the_run() -> None:
    for turn, count in ((170.0, 0), (300.0, 1)):
        scene = load_scene("annulus", {"edges.inner.rotate_deg": turn, "solver.max_steps": 2000})
        warnings = run(scene, "tension-field", nodes=400).warnings
        assert sum("stand where a turn by -60 degrees" in warning for warning in warnings) == count


def test_the_reason_of_auto_is_in_the_warnings(faked: Fake) -> None:
    faked(lambda task: made_solution(meshes.annulus(62.5, 250.0, 400)))
    scene = load_scene("annulus", {"mesh.nodes": 2000, "sheet.thickness_mm": 0.001})
    assert run(scene).warnings[0].startswith("auto chose tension-field: the mesh cannot resolve")


def test_defaults_that_a_scene_left_open_are_named(faked: Fake, tmp_path: Path) -> None:
    faked(lambda task: made_solution(meshes.rectangle(100.0, 50.0, 400)))
    path = tmp_path / "scene.toml"
    path.write_text(
        '[sheet]\nshape = "rectangle"\nwidth_mm = 100.0\nheight_mm = 50.0\n[edges.left]\nsupport = "pinned"\n'
    )
    warnings = run(load_scene(path), method="tension-field").warnings
    assert any("sheet.thickness_mm" in warning and "material.poisson" in warning for warning in warnings)


@pytest.mark.parametrize(
    ("status", "strict", "expected"),
    [
        (Status.CONVERGED, False, Status.CONVERGED),
        (Status.CONVERGED, True, Status.UNDER_RESOLVED),
        (Status.STEP_LIMIT, True, Status.UNDER_RESOLVED),
        (Status.HOURGLASS, True, Status.HOURGLASS),
        (Status.INTERRUPTED, True, Status.INTERRUPTED),
    ],
)
def test_coarse_wrinkles_are_warned_of_and_strictly_a_status(
    status: Status, strict: bool, expected: Status, faked: Fake
) -> None:
    grid = meshes.rectangle(100.0, 50.0, 2000)
    spacing = 100.0 / (grid.ni - 1)
    wave = made_solution(grid, lambda x, y: np.cos(2.0 * np.pi * x / (5.0 * spacing)))
    faked(lambda task: replace(wave, status=status))
    solution = run(load_scene("strip-tension"), method="tension-field", strict=strict)
    assert solution.status is expected
    assert any("5.0 nodes each, fewer than 6" in warning for warning in solution.warnings)


def test_a_checkerboard_of_wrinkles_too_short_for_the_mesh_says_how_many_nodes_they_need(faked: Fake) -> None:
    """A fifth more nodes along both directions: 1.44 times as many."""
    grid = meshes.rectangle(100.0, 50.0, 2000)
    spacing = 100.0 / (grid.ni - 1)
    wave = made_solution(grid, lambda x, y: np.cos(2.0 * np.pi * x / (5.0 * spacing)))
    faked(lambda task: replace(wave, status=Status.HOURGLASS, message=Status.HOURGLASS.sentence))
    message = run(load_scene("strip-tension"), method="tension-field").message
    assert message == Status.HOURGLASS.sentence + (
        " Its wrinkles are too short for this mesh: they need at least some 3000 nodes."
    )


@pytest.mark.parametrize(
    ("status", "key"), [(Status.STEP_LIMIT, "solver.max_steps"), (Status.TIME_LIMIT, "solver.max_seconds")]
)
def test_a_run_at_a_limit_says_how_to_go_on(status: Status, key: str, faked: Fake) -> None:
    flat = made_solution(meshes.rectangle(100.0, 50.0, 400))
    faked(lambda task: replace(flat, status=status, message=status.sentence))
    message = run(load_scene("strip-tension"), method="tension-field").message
    assert message.startswith(status.sentence) and "--resume" in message and message.endswith(f"raise {key}.")
    assert "resume" not in advice(Status.CONVERGED, 400, 3.0)


def test_wrinkles_of_enough_nodes_are_not_warned_of(faked: Fake) -> None:
    grid = meshes.rectangle(100.0, 50.0, 2000)
    spacing = 100.0 / (grid.ni - 1)
    faked(lambda task: made_solution(grid, lambda x, y: np.cos(2.0 * np.pi * x / (7.0 * spacing))))
    solution = run(load_scene("strip-tension"), method="tension-field", strict=True)
    assert solution.status is Status.CONVERGED
    assert not any("nodes each" in warning for warning in solution.warnings)


def test_progress_reaches_the_engine() -> None:
    seen = []
    run(
        load_scene("annulus", {"symmetry.reduce": "none"}),
        method="tension-field",
        nodes=900,
        progress=seen.append,
    )
    assert seen
    assert seen[-1].tolerance == 1e-8
    assert seen[-1].nodes == pytest.approx(900, rel=0.05)


def test_the_default_tolerance_is_the_methods_and_the_scenes_wins(faked: Fake) -> None:
    seen = []

    def record(task: Task) -> Solution:
        seen.append(task.scene.solver.tolerance)
        return made_solution(meshes.rectangle(100.0, 50.0, 400))

    faked(record)
    run(load_scene("strip-tension"), method="tension-field")
    run(load_scene("strip-tension", {"solver.tolerance": 1e-5}), method="tension-field")
    run(load_scene("strip-tension", {"solver.tolerance": 1e-5}), method="tension-field", tolerance=1e-4)
    assert seen == [1e-8, 1e-5, 1e-4]
    assert METHODS["koiter"].tolerance == 1e-6
    assert METHODS["membrane"].tolerance == 1e-8


def test_only_plates_start_from_a_perturbation() -> None:
    scene = load_scene("hole", {"start.perturbation": 1e-4})
    problem = methods_module.problem_of
    assert problem(scene, methods_module.KOITER, seed=2).perturbation == 1e-4
    assert problem(scene, methods_module.KOITER, seed=2).seed == 2
    assert problem(scene, methods_module.MEMBRANE, seed=2).perturbation == 0.0


def test_scenes_with_a_closed_form_have_the_method_exact() -> None:
    assert methods_of(load_scene("annulus")) == ("tension-field", "membrane", "koiter", "exact")
    assert "exact" in methods_of(load_scene("shear-rails"))
    for name in ("hole", "stretch", "shear"):
        assert "exact" not in methods_of(load_scene(name))
