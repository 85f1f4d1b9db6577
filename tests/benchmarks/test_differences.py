"""What counts as a difference between a run with effects left out and full ones."""

from __future__ import annotations

import pytest

from cases import load_scene
from tests.benchmarks.differences import differences

SCENE = load_scene("annulus")
THICKNESS = SCENE.sheet.thickness_mm
ACROSS = "reactions.inner.force_N.z"
LEAN = {"reactions.inner.moment_N_mm.z": 4.0, "energy_N_mm.total": 2.0}


def full(height, **more):
    return {**LEAN, "out_of_plane_mm.max_abs": height, ACROSS: 3e-5, **more}


def test_forces_across_a_flat_sheet_are_what_is_left_of_its_random_start():
    assert differences(LEAN, [full(1e-4 * THICKNESS)], SCENE)[ACROSS] == 0.0


def test_forces_across_a_sheet_that_is_lifted_count():
    assert differences(LEAN, [full(100.0 * THICKNESS)], SCENE)[ACROSS] == 1.0
    assert differences(full(100.0 * THICKNESS), [LEAN], SCENE)[ACROSS] == 1.0


def test_a_force_in_the_plane_of_a_flat_sheet_counts():
    sideways = {"reactions.inner.force_N.x": 3e-5}
    assert differences(LEAN, [full(0.0, **sideways)], SCENE)["reactions.inner.force_N.x"] == 1.0


def test_a_difference_lies_beyond_the_range_of_full_runs():
    runs = [{**LEAN, "energy_N_mm.total": energy} for energy in (2.5, 4.0)]
    assert differences(LEAN, runs, SCENE)["energy_N_mm.total"] == pytest.approx(0.5 / 4.0)
    assert differences({**LEAN, "energy_N_mm.total": 3.0}, runs, SCENE)["energy_N_mm.total"] == 0.0
