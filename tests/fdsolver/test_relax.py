"""The relaxation loop: every rule finds the same state, faults are taken back or named, runs go on bit by bit."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from fdsolver import damping, relax
from fdsolver import mass as masses
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.relax import BLOCK, GROWTH, RECOVERIES, Settings, State, begin
from fdsolver.result import Status
from tensionfield.relaxed import TENSION_FIELD
from tests.relaxing import FINE, SHEET, Failing, relaxed, solved, strip


@pytest.mark.parametrize("mass", ["nodal", "isotropic", "uniform"])
@pytest.mark.parametrize("rule", damping.RULES)
def test_every_rule_and_mass_finds_the_same_state(rule: str, mass: str) -> None:
    level, expected = solved(KOITER)
    state = begin(level.start())
    settings = dataclasses.replace(FINE, damping=rule, mass=mass)
    assert relaxed(level, state, settings) is Status.CONVERGED
    assert state.residual < FINE.tolerance
    assert state.recoveries == 0
    # residual over the softest stiffness: 1e-10 cells strain, over (pi / cells)^2 with 20 cells across
    np.testing.assert_allclose(state.r, expected.r, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("model", [MEMBRANE, TENSION_FIELD], ids=lambda model: model.name)
def test_membranes_converge_by_every_rule(model: Model) -> None:
    level, expected = solved(model)
    for rule in damping.RULES:
        state = begin(level.start())
        assert relaxed(level, state, dataclasses.replace(FINE, damping=rule)) is Status.CONVERGED
        np.testing.assert_allclose(state.r[:2], expected.r[:2], rtol=0.0, atol=1e-7)  # no bending: softer


def test_residual_is_the_force_over_what_a_strain_of_one_gives_a_cell() -> None:
    level = strip(KOITER)
    r = level.start()
    f = np.zeros_like(r)
    level.force(r, f)
    newton = np.moveaxis(f, 0, -1) * level.force_unit
    cell = np.sqrt(level.grid.node_area)[..., None]
    shares = np.abs(newton) / (SHEET.young_MPa * SHEET.thickness_mm * cell)
    assert relax.residual(f, level.weight) == pytest.approx(shares[~level.fixed].max(), rel=1e-12)
    assert shares[level.fixed].max() > shares[~level.fixed].max()  # what holds the edges does not count
    f[2, 3, 4] = np.nan
    assert np.isnan(relax.residual(f, level.weight))
    f[2, 3, 4] = np.inf
    assert np.isnan(relax.residual(f, level.weight))


def test_energy_never_grows_beyond_what_the_motion_gives_it() -> None:
    _, state = solved(KOITER)
    _, energy, kinetic, _, _ = np.array(state.history).T
    assert np.all(energy[1:] <= GROWTH * (energy + kinetic)[:-1])
    assert kinetic.max() > 1e-3 * energy[-1]  # there was motion


def test_fixed_nodes_do_not_move() -> None:
    level, state = solved(KOITER)
    np.testing.assert_array_equal(state.r[:, level.fixed], level.start()[:, level.fixed])


# Faults


def plant(where: str, value: float, step: int) -> Callable[[State], None]:
    """Write a value into one entry of an array of the state when the run comes to a step."""

    def on_block(state: State) -> None:
        if state.step == step:
            getattr(state, where)[2, 5, 6] = value

    return on_block


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("where", ["r", "v", "mass", "inverse_mass"])
@pytest.mark.parametrize("step", [50, 100])  # before a block without and with new masses
def test_what_is_not_finite_is_taken_back(where: str, value: float, step: int) -> None:
    level, expected = solved(KOITER)
    state = begin(level.start())
    status = relaxed(level, state, FINE, plant(where, value, step))
    assert status is Status.CONVERGED
    assert np.isfinite(state.mass_factor)
    np.testing.assert_allclose(state.r, expected.r, rtol=0.0, atol=1e-8)
    renewed = where in ("mass", "inverse_mass") and step % (BLOCK * relax.MASS_EVERY) == 0
    if where == "inverse_mass" and renewed:
        assert state.recoveries == 0  # replaced before anyone saw it
    else:
        assert 1 <= state.recoveries < RECOVERIES


def test_a_jump_of_the_energy_is_taken_back() -> None:
    level, expected = solved(KOITER)
    state = begin(level.start())
    # half a cell out of plane: some 10 % more strain energy
    assert relaxed(level, state, FINE, plant("r", 0.03, 60)) is Status.CONVERGED
    assert state.recoveries == 1
    steps, energy = np.array(state.history)[:, :2].T
    assert energy[steps == 60] > GROWTH * energy[steps == 50]
    assert energy[steps == 70] < energy[steps == 50]
    np.testing.assert_allclose(state.r, expected.r, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("component", [0, 1, 2])
def test_a_start_that_is_not_finite_is_named_at_once(component: int) -> None:
    level = strip(KOITER)
    state = begin(level.start())
    state.r[component, 4, 4] = state.safe[component, 4, 4] = np.nan
    assert relaxed(level, state, FINE) is Status.NOT_FINITE
    assert state.step <= 2 * BLOCK


def test_a_force_that_stays_not_finite_is_named_within_two_blocks() -> None:
    level = strip(KOITER)
    state = begin(level.start())

    def break_down(f: np.ndarray) -> None:
        f[1, 3, 3] = np.nan

    assert relaxed(level, state, FINE, force=Failing(level.force, 105, break_down)) is Status.NOT_FINITE
    assert state.step <= 105 + 20
    assert np.isfinite(state.r).all()  # the last sound state is what is left


def test_masses_far_too_light_are_raised_until_the_run_is_stable(monkeypatch: pytest.MonkeyPatch) -> None:
    level, expected = solved(KOITER)
    monkeypatch.setattr(masses, "SAFETY", 0.2)
    state = begin(level.start())
    assert relaxed(level, state, FINE) is Status.CONVERGED
    assert 1 <= state.recoveries <= RECOVERIES
    # the bound is nearly reached on this mesh: about 1.4 / 0.2 = 7 times is missing at most
    assert state.mass_factor == pytest.approx(relax.HEAVIER**state.recoveries)
    assert 2.0 < state.mass_factor < 30.0
    np.testing.assert_allclose(state.r, expected.r, rtol=0.0, atol=1e-8)


def test_masses_that_no_factor_saves_end_as_diverged(monkeypatch: pytest.MonkeyPatch) -> None:
    level = strip(KOITER)
    monkeypatch.setattr(masses, "SAFETY", 1e-6)
    state = begin(level.start())
    assert relaxed(level, state, FINE) in (Status.DIVERGED, Status.NOT_FINITE)
    assert state.recoveries == RECOVERIES + 1


# Limits


def test_step_limit() -> None:
    level = strip(KOITER)
    state = begin(level.start())
    assert relaxed(level, state, Settings(tolerance=0.0, max_steps=70)) is Status.STEP_LIMIT
    assert state.step == 70
    assert len(state.history) == 70 / BLOCK + 1


def test_time_limit() -> None:
    level = strip(KOITER)
    state = begin(level.start())
    assert relaxed(level, state, Settings(tolerance=0.0, max_seconds=0.05)) is Status.TIME_LIMIT
    assert state.seconds > 0.05
    assert state.history[-2][0] < state.step  # it ended at the first look after that


def test_stalled(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the rounding floor no residual is below zero: heavier masses are tried twice, then the run ends."""
    monkeypatch.setattr(relax, "STALL_STEPS", 500)
    level = strip(KOITER)
    state = begin(level.start())
    assert relaxed(level, state, Settings(tolerance=0.0)) is Status.STALLED
    assert state.mass_factor == pytest.approx(relax.HEAVIER**2)
    assert state.residual < 1e-12
    assert state.step > 3 * 500
