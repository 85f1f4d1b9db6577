"""Turns beyond half a circle are named, shorter ones are not, and the turn of a state is read off its mesh lines."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver.edges import EdgeCondition
from fdsolver.meshes import annulus, rectangle
from fdsolver.start import smooth_start
from fdsolver.turns import found_turn, largest_turn, turn_warnings

RING = annulus(62.5, 250.0, 1000)


def turned(inner: float, outer: float = 0.0) -> dict[str, EdgeCondition]:
    return {
        "inner": EdgeCondition("pinned", rotate_deg=inner),
        "outer": EdgeCondition("pinned", rotate_deg=outer),
    }


@pytest.mark.parametrize("turn", [0.0, 90.0, 180.0, -180.0])
def test_half_a_turn_and_less_is_not_warned_of(turn: float) -> None:
    assert turn_warnings(turned(turn), RING, smooth_start(RING, turned(turn))) == []


@pytest.mark.parametrize(
    ("turn", "shorter"), [(180.5, "-179.5"), (270.0, "-90"), (-200.0, "160"), (360.0, "0")]
)
def test_more_than_half_a_turn_is_warned_of(turn: float, shorter: str) -> None:
    (sentence,) = turn_warnings(turned(turn), RING, smooth_start(RING, turned(turn)))
    assert f"turned by {turn:g} degrees" in sentence
    assert f"where a turn by {shorter} degrees puts them" in sentence
    assert sentence.endswith(f"The state found is that of a turn by {turn:g} degrees.")  # as it starts


@pytest.mark.parametrize("turn", [-90.0, 0.0, 150.0, 270.0])
def test_the_turn_of_a_state_is_that_of_the_edges_that_it_was_made_with(turn: float) -> None:
    assert found_turn(RING, smooth_start(RING, turned(turn, 30.0))) == pytest.approx(turn - 30.0, abs=1e-9)


def test_a_state_that_went_the_shorter_way_is_said_to_have_done_so() -> None:
    (sentence,) = turn_warnings(turned(270.0), RING, smooth_start(RING, turned(-90.0)))
    assert sentence.endswith("The state found is that of a turn by -90 degrees.")


def test_only_supported_edges_are_turned_against_each_other() -> None:
    free = {"inner": EdgeCondition("free", rotate_deg=300.0), "outer": EdgeCondition("pinned")}
    assert largest_turn(free) == largest_turn({}) == 0.0
    assert largest_turn(turned(100.0, -100.0)) == 200.0
    assert largest_turn(dict(reversed(turned(100.0, -100.0).items()))) == 200.0


def test_an_open_sheet_is_warned_of_without_its_turn() -> None:
    strip = rectangle(100.0, 50.0, 200)
    edges = {"left": EdgeCondition("pinned"), "right": EdgeCondition("pinned", rotate_deg=200.0)}
    (sentence,) = turn_warnings(edges, strip, np.zeros((strip.ni, strip.nj, 3)))
    assert sentence.endswith("tells the two apart.")
