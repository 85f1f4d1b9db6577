"""`wrinkle plan`: what a scene calls for and will cost, held against runs of it."""

from __future__ import annotations

import json
import math

import pytest

from cases import load_scene, rates, run
from cases.__main__ import main
from cases.boundary import problem_of, settings_of
from cases.effects import decide
from cases.methods import MethodError
from cases.pilot import FINER, Pilot, pilot
from cases.plan import lines, plan
from cases.rates import rate
from fdsolver.model import KOITER
from fdsolver.multilevel import solve
from tensionfield.relaxed import TENSION_FIELD


def test_the_mesh_has_eight_nodes_per_wrinkle_and_the_accuracy() -> None:
    scene = load_scene("stretch", {"mesh.nodes": 2000})
    found = plan(scene, "koiter", accuracy=1e-5)
    assert found.nodes_for_wrinkles is not None and found.nodes_for_accuracy is not None
    assert found.nodes >= max(found.nodes_for_wrinkles, found.nodes_for_accuracy)
    area = scene.sheet.width_mm * scene.sheet.height_mm
    assert found.wavelength_mm / math.sqrt(area / found.nodes_for_wrinkles) == pytest.approx(8.0, rel=0.01)
    finer = plan(scene, "koiter", accuracy=1e-6)
    # second order: a tenth of the error takes ten times the nodes
    assert finer.nodes_for_accuracy == pytest.approx(10 * found.nodes_for_accuracy, rel=0.01)


def test_the_foretold_accuracy_is_reached() -> None:
    """Against a much finer mesh; the aim of a plan is a factor of two."""
    scene = load_scene("hole")
    accuracy = 4e-4  # at coarser ones the smallest mesh is more than enough
    nodes = plan(scene, "tension-field", accuracy=accuracy).nodes
    assert nodes > 600
    energies = [
        run(load_scene("hole", {"mesh.nodes": count}), method="tension-field").energy_N_mm["total"]
        for count in (nodes, 9 * nodes)
    ]
    assert 0.5 * accuracy < abs(energies[0] / energies[1] - 1.0) * 9 / 8 < 2.0 * accuracy


def test_coarse_meshes_and_unsuitable_sheets_are_warned_of() -> None:
    found = plan(load_scene("annulus", {"mesh.nodes": 2000}), "koiter")
    assert any("do not resolve" in warning for warning in found.warnings)
    assert any("nodes per wrinkle" in line for line in lines(found))
    assert not plan(load_scene("strip-tension", {"mesh.nodes": 2000}), "tension-field").warnings


def test_symmetry_and_effects_cost_less() -> None:
    whole = plan(load_scene("stretch", {"mesh.nodes": 20_000}), "koiter")
    quarter = plan(load_scene("stretch", {"mesh.nodes": 20_000, "symmetry.reduce": "quarter"}), "koiter")
    assert quarter.memory_MB < whole.memory_MB
    flat = {"mesh.nodes": 20_000, "edges.top.move_mm": [0.0, 76.2, 0.0]}
    plane = plan(load_scene("stretch", flat), "koiter")
    space = plan(load_scene("stretch", {**flat, "effects.out_of_plane": "on"}), "koiter")
    assert plane.memory_MB < space.memory_MB


def test_the_steps_of_a_ray_grow_with_its_nodes() -> None:
    tried = Pilot(((50, 900, 0), (100, 500, 0)), True, 1e-7, 0.0, cpu_seconds=1.0, dimensions=1)
    assert tried.steps([50, 100, 200])[2] == pytest.approx(500 * 2 * FINER)


def test_a_pilot_foretells_finer_meshes() -> None:
    """Steps grow with the nodes along the sheet; seconds with the work, of which some is no stepping."""
    tried = Pilot(((1000, 900, 100), (4000, 500, 0)), True, node_seconds=1e-7, examined=0.0, cpu_seconds=2.0)
    assert tried.steps([1000, 4000]) == pytest.approx([900, 500])
    assert tried.steps([1000, 4000, 16_000])[2] == pytest.approx(500 * 2 * FINER)
    assert tried.seconds([1000, 4000]) == pytest.approx(2.0)
    work = 1000 * 1000 + 4000 * 500
    assert tried.seconds([1000, 4000, 16_000]) == pytest.approx(2.0 * (work + 16_000 * 1000 * FINER) / work)
    still = Pilot(((1000, 0, 0), (4000, 0, 0)), True, node_seconds=1e-7, examined=3e-5, cpu_seconds=0.5)
    assert still.seconds([1000, 4000, 15_000]) == pytest.approx(
        2.0
    )  # nothing but the examination, node by node


@pytest.mark.parametrize("name", ["stretch", "hole"])
def test_a_pilot_s_coarse_mesh_is_the_run_s_own(name: str) -> None:
    """The plate with a hole is thicker on coarse meshes, and on that one it folds over if it is not thick enough."""
    scene = load_scene(name, {"mesh.nodes": 9000})
    model, _ = decide(scene, KOITER)
    settings = settings_of(scene, 1e-6)
    tried = pilot(scene, model, settings.tolerance, node_seconds=1e-7)
    own = solve(problem_of(scene, model, seed=0), model, settings).levels[0]
    assert tried.levels[0][:2] == (own["nodes"], own["steps"])
    assert tried.levels[1][0] < 0.7 * scene.mesh.nodes


@pytest.mark.parametrize(("name", "method"), [("annulus", "tension-field"), ("stretch", "koiter")])
def test_steps_are_foretold_within_a_factor_of_two(name: str, method: str) -> None:
    scene = load_scene(name, {"mesh.nodes": 12_000})
    foretold, found = plan(scene, method), run(scene, method=method)
    assert 0.5 < foretold.steps / found.steps < 2.0


def test_the_rate_is_measured_once(monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(rates, "_cache_file", lambda: tmp_path / "rates.json")
    first = rate(TENSION_FIELD)
    assert json.loads((tmp_path / "rates.json").read_text()) == {"Relaxed membrane 3 none finite": first}
    (tmp_path / "rates.json").write_text(json.dumps({"Relaxed membrane 3 none finite": 123.0}))
    assert rate(TENSION_FIELD) == 123.0
    (tmp_path / "rates.json").write_text("{damaged")
    assert rate(TENSION_FIELD) > 1e4  # measured again


def test_methods_without_a_foretold_cost_are_refused() -> None:
    with pytest.raises(MethodError, match="not foretold; it is of tension-field, membrane, koiter"):
        plan(load_scene("strip-tension"), "exact")


def test_the_command_prints_the_plan(capsys) -> None:
    assert main(["plan", "hole", "--accuracy", "2%"]) == 0
    printed = capsys.readouterr().out
    for word in ("method", "effect    out_of_plane", "wrinkles", "mesh", "CPU seconds"):
        assert word in printed
    assert main(["plan", "hole", "--set", "mesh.nodes=1"]) == 2
