"""Effects of scenes: what `auto` decides from cheap calculations, what is refused, what the audit says afterwards."""

from __future__ import annotations

import dataclasses
import math
import re

import numpy as np
import pytest

from cases import load_scene, run
from cases.audit import audit
from cases.boundary import problem_of
from cases.effects import EffectError, choose_method, decide, not_justified
from cases.methods import METHODS, MethodError, choose, effects_of
from cases.results import read_document
from cases.schema import Scene
from cases.survey import loads_in_plane, stiffness_against_buckling, survey, wrinkles_of
from fdsolver import meshes
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE
from fdsolver.result import Solution, Status
from tensionfield.relaxed import TENSION_FIELD


def solved(name: str, method: str, **changes: object) -> tuple[Solution, Scene]:
    scene = load_scene(name, {"mesh.nodes": 600, **changes})
    solution = run(scene, method=method)
    assert isinstance(solution, Solution)
    return solution, scene


def test_loads_in_the_plane_do_not_make_a_plate_planar() -> None:
    """A stretched sheet wrinkles; a membrane that is relaxed, or not perturbed, stays in its plane."""
    scene = load_scene("stretch", {"mesh.nodes": 600, "start.perturbation": 0.0})
    assert loads_in_plane(scene)
    plate, effects = decide(scene, KOITER)
    assert plate.out_of_plane
    assert effects["out_of_plane"].size == pytest.approx(survey(scene).wrinkled, abs=0.05)
    assert "may buckle" in effects["out_of_plane"].why
    for model in (TENSION_FIELD, MEMBRANE):
        assert not decide(scene, model)[0].out_of_plane


def test_a_plate_without_compression_is_planar_and_the_audit_proves_it() -> None:
    solution, scene = solved("strip-tension", "koiter")
    model, effects = decide(scene, KOITER)
    assert not model.out_of_plane
    assert solution.stability["stable"] is True
    judged = audit(solution, scene, model, effects)
    assert judged["out_of_plane"].justified == "justified"
    # tension holds the plane as stiffly as bending
    assert judged["out_of_plane"].size == pytest.approx(1.0, abs=0.1)
    assert "no zone is compressed" in judged["out_of_plane"].why
    assert not not_justified(judged)


def test_a_lifted_sheet_is_in_space() -> None:
    for model in (KOITER, TENSION_FIELD, MEMBRANE):
        chosen, effects = decide(load_scene("annulus-lift"), model)
        assert chosen.out_of_plane
        assert "moves out of the plane" in effects["out_of_plane"].why


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("effects.out_of_plane", "off", "moves out of the plane"),
        ("effects.strain_gradient", "off", "normal of the flat sheet"),
        ("effects.kinematics", "moderate", "normal of the flat sheet"),
        ("symmetry.reduce", "quarter", "not loaded symmetrically"),
        ("symmetry.reduce", "sector:7777", "needs at least"),
    ],
)
def test_what_cannot_be_left_out_is_refused(key: str, value: str, sentence: str) -> None:
    with pytest.raises(MethodError, match=sentence):
        choose(load_scene("annulus", {key: value, "mesh.nodes": 600}), "koiter")


def test_a_steep_sheet_is_refused_by_its_number() -> None:
    scene = load_scene("annulus-lift", {"effects.kinematics": "moderate"})
    # lifted by twice its width the sheet rises with at least that slope somewhere
    lift = {"edges.inner.move_mm": [0, 0, 2.0 * scene.sheet.smallest_width_mm]}
    with pytest.raises(EffectError, match="above 0.2"):
        decide(load_scene("annulus-lift", {"effects.kinematics": "moderate", **lift}), KOITER)


def test_the_unwrinkled_compressed_state_is_not_justified(tmp_path) -> None:
    """`membrane` on a stretched sheet is a saddle: strictly that is a status of its own."""
    scene = load_scene("stretch", {"mesh.nodes": 600})
    solution = run(scene, method="membrane", strict=True, out=tmp_path / "run")
    assert solution.status is Status.NOT_JUSTIFIED
    effects = read_document(tmp_path / "run")["effects"]
    assert effects["out_of_plane"]["justified"] == "not justified"
    assert effects["out_of_plane"]["size"] < 0.0
    assert effects["bending"]["justified"] == "not justified"
    assert any("out_of_plane is not justified" in warning for warning in solution.warnings)
    assert run(scene, method="membrane").status is Status.CONVERGED


