"""The relaxation loop: every rule finds the same state, faults are taken back or named, runs go on bit by bit."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fdsolver import damping, meshes, relax
from fdsolver import mass as masses
from fdsolver.edges import EdgeCondition
from fdsolver.level import Level
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.problem import Problem
from fdsolver.relax import BLOCK, GROWTH, RECOVERIES, Settings, State, begin
from fdsolver.result import Status
from tensionfield.relaxed import TENSION_FIELD

# thick enough that a strip pulled by 10 % stays flat, so that there is one state to find
SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=1.0)
EDGES = {"left": EdgeCondition("pinned"), "right": EdgeCondition("pinned", move_mm=(2.0, 0.5, 0.0))}
FINE = Settings(tolerance=1e-10)


def strip(model: Model) -> Level:
    """A strip of 20 mm x 12 mm, its right edge pulled and sheared."""
    grid = meshes.rectangle(20.0, 12.0, 400)
    problem = Problem(SHEET, EDGES, grid, lambda nodes: grid, perturbation=1e-3, seed=2)
    return Level(problem, model, grid, threads=1)


def relaxed(
    level: Level,
    state: State,
    settings: Settings,
    on_block: Callable[[State], None] | None = None,
    force: Any = None,
) -> Status:
    return relax.relax(force or level.force, ~level.fixed, level.weight, state, settings, on_block)


def solved(model: Model) -> tuple[Level, State]:
    level = strip(model)
    state = begin(level.start())
    assert relaxed(level, state, FINE) is Status.CONVERGED
    return level, state


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


@dataclasses.dataclass
class Failing:
    """A force that does something else from its n-th call on."""

    inner: Any
    call: int
    fault: Callable[[np.ndarray], None]
    calls: int = 0

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        self.calls += 1
        energy = self.inner(r, f)
        if self.calls >= self.call:
            self.fault(f)
        return energy

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)


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


# Going on


def equal(one: State, other: State) -> None:
    """Every bit of two states but their seconds."""
    for name, value in one.as_arrays().items():
        if name != "seconds":
            np.testing.assert_array_equal(value, other.as_arrays()[name], err_msg=name)


@pytest.mark.parametrize("rule", damping.RULES)
def test_a_run_goes_on_from_any_block_with_the_same_bits(rule: str) -> None:
    level = strip(KOITER)
    settings = Settings(tolerance=1e-7, damping=rule)
    whole, saved = begin(level.start()), []

    def keep(state: State) -> None:
        saved.append({name: value.copy() for name, value in state.as_arrays().items()})

    assert relaxed(level, whole, settings, keep) is Status.CONVERGED
    # the first, the last, and both sides of a renewal of the masses
    for block in (0, 3, 9, 10, 11, len(saved) // 2, len(saved) - 1):
        state = State.from_arrays(saved[block])
        assert relaxed(level, state, settings) is Status.CONVERGED
        equal(state, whole)


def test_a_light_run_goes_on_with_the_same_bits_after_its_recoveries(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(masses, "SAFETY", 0.2)
    test_a_run_goes_on_from_any_block_with_the_same_bits("adaptive")


@pytest.mark.parametrize("safety", [masses.SAFETY, 0.2])
def test_an_interrupt_at_any_evaluation_leaves_a_state_that_goes_on_with_the_same_bits(
    safety: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Inside a block, inside a look, inside a recovery (the light run has some): each leaves a block's beginning."""
    monkeypatch.setattr(masses, "SAFETY", safety)
    level = strip(KOITER)
    settings = Settings(tolerance=1e-7)
    whole = begin(level.start())
    assert relaxed(level, whole, settings) is Status.CONVERGED

    def interrupt(f: np.ndarray) -> None:
        raise KeyboardInterrupt

    for first in (1, 2, 11, 12, 25, 101, 102, 111, 138):
        state = begin(level.start())
        interrupts = 0
        for call in (first, 17, 31, 1_000_000):
            status = relaxed(level, state, settings, force=Failing(level.force, call, interrupt))
            interrupts += status is Status.INTERRUPTED
        assert (interrupts, status) == (3, Status.CONVERGED)
        equal(state, whole)


def test_an_interrupt_between_blocks_is_caught_too() -> None:
    """Progress displays and checkpoints are where a Ctrl-C lands most often when the mesh is small."""
    level = strip(KOITER)
    settings = Settings(tolerance=1e-7)
    whole = begin(level.start())
    relaxed(level, whole, settings)
    state = begin(level.start())
    for step in (10, 20, 100, 110, 200):

        def interrupt(at: State, step: int = step) -> None:
            if at.step == step:
                raise KeyboardInterrupt

        assert relaxed(level, state, settings, interrupt) is Status.INTERRUPTED
        assert state.step == step - BLOCK
    assert relaxed(level, state, settings) is Status.CONVERGED
    equal(state, whole)


def test_a_kick_moves_the_sheet_from_rest_and_is_counted() -> None:
    level, state = solved(KOITER)
    state.v[:] = 1.0
    before = state.r.copy()
    displacement = np.zeros_like(state.r)
    displacement[2, 3:6, 3:6] = 1e-3
    relax.kick(state, displacement)
    np.testing.assert_array_equal(state.r, before + displacement)
    assert not state.v.any()
    assert (state.kicks, state.since_restart, state.best_residual) == (1, 0, np.inf)
    assert relaxed(level, state, FINE) is Status.CONVERGED
    np.testing.assert_allclose(state.r, before, rtol=0.0, atol=1e-8)
    steps = np.array(state.history)[:, 0]
    assert np.all(np.diff(steps) == BLOCK)  # the look before the kick is not told twice
