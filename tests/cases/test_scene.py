"""Scenes: the built-in ones against their sources, defaults, changes, writing and reading back, identity."""

from __future__ import annotations

import dataclasses
import math
import tomllib

import numpy as np
import pytest

from cases.checks import moved
from cases.scene import Scene, SceneError, load_scene, scene_hash, scene_names, scene_toml
from cases.schema import Line
from tensionfield.annulus import AnnulusProblem, solve_annulus

NAMES = (
    "stretch",
    "shear",
    "hole",
    "annulus",
    "annulus-lift",
    "annulus-shrink",
    "annulus-twist",
    "shear-rails",
    "strip-tension",
)


def supports(scene: Scene) -> dict[str, str]:
    return {name: edge.support for name, edge in scene.edges.items()}


def test_the_built_in_scenes_are_these():
    assert scene_names() == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_built_in_scene_gives_everything_physical_itself(name):
    scene = load_scene(name)
    assert scene.assumed == ()
    assert scene.name == name and len(scene.title) > 10


def test_stretch_is_that_of_the_paper():
    scene = load_scene("stretch")
    assert (scene.sheet.width_mm, scene.sheet.height_mm, scene.sheet.thickness_mm) == (101.6, 254.0, 0.1)
    assert (scene.material.young_MPa, scene.material.poisson) == (1.0, 0.5)
    assert supports(scene) == {"left": "free", "right": "free", "bottom": "pinned", "top": "pinned"}
    assert scene.edges["top"].move_mm == (0.0, 25.4, 0.0)
    assert scene.sections["midsection"] == line([-50.8, 0.0], [50.8, 0.0])


def test_shear_is_that_of_the_paper():
    scene = load_scene("shear")
    assert (scene.sheet.width_mm, scene.sheet.height_mm, scene.sheet.thickness_mm) == (380.0, 128.0, 0.025)
    assert (scene.material.young_MPa, scene.material.poisson) == (3500.0, 0.31)
    assert supports(scene) == {"left": "free", "right": "free", "bottom": "clamped", "top": "clamped"}
    assert scene.edges["top"].move_mm == (0.5, 0.0, 0.0)


def test_hole_is_that_of_the_paper():
    scene = load_scene("hole")
    sheet = scene.sheet
    assert (sheet.width_mm, sheet.height_mm, sheet.hole_radius_mm, sheet.thickness_mm) == (
        50.0,
        125.0,
        15.0,
        0.01,
    )
    assert (scene.material.young_MPa, scene.material.poisson) == (3500.0, 0.31)
    assert supports(scene)["hole"] == "free"
    assert scene.edges["top"].move_mm == (0.0, 6.25, 0.0) and scene.edges["bottom"].move_mm == (
        0.0,
        -6.25,
        0.0,
    )
    assert scene.mesh.nodes == 40_000
    assert scene.paths == {
        "along_x": line([15.0, 0.0], [25.0, 0.0]),
        "along_y": line([0.0, 15.0], [0.0, 62.5]),
    }


def test_annulus_is_that_of_the_paper():
    scene = load_scene("annulus")
    assert (scene.sheet.inner_radius_mm, scene.sheet.outer_radius_mm) == (62.5, 250.0)
    assert supports(scene) == {"inner": "pinned", "outer": "pinned"}
    assert scene.edges["inner"].move_mm == (0.0, 0.0, 125.0) and scene.edges["inner"].rotate_deg == 90.0
    assert scene.mesh.nodes == 20_000
    assert scene.paths == {"radius": line([62.5, 0.0], [250.0, 0.0])}
    assert [ring.radius_mm for ring in scene.sections.values()] == [109.375, 156.25, 203.125]