def test_a_stiff_plate_is_planar_although_it_is_compressed() -> None:
    """The strip appears wrinkled at 2.77 % (finite elements), on the coarse mesh at 2.2 %: not at 1.5, but at 3 %."""
    decided = {}
    for percent in (1.5, 3):
        scene = load_scene("stretch", {"edges.top.move_mm": [0.0, 2.54 * percent, 0.0]})
        decided[percent] = decide(scene, KOITER)
        assert survey(scene).wrinkled > 0.1
    model, effects = decided[1.5]
    assert not model.out_of_plane and model.bending  # the plate's hourglass stiffness stays
    assert "too stiff to buckle" in effects["out_of_plane"].why
    assert not effects["bending"].on
    assert decided[3][0].out_of_plane
    # thin, its waves are too short for a coarse flat plate: nothing cheap says that it stays flat
    thin = load_scene("stretch", {"edges.top.move_mm": [0.0, 5.08, 0.0], "sheet.thickness_mm": 1e-3})
    assert stiffness_against_buckling(thin) is None
    assert decide(thin, KOITER)[0].out_of_plane


@pytest.mark.parametrize(("percent", "verdict"), [(2, "justified"), (10, "not justified")])
def test_a_plate_kept_in_its_plane_is_judged_by_its_stability(percent: int, verdict: str) -> None:
    pull = {"edges.top.move_mm": [0.0, 2.54 * percent, 0.0], "effects.out_of_plane": "off"}
    solution, scene = solved("stretch", "koiter", **{"mesh.nodes": 2500, **pull})
    effects = effects_of(METHODS["koiter"], solution, scene)
    assert {effects[name].justified for name in ("out_of_plane", "bending")} == {verdict}
    whole, _ = solved("stretch", "koiter", **{"mesh.nodes": 2500, **pull, "effects.out_of_plane": "on"})
    same = solution.energy_N_mm["total"] == pytest.approx(whole.energy_N_mm["total"], rel=1e-7)
    assert same == (verdict == "justified")


def test_bending_left_out_is_never_justified_where_something_wrinkles() -> None:
    """However little energy wrinkles hold, a membrane does not say what they are; the size follows the thickness."""
    verdicts = {}
    for thickness in (1e-4, 5.0):
        solution, scene = solved("hole", "tension-field", **{"sheet.thickness_mm": thickness})
        effects = effects_of(METHODS["tension-field"], solution, scene)
        assert effects["out_of_plane"].justified == "justified"
        verdicts[thickness] = effects["bending"]
        assert effects["bending"].justified == "not justified"
        assert re.search(r"wrinkles of about .* mm high, are left out, with", effects["bending"].why)
    # energy per volume goes with D k^2 / h ~ h^2 (T / D)^(1/2) ~ h
    sizes = [verdicts[h].size or 0.0 for h in (1e-4, 5.0)]
    assert sizes[1] / sizes[0] == pytest.approx(5.0 / 1e-4, rel=1e-6)


@pytest.mark.parametrize(("thickness", "verdict"), [(0.5, "justified"), (20.0, "not justified")])
def test_bending_of_a_tense_sheet_is_judged_by_the_energy_it_would_hold(
    thickness: float, verdict: str
) -> None:
    changes = {"sheet.thickness_mm": thickness, "mesh.nodes": 1500}
    solution, scene = solved("annulus-lift", "tension-field", **changes)
    bending = effects_of(METHODS["tension-field"], solution, scene)["bending"]
    assert bending.justified == verdict
    plate, _ = solved("annulus-lift", "koiter", **changes)
    added = plate.energy_N_mm["total"] / solution.energy_N_mm["total"] - 1.0
    # a small energy changes the total by itself, to first order; the rest is in the square of its share
    assert added == pytest.approx(bending.size, rel=0.1)
    assert (added < 1e-3) == (verdict == "justified")


