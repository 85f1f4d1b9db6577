"""Families of wrinkled states, from made solutions of known phase, and shifted starts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from cases import run
from cases.families import Orbit, families, orbit, shifted_phase
from cases.scene import load_scene
from cases.schema import Line
from cases.starts import relax_from
from fdsolver import meshes
from fdsolver.result import Solution, Status
from tests.cases.made import made_solution

GRID = meshes.rectangle(100.0, 60.0, 6000, bias=1.0)
LINE = Line(from_mm=(-50.0, 0.0), to_mm=(50.0, 0.0))
WAVE, BELL = 12.0, 15.0


def state(phase: float, energy: float = 3.0, height: float = 0.4, seed: int = 0) -> Solution:
    """Wrinkles along y under a bell, of this phase about the middle."""

    def wrinkles(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        bell = height * np.exp(-((x / BELL) ** 2)) * np.cos(np.pi * y / 60.0)
        return bell * np.cos(2.0 * np.pi * x / WAVE + np.radians(phase))

    made = made_solution(GRID, wrinkles)
    return replace(made, seed=seed, energy_N_mm={**made.energy_N_mm, "total": energy})


def test_the_table_of_states_that_differ_by_their_phase() -> None:
    phases = [0.0, 30.0, -45.0, 90.0]
    table = families([state(phase, seed=number) for number, phase in enumerate(phases)], LINE)
    assert list(table["seed"]) == [0, 1, 2, 3]
    np.testing.assert_allclose(table["phase_deg"], phases, atol=0.1)
    # of A cos(k x + phi) with an even A, z and its mirror image correlate by cos(2 phi)
    np.testing.assert_allclose(table["symmetry"], np.cos(2.0 * np.radians(phases)), atol=2e-3)
    # the mesh has about 8 zones a wave, cubic between its nodes
    np.testing.assert_allclose(table["correlation"], 1.0, atol=1e-4)
    assert table["envelope_difference"].max() < 5e-3
    np.testing.assert_allclose(table["mean_wavelength_mm"], WAVE, rtol=5e-3)
    assert set(table["status"]) == {"converged"} and set(table["stable"]) == {True}


@pytest.mark.parametrize(
    ("phases", "gap"), [([0.0, 90.0, 0.0, 90.0], 90.0), ([0.0, 45.0, 90.0, -45.0], 45.0)]
)
def test_the_gap_between_phases_tells_families_from_an_orbit(phases: list[float], gap: float) -> None:
    found = orbit(families([state(phase) for phase in phases], LINE))
    assert found.largest_gap_deg == pytest.approx(gap, abs=0.2)
    assert found.energy == 0.0
    assert found.correlation > 0.999


def test_states_of_one_phase_leave_the_whole_turn_open() -> None:
    assert orbit(families([state(20.0), state(20.0)], LINE)).largest_gap_deg == pytest.approx(180.0, abs=1e-6)


def test_what_differs_is_told() -> None:
    found = orbit(families([state(0.0, energy=3.0), state(40.0, energy=3.3, height=0.5)], LINE))
    assert found.energy == pytest.approx(0.3 / 3.15)
    assert found.rms == pytest.approx(0.1 / 0.45, rel=1e-2)
    assert found.wavelength < 5e-3


def test_flat_states_have_no_phase_and_make_no_orbit() -> None:
    table = families([state(0.0), made_solution(GRID)], LINE)
    assert np.isnan(table["phase_deg"][1]) and table["rms_mm"][1] == 0.0
    with pytest.raises(ValueError, match="at least two wrinkled states"):
        orbit(table)
    assert isinstance(orbit(pd.concat([table, families([state(9.0)], LINE)])), Orbit)


@pytest.mark.parametrize("degrees", [-70.0, 25.0, 90.0, 180.0])
def test_a_shifted_state_is_the_state_of_that_phase(degrees: float) -> None:
    r = shifted_phase(state(10.0), degrees)
    expected = state(10.0 + degrees).r
    # the bell is 1e-5 where the sheet ends
    np.testing.assert_allclose(r[..., 2], expected[..., 2], rtol=0.0, atol=0.4 * 2e-3)
    np.testing.assert_array_equal(r[..., :2], expected[..., :2])


def test_only_rows_of_a_rectangle_are_shifted() -> None:
    ring = made_solution(meshes.annulus(10.0, 20.0, 900))
    with pytest.raises(ValueError, match="not of the shape annulus"):
        shifted_phase(ring, 90.0)


def test_a_wrinkled_strip_keeps_a_shifted_phase_at_the_same_energy() -> None:
    """The strip of the paper on 9 nodes a wave: the state that it finds, and the in-between one of the shifted start.

    On 6 nodes a wave the mesh holds the wrinkles where they suit it, and an in-between state runs away.
    """
    scene = load_scene("stretch", {"mesh.nodes": 7500, "solver.tolerance": 1e-7})
    line = scene.sections["midsection"]
    first = run(scene, method="koiter")
    second = relax_from(scene, first.grid, shifted_phase(first, 45.0))
    assert first.status is second.status is Status.CONVERGED
    table = families([first, second], line)
    moved = np.mod(table["phase_deg"][1] - table["phase_deg"][0] + 90.0, 180.0) - 90.0
    # it is to stay where it was put, not to run back to 0 or on to 90
    assert abs(abs(moved) - 45.0) < 2.0
    found = orbit(table)
    # energies at a residual of 1e-7 are known to about 1e-9; wrinkling itself gains 1e-5
    assert found.energy < 2e-9
    assert found.correlation > 0.99