@pytest.mark.parametrize(
    ("name", "states", "switch_mm"),
    [("annulus-lift", (2,), None), ("annulus-twist", (1, 2), 198.727), ("annulus-shrink", (1, 2), 181.195)],
)
def test_annulus_scenes_wrinkle_where_their_comments_say(name, states, switch_mm):
    scene = load_scene(name)
    inner = scene.edges["inner"]
    exact = solve_annulus(
        AnnulusProblem(
            scene.sheet.inner_radius_mm,
            scene.sheet.outer_radius_mm,
            scene.material.young_MPa,
            scene.material.poisson,
            scene.sheet.thickness_mm,
            lift_mm=inner.move_mm[2],
            twist_deg=inner.rotate_deg,
            inner_grow_mm=inner.grow_mm,
        )
    )
    assert exact.states == states
    if switch_mm is not None:
        assert exact.switch_radii_mm == pytest.approx((switch_mm,), abs=5e-4)  # the comment's last digit


def test_rails_move_rigidly_by_one_affine_map():
    scene = load_scene("shear-rails")
    half = np.array([scene.sheet.width_mm, scene.sheet.height_mm]) / 2.0
    sine, cosine = math.sin(math.radians(1.0)), math.cos(math.radians(1.0))
    gradient = np.array([[1.0, sine], [0.0, cosine]])
    corner = -half
    sides = {"left": (0, -1), "right": (0, 1), "bottom": (1, -1), "top": (1, 1)}
    for name, (axis, sign) in sides.items():
        for part in (-1.0, -0.3, 0.5, 1.0):
            point = part * half
            point[axis] = sign * half[axis]
            expected = corner + gradient @ (point - corner)
            there = moved(scene.edges[name], *point)
            # the file's numbers are rounded to 16 digits of at most 100 mm
            assert np.allclose(there, (*expected, 0.0), rtol=0.0, atol=1e-13)
    strain = (gradient.T @ gradient - np.eye(2)) / 2.0
    assert np.allclose(strain, [[0.0, sine / 2.0], [sine / 2.0, 0.0]], rtol=0.0, atol=1e-16)


@pytest.mark.parametrize("name", NAMES)
def test_scene_survives_writing_and_reading(name, tmp_path):
    scene = load_scene(name, ["solver.tolerance=1e-7", "mesh.bias=0.3", "material.young_MPa=0.1"])
    file = tmp_path / "other.toml"
    file.write_text(scene_toml(scene))
    assert load_scene(file) == scene


def test_lines_that_are_given_as_empty_stay_empty(tmp_path):
    scene = load_scene("annulus", {"sections": {}})
    assert scene.sections == {} and scene.paths
    file = tmp_path / "other.toml"
    file.write_text(scene_toml(scene))
    assert load_scene(file) == scene


def test_every_key_has_a_default(tmp_path):
    file = tmp_path / "short.toml"
    file.write_text('edges.bottom.support = "pinned"\n')
    scene = load_scene(file)
    assert scene.name == scene.title == "short"
    assert scene.sheet.shape == "rectangle" and scene.mesh.nodes == 20_000
    assert scene.solver.damping == "adaptive" and scene.solver.published == "filtered"
    assert scene.effects.kinematics == "finite" and scene.start.perturbation == 1e-6
    assert supports(scene) == {"left": "free", "right": "free", "bottom": "pinned", "top": "free"}
    # what stands for the sheet itself is named, so that nobody takes it for given
    assert scene.assumed == (
        "sheet.thickness_mm",
        "sheet.shape",
        "sheet.width_mm",
        "sheet.height_mm",
        "material.young_MPa",
        "material.poisson",
    )


def test_changes_by_text_and_by_mapping_agree():
    text = [
        "edges.inner.move_mm=[0, 0, 80]",
        "edges.outer.support=clamped",
        'title="A title"',
        "mesh.nodes=1000",
        "symmetry.reduce=sector:6",
    ]
    mapping = {
        "edges.inner.move_mm": np.array([0, 0, 80]),
        "edges.outer.support": "clamped",
        "title": "A title",
        "mesh.nodes": np.int64(1000),
        "symmetry.reduce": "sector:6",
    }
    scene = load_scene("annulus", text)
    assert scene == load_scene("annulus", mapping)
    assert scene.edges["inner"].move_mm == (0.0, 0.0, 80.0) and scene.edges["inner"].rotate_deg == 90.0