def test_stiffness_against_checkerboards_counts_where_bending_is_left_out() -> None:
    """A strip pulled by 30 % is tense; its corners feel the plate's hourglass stiffness, which a membrane lacks."""
    changes = {"edges.top.move_mm": [0.0, 76.2, 0.0], "mesh.nodes": 4000}
    membrane, scene = solved("stretch", "tension-field", **changes)
    bending = effects_of(METHODS["tension-field"], membrane, scene)["bending"]
    assert bending.justified == "not justified"
    plate, _ = solved("stretch", "koiter", **changes)
    change = np.abs(plate.zone.stretch_minor - membrane.zone.stretch_minor).max()
    assert change > 1e-3
    assert float(bending.why.rsplit(" ", 1)[1]) == pytest.approx(change, rel=0.5)


def test_predicted_wrinkles_of_a_uniform_shortening() -> None:
    """Closed form: a sheet pulled by e and pushed across by d more than it contracts (Cerda and Mahadevan 2003)."""
    grid, sheet = meshes.rectangle(100.0, 50.0, 400), Sheet(1000.0, 0.3, 0.1)
    pull, push = 0.01, 0.02
    green = math.sqrt(1 + 2 * pull), math.sqrt(1 - 2 * push)
    r = np.pad(grid.u * green, ((0, 0), (0, 0), (0, 1)))
    found = wrinkles_of(grid, sheet, r, 100.0)
    ratio = sheet.bending_stiffness_N_mm / (1000.0 * 0.1 * pull)
    wavelength = 2 * math.sqrt(math.pi) * ratio**0.25 * math.sqrt(100.0)
    assert found.wavelength_mm == pytest.approx(wavelength, rel=1e-12)
    short = push - 0.3 * pull
    energy = 2 * sheet.bending_stiffness_N_mm * (2 * math.pi / wavelength) ** 2 * short * 100.0 * 50.0
    assert found.energy_N_mm == pytest.approx(energy, rel=1e-12)
    assert found.height_mm == pytest.approx(wavelength * math.sqrt(short) / math.pi, rel=1e-12)
    assert found.share == pytest.approx(1.0)
    tense = wrinkles_of(grid, sheet, np.pad(1.02 * grid.u, ((0, 0), (0, 0), (0, 1))), 100.0)
    assert (tense.wavelength_mm, tense.energy_N_mm, tense.height_mm, tense.share) == (math.inf, 0.0, 0.0, 0.0)


def test_auto_chooses_the_model_by_what_wrinkles() -> None:
    thin = load_scene("hole", {"mesh.nodes": 2000, "sheet.thickness_mm": 1e-4})
    assert choose_method(thin)[0] == "tension-field"
    assert "cannot resolve" in choose_method(thin)[1]
    thick = load_scene("stretch", {"mesh.nodes": 20_000})
    assert choose_method(thick)[0] == "koiter"
    assert "the mesh resolves" in choose_method(thick)[1]
    flat = choose_method(load_scene("strip-tension"))
    assert flat[0] == "koiter" and "stays flat" in flat[1]
    lifted = choose_method(load_scene("annulus-lift"))
    assert lifted[0] == "tension-field" and "tense everywhere" in lifted[1]


def test_a_flat_plate_has_no_use_for_its_effects() -> None:
    solution, scene = solved("strip-tension", "koiter", **{"effects.out_of_plane": "on"})
    effects = effects_of(METHODS["koiter"], solution, scene)
    assert effects["bending"].on
    assert "did nothing" in effects["bending"].why


def test_a_reduced_scene_gives_the_whole_sheet() -> None:
    whole, _ = solved("hole", "tension-field")
    part, scene = solved("hole", "tension-field", **{"symmetry.reduce": "quarter"})
    assert part.grid.nodes == whole.grid.nodes
    # both stop at a residual of 1e-8 per cell, on some forty cells across
    assert part.energy_N_mm["total"] == pytest.approx(whole.energy_N_mm["total"], rel=1e-8)
    np.testing.assert_allclose(part.zone.stretch_major, whole.zone.stretch_major, rtol=0, atol=1e-4)
    effects = effects_of(METHODS["tension-field"], part, scene)
    assert not effects["symmetry"].on
    assert effects["symmetry"].justified == "justified"


