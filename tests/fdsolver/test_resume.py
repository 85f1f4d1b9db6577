"""A relaxation goes on bit by bit: from any block, after an interrupt, after a kick."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver import damping, relax
from fdsolver import mass as masses
from fdsolver.model import KOITER
from fdsolver.relax import BLOCK, Settings, State, begin
from fdsolver.result import Status
from tests.relaxing import FINE, Failing, relaxed, solved, strip


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
