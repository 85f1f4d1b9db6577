"""The method `postbuckling`: a scene in, a result folder out, sections from inside the elements."""

from __future__ import annotations

import json

import numpy as np
import pytest

from cases import load_result, load_scene, run
from cases.bicubic import field_of, sample_bicubic_section
from cases.methods import MethodError, choose, methods_of
from cases.postbuckling_scene import available, mesh_of, mirrors_of, supports_of
from fdsolver.result import Status

# A thick strip, shortened by three times its critical strain pi^2 h^2 / (12 L^2): one half-wave along it, in a second.
STRIP = """
[sheet]
shape = "rectangle"
width_mm = 100.0
height_mm = 20.0
thickness_mm = 1.0
[material]
young_MPa = 100.0
poisson = 0.0
[edges.left]
support = "pinned"
move_mm = [0.0123, 0.0, 0.0]
[edges.right]
support = "pinned"
move_mm = [-0.0123, 0.0, 0.0]
[sections.middle]
from_mm = [-50.0, 0.0]
to_mm = [50.0, 0.0]
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("strip") / "strip.toml"
    path.write_text(STRIP)
    return load_scene(path, {"solver.levels": 2})


@pytest.fixture(scope="module")
def folder(scene, tmp_path_factory):
    out = tmp_path_factory.mktemp("out") / "strip"
    run(scene, "postbuckling", nodes=400, out=out)
    return out


def test_a_buckled_strip_has_the_height_of_its_shortening(folder):
    """An arc of sin(pi x / L) of height a shortens by pi^2 a^2 / (4 L); the load stays at Euler's, to (a / L)^2."""
    document = json.loads((folder / "result.json").read_text())
    assert document["status"] == "converged" and document["stability"]["stable"] is True
    critical = np.pi**2 / 12.0 * 1e-4
    height = 2.0 / np.pi * 100.0 * np.sqrt(2.0 * 0.0123 / 100.0 - critical)
    assert document["sections"]["middle"]["amplitude_mm"] == pytest.approx(height, rel=1e-3)  # (a / L)^2
    euler = critical * 100.0 * 20.0
    assert document["reactions"]["right"]["force_N"][0] == pytest.approx(-euler, rel=2e-3)
    assert document["energy_N_mm"]["gained"] > 0.0
    errors = {entry["quantity"]: entry for entry in document["errors"]}
    assert errors["sections.middle.amplitude_mm"]["discretisation"] < 1e-3 * height


def test_the_folder_holds_the_field_and_gives_it_back(folder, scene):
    solution = load_result(folder)
    assert solution.derivatives.shape == (solution.grid.nodes, 3, 3)
    mesh, values = field_of(solution)
    assert values[:, :, 0].reshape(-1, 3) == pytest.approx(solution.r)
    section = sample_bicubic_section(solution, scene.sections["middle"])
    stored = np.loadtxt(folder / "sections" / "middle.csv", delimiter=",", skiprows=1)
    assert section.z == pytest.approx(stored[:, 3])


def test_sections_come_from_inside_the_elements(folder, scene):
    """Between the vertices the profile is curved: chords would miss the arc by a known part of its height."""
    solution = load_result(folder)
    section = sample_bicubic_section(solution, scene.sections["middle"])
    mesh, _ = field_of(solution)
    at_vertices = np.interp(section.x, mesh.x, np.interp(mesh.x, section.x, section.z))
    sagging = np.abs(section.z - at_vertices).max()
    curvature = (np.pi / 100.0) ** 2 * np.abs(section.z).max()
    chord = np.diff(mesh.x).max() ** 2 / 8.0 * curvature
    assert sagging == pytest.approx(chord, rel=0.1)  # the longest chord need not lie at the crest


def test_a_whole_sheet_and_its_quarter_agree(scene, folder):
    quarter = load_scene(folder / "scene.toml", {"symmetry.reduce": "half-x"})
    half = run(quarter, "postbuckling", nodes=400)
    whole = load_result(folder)
    assert half.grid.nodes == whole.grid.nodes
    assert half.energy_N_mm["bending"] == pytest.approx(whole.energy_N_mm["bending"], rel=1e-6)


def test_the_pulled_strip_is_solved_on_a_quarter():
    scene = load_scene("stretch")
    assert available(scene) == {"x": True, "y": True}
    mirrors = mirrors_of(scene)
    assert (mirrors.x, mirrors.y) == (1, 1)
    # the rigid part of the pull is left out: half the pull at the top, the plane of symmetry instead of the bottom
    supports = supports_of(scene, mirrors)
    assert "bottom" not in supports and supports["top"].move_mm == (0.0, 12.7, 0.0)
    mesh = mesh_of(scene, 5329, mirrors)
    assert mesh.x[0] == mesh.y[0] == 0.0 and mesh.x[-1] == 50.8 and mesh.y[-1] == 127.0


def test_a_sheared_sheet_has_no_mirror():
    assert available(load_scene("shear")) == {"x": False, "y": False}


@pytest.mark.parametrize(
    ("name", "changes", "sentence"),
    [
        ("hole", {}, "not a sheet with a hole"),
        ("shear", {"symmetry.reduce": "quarter"}, "no mirror images across x = 0 and y = 0"),
        ("annulus", {"symmetry.reduce": "sector:4"}, '"quarter" here, not "sector:4"'),
        ("annulus", {"edges.inner.support": "clamped"}, "not clamped"),
        ("stretch", {"start.from": "some/folder"}, "by postbuckling"),
    ],
)
def test_scenes_that_do_not_fit_are_refused(name, changes, sentence):
    with pytest.raises(MethodError, match=sentence):
        choose(load_scene(name, changes), "postbuckling")


def test_sheets_with_very_many_wrinkles_are_not_offered_but_can_be_asked_for():
    assert "postbuckling" in methods_of(load_scene("stretch"))
    assert "postbuckling" not in methods_of(load_scene("shear"))
    assert choose(load_scene("shear"), "postbuckling")[0].name == "postbuckling"


def test_the_time_limit_stops_a_run(scene):
    short = load_scene("stretch", {"solver.max_seconds": 1e-3, "solver.levels": 1})
    solution = run(short, "postbuckling", nodes=500)
    assert solution.status is Status.TIME_LIMIT and "load was reached" in solution.message


def test_a_lifted_annulus_has_the_energy_and_the_pull_of_the_boundary_value_problem():
    """Without twist nothing wrinkles, and bending is 2e-8 of the energy: the axisymmetric membrane is the reference."""
    scene = load_scene("annulus-lift", {"solver.levels": 1})
    exact, found = run(scene, "exact"), run(scene, "postbuckling", nodes=500)
    assert found.status is Status.CONVERGED and found.stability["stable"] is True
    # thirty Hermite arcs stand for the circle: their strain of 1e-5 is small beside that of the lift
    assert found.energy_N_mm["total"] == pytest.approx(exact.energy_N_mm["total"], rel=1e-5)
    assert found.reactions["inner"].force_N[2] == pytest.approx(exact.reactions["inner"].force_N[2], rel=1e-5)
    assert found.energy_N_mm["bending"] > 0.0