@pytest.mark.parametrize("name", ["annulus", "annulus-lift", "annulus-shrink"])
def test_one_ray_of_a_relaxed_annulus_is_solved_and_gives_the_whole(name: str) -> None:
    part, scene = solved(name, "tension-field", **{"solver.tolerance": 1e-11})
    whole, _ = solved(name, "tension-field", **{"solver.tolerance": 1e-11, "symmetry.reduce": "none"})
    assert part.levels[-1]["nodes"] * 10 < whole.levels[-1]["nodes"] == whole.grid.nodes == part.grid.nodes
    assert part.status is whole.status is Status.CONVERGED
    assert part.residual < 1e-11  # of the whole sheet
    assert part.energy_N_mm["total"] == pytest.approx(whole.energy_N_mm["total"], rel=1e-12)
    np.testing.assert_allclose(part.r, whole.r, rtol=0, atol=1e-9 * scene.sheet.size_mm)
    for edge, reaction in whole.reactions.items():
        push = np.array([*reaction.force_N, *reaction.moment_N_mm / scene.sheet.size_mm])
        found = part.reactions[edge]
        also = np.array([*found.force_N, *found.moment_N_mm / scene.sheet.size_mm])
        size = max(np.abs(push).max(), whole.energy_N_mm["total"] / scene.sheet.size_mm)
        np.testing.assert_allclose(also, push, rtol=0, atol=1e-9 * size)
    effects = effects_of(METHODS["tension-field"], part, scene)
    assert (effects["symmetry"].on, effects["symmetry"].justified) == (False, "justified")
    assert "rays of nodes" in effects["symmetry"].why


@pytest.mark.parametrize(
    ("model", "changes"),
    [
        (KOITER, {}),
        (MEMBRANE, {}),
        (TENSION_FIELD, {"symmetry.reduce": "none"}),
        (TENSION_FIELD, {"solver.finish": "on"}),
        (TENSION_FIELD, {"edges.inner.move_mm": [1.0, 0.0, 125.0]}),
    ],
)
def test_the_whole_annulus_is_solved_where_a_ray_may_not_do(model, changes: dict[str, object]) -> None:
    """Plates and membranes buckle out of their axisymmetric states; sideways loads have none."""
    scene = load_scene("annulus", {"mesh.nodes": 600, **changes})
    assert "symmetry" not in decide(scene, model)[1]
    assert problem_of(scene, model, seed=0).symmetry is None


def test_a_state_with_an_excluded_mode_is_not_justified() -> None:
    """The flat compressed membrane of a quarter model buckles as the whole one does."""
    solution, scene = solved("stretch", "membrane", **{"symmetry.reduce": "quarter"})
    effects = effects_of(METHODS["membrane"], solution, scene)
    assert effects["symmetry"].justified == "not justified"
    assert dataclasses.asdict(effects["symmetry"])["size"] < 0.0


@pytest.mark.parametrize(("thickness_mm", "verdict"), [(0.01, "not justified"), (0.5, "justified")])
def test_a_quarter_of_a_plate_is_justified_where_its_wrinkles_are_resolved(
    thickness_mm: float, verdict: str
) -> None:
    """At 0.01 mm the wrinkles of a quarter and of the whole sheet differ by a tenth in length on such meshes."""
    reduced = {"symmetry.reduce": "quarter", "sheet.thickness_mm": thickness_mm, "mesh.nodes": 1200}
    solution, scene = solved("hole", "koiter", **reduced)
    assert (solution.status, solution.stability["stable"]) == (Status.CONVERGED, True)
    symmetry = effects_of(METHODS["koiter"], solution, scene)["symmetry"]
    assert symmetry.justified == verdict
    assert ("nodes each" in symmetry.why) == (verdict == "not justified")


def test_moderate_rotations_keep_the_wrinkles_that_finite_strains_lose() -> None:
    """A strip pulled by 30 %: Green's strain leaves it no compression, the linear one does (Zheng 2009)."""
    decided = {}
    for kinematics in ("finite", "moderate"):
        pulled = {"edges.top.move_mm": [0.0, 76.2, 0.0], "effects.kinematics": kinematics}
        scene = load_scene("stretch", {"mesh.nodes": 600, **pulled})
        decided[kinematics] = decide(scene, KOITER)[1]["out_of_plane"]
    assert not decided["finite"].on
    assert decided["moderate"].on
    assert (decided["moderate"].size or 0.0) > 0.01
