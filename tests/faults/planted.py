"""NaN and infinity planted in every array of the engine at random steps."""

from __future__ import annotations

import random
from dataclasses import dataclass

import numpy as np

from fdsolver.model import KOITER
from fdsolver.relax import BLOCK, State, begin
from fdsolver.result import Status
from tests.relaxing import FINE, Failing, relaxed, solved, strip

WITHIN = (
    2 * BLOCK
)  # steps until it must be noticed, and named if it cannot be replaced: a block has two looks
IN_STATE = ("r", "v", "mass", "inverse_mass", "safe")
IN_FORCE = ("zone", "node", "twist")  # constants of the mesh
ARRAYS = (*IN_STATE, *IN_FORCE, "forces", "weight")
VALUES = (np.nan, np.inf, -np.inf)
LATEST = 200  # steps; the strip needs some 300


@dataclass(frozen=True)
class Planting:
    """Where, what and at which step something was planted, and what came of it; `fault` is "" if all was right.

    noticed : steps until the state was taken back or the run ended, None if nobody ever met it.
    """

    where: str
    value: float
    step: int
    noticed: int | None
    status: Status
    fault: str


def planting(where: str, draw: random.Random) -> Planting:
    """Plant one value at a random step and place of an array, and let the run end."""
    _, sound = solved(KOITER)
    level = strip(KOITER)
    value, step = draw.choice(VALUES), draw.randrange(BLOCK, LATEST, BLOCK)
    state, noticed = begin(level.start()), []
    constants = {**vars(level.force), "weight": level.weight}

    def on_block(now: State) -> None:
        if now.step == step and where != "forces":
            _put(getattr(now, where) if where in IN_STATE else constants[where], value, draw)
        if now.step > step and now.recoveries and not noticed:
            noticed.append(now.step - step)

    # one evaluation at the first look, one a step from then on
    force = (
        Failing(level.force, step + 1, lambda f: _put(f, value, random.Random(0)))
        if where == "forces"
        else None
    )
    status = relaxed(level, state, FINE, on_block, force=force)
    if status is not Status.CONVERGED and not noticed:
        noticed.append(state.step - step)
    when = noticed[0] if noticed else None
    return Planting(where, value, step, when, status, _fault(step, when, status, state, sound))


def _fault(step: int, noticed: int | None, status: Status, state: State, sound: State) -> str:
    """What is wrong with the end of a run in which something was planted at a step."""
    if status not in (Status.CONVERGED, Status.NOT_FINITE):
        return f"it ended as {status.value}"
    if not np.isfinite(state.r).all():
        return "the state that is left is not finite"
    if (
        status is Status.CONVERGED and np.abs(state.r - sound.r).max() > 1e-8
    ):  # of the length; the tolerance is 1e-10
        return "it converged to another state"
    if noticed is None and not np.array_equal(state.r, sound.r):
        return "it was never noticed and changed the result"
    if noticed is not None and noticed > WITHIN:
        return f"it was noticed after {noticed} steps"
    if status is Status.NOT_FINITE and state.step - step > WITHIN:
        return f"it was named after {state.step - step} steps"
    return ""


def _put(field: np.ndarray, value: float, draw: random.Random) -> None:
    field[tuple(draw.randrange(size) for size in field.shape)] = value
