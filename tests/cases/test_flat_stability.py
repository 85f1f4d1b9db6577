"""The flat sheet of a scene along its load, by nominal strain."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from cases import load_scene
from cases.flat_stability import along_the_load, over_aspect_ratios, pulled_rectangle, window_of
from cases.methods import nominal_strain
from cases.schema import Scene

# a strip without lateral strain, pushed: Euler's column of finite strain
THICKNESS, WIDTH, HEIGHT = 4.0, 30.0, 50.0
EULER = 1.0 - math.sqrt(1.0 - THICKNESS**2 / 6.0 * (math.pi / HEIGHT) ** 2)


def pushed() -> Scene:
    """A strip of cork, its top edge pushed down; nominal strains count as positive."""
    thick = load_scene("stretch", {"sheet.thickness_mm": THICKNESS, "material.poisson": 0.0})
    scene = pulled_rectangle(thick, WIDTH, HEIGHT)
    top = scene.edges["top"].model_copy(update={"move_mm": (0.0, -0.1 * HEIGHT, 0.0)})
    return replace(scene, edges={**scene.edges, "top": top})


def test_nominal_strains_are_those_between_the_supports() -> None:
    assert nominal_strain(load_scene("stretch")) == pytest.approx(0.1)
    assert nominal_strain(load_scene("hole")) == pytest.approx(0.1)
    assert nominal_strain(load_scene("shear")) == pytest.approx(0.5 / 128.0)
    # the sheet moved as a whole is not strained
    moved = {f"edges.{edge}.move_mm": [0.0, 5.0, 0.0] for edge in ("top", "bottom")}
    assert nominal_strain(load_scene("hole", moved)) == 0.0


def test_ends_of_the_window_come_in_nominal_strain() -> None:
    bracket = (0.8 * EULER, 1.3 * EULER)
    found = window_of(pushed(), (9, 15), (bracket, bracket))
    assert found.appearance == pytest.approx(EULER, rel=1e-4)  # quintics on a fifth of a wave
    assert found.appearance_error < 1e-2 * EULER


def test_a_table_along_the_load_counts_what_is_unstable() -> None:
    table = along_the_load(pushed(), [0.5 * EULER, 1.2 * EULER], 15)
    assert table.strain.tolist() == [0.5 * EULER, 1.2 * EULER]
    assert table.unstable.tolist() == [0, 1]
    # stable exactly where the sheet is thicker than the neutral thickness
    assert (table.neutral_thickness_mm < THICKNESS).tolist() == [True, False]


def test_the_map_scales_with_the_width() -> None:
    """Same shape and strain, twice the width: twice the neutral thickness, for there is no other length."""
    scene = load_scene("stretch")
    tables = [
        over_aspect_ratios(scene, [2.5], [0.1], 120),
        along_the_load(pulled_rectangle(scene, 50.8, 127.0), [0.1], 120),
    ]
    large, small = (float(table.neutral_thickness_mm.iloc[0]) for table in tables)
    assert large > 0.0 and large == pytest.approx(2.0 * small, rel=1e-8)


def test_the_map_is_of_rectangles() -> None:
    with pytest.raises(ValueError, match="rectangles; the scene hole has another shape"):
        over_aspect_ratios(load_scene("hole"), [2.0], [0.1], 60)