def test_the_last_change_of_a_key_wins():
    assert load_scene("annulus", ["mesh.nodes=1000", "mesh.nodes=2000"]).mesh.nodes == 2000


def test_a_change_does_not_outlive_its_scene():
    load_scene("annulus", ["mesh.nodes=1000"])
    assert load_scene("annulus").mesh.nodes == 20_000


def test_scenes_cannot_be_changed_in_place():
    scene = load_scene("annulus")
    with pytest.raises(dataclasses.FrozenInstanceError):
        scene.title = "another"
    with pytest.raises(ValueError, match="frozen"):
        scene.mesh.nodes = 7


def test_default_lines_follow_the_sheet():
    scene = load_scene("annulus", ["sheet.inner_radius_mm=50", "sheet.outer_radius_mm=90"])
    assert scene.paths["radius"] == line([50.0, 0.0], [90.0, 0.0])
    assert [ring.radius_mm for ring in scene.sections.values()] == [60.0, 70.0, 80.0]


@pytest.mark.parametrize(
    "change",
    [
        "sheet.thickness_mm=0.026",
        "material.poisson=0.3",
        "edges.inner.rotate_deg=91",
        "edges.outer.support=clamped",
        "mesh.bias=0.5",
        "mesh.nodes=20001",
        "solver.tolerance=1e-9",
        "solver.damping=kinetic",
        "start.perturbation=2e-6",
        "effects.bending=off",
        "sections.ring_1.radius_mm=100",
    ],
)
def test_hash_changes_with_what_a_result_depends_on(change):
    assert scene_hash(load_scene("annulus", [change]), "koiter") != scene_hash(
        load_scene("annulus"), "koiter"
    )


@pytest.mark.parametrize(
    "change", ["title=other", "name=other", "solver.max_seconds=7", "solver.max_steps=7"]
)
def test_hash_does_not_change_with_names_and_limits(change):
    assert scene_hash(load_scene("annulus", [change]), "koiter") == scene_hash(
        load_scene("annulus"), "koiter"
    )


def test_hash_knows_method_nodes_seed_and_tolerance():
    scene = load_scene("annulus")
    hashes = [
        scene_hash(scene, "koiter"),
        scene_hash(scene, "membrane"),
        scene_hash(scene, "koiter", nodes=1000),
        scene_hash(scene, "koiter", seed=1),
        scene_hash(scene, "koiter", tolerance=1e-7),
    ]
    assert len(set(hashes)) == len(hashes)
    assert scene_hash(scene, "koiter", nodes=scene.mesh.nodes, tolerance=None) == hashes[0]


def test_name_of_a_file_becomes_a_name_of_a_folder(tmp_path):
    file = tmp_path / "my scene (2).toml"
    file.write_text('edges.left.support = "pinned"\n')
    assert load_scene(file).name == "my-scene-2"


def test_scene_file_in_a_folder_of_a_built_in_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "annulus").mkdir()
    assert load_scene("annulus").name == "annulus"
    with pytest.raises(SceneError, match="is a folder"):
        load_scene("./annulus")


def test_written_scene_has_every_key_of_every_table():
    document = tomllib.loads(
        scene_toml(load_scene("annulus", ["solver.tolerance=1e-7", "solver.levels=2", "mesh.bias=1"]))
    )
    assert set(document) == {
        *("name", "title", "sheet", "material", "edges", "start", "effects", "symmetry", "mesh", "solver"),
        *("sections", "paths"),
    }
    assert set(document["solver"]) == {
        *(
            "tolerance",
            "damping",
            "mass",
            "levels",
            "max_steps",
            "max_seconds",
            "published",
            "thicken",
            "finish",
        ),
        *("snapshots", "prestress", "element", "thinning"),
    }


def line(start, end) -> Line:
    return Line(from_mm=tuple(start), to_mm=tuple(end))
