"""Finishing a relaxation: the same equilibrium in fewer steps, on every kind of mesh and model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fdsolver import finish, meshes, multilevel, taut
from fdsolver.cholesky import Pattern
from fdsolver.dissection import dissect
from fdsolver.edges import EdgeCondition
from fdsolver.finish import FINISHED, relax_or_finish, suits
from fdsolver.level import Level
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.reduced import ReducedLevel, level_on, mirrored_part
from fdsolver.relax import Settings, begin
from fdsolver.result import Solution, Status
from fdsolver.symmetry import Symmetry
from tensionfield.relaxed import TENSION_FIELD

FINE = Settings(tolerance=1e-10, levels=1)
THICK, THIN = (Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=h) for h in (1.0, 0.05))


def holed(nodes: int, pull: float, sheet: Sheet) -> Problem:
    """A holed sheet of 50 mm x 125 mm, pulled along y at both ends."""
    edges = {
        "bottom": EdgeCondition("pinned", move_mm=(0.0, -pull, 0.0)),
        "top": EdgeCondition("pinned", move_mm=(0.0, pull, 0.0)),
    }

    def grid_of(count: int):
        return meshes.rectangle_with_hole(50.0, 125.0, 15.0, count)

    return Problem(sheet, edges, grid_of(nodes), grid_of, perturbation=1e-6)


def ring(nodes: int, sheet: Sheet) -> Problem:
    """An annulus whose inner rim is lifted and turned."""
    edges = {
        "inner": EdgeCondition("pinned", move_mm=(0.0, 0.0, 60.0), rotate_deg=30.0),
        "outer": EdgeCondition("pinned"),
    }

    def grid_of(count: int):
        return meshes.annulus(62.5, 250.0, count)

    return Problem(sheet, edges, grid_of(nodes), grid_of, perturbation=1e-6)


def both(problem: Problem, model, settings: Settings) -> tuple[Solution, Solution]:
    """The run finished and the run relaxed to the end."""
    return tuple(solve(problem, model, replace(settings, finish=way)) for way in ("on", "off"))


def finished_rows(solution: Solution) -> int:
    return int((solution.history["restart"] == FINISHED).sum())


@pytest.mark.parametrize("problem", [holed(1000, 1.0, THICK), ring(800, THICK)], ids=["hole", "annulus"])
def test_plate_comes_to_the_state_that_relaxation_finds(problem: Problem) -> None:
    finished, relaxed = both(problem, KOITER, FINE)
    assert finished.status is relaxed.status is Status.CONVERGED
    assert finished.residual < FINE.tolerance
    # the residual over the softest stiffness: 1e-10 of a cell leaves 1e-8 of the bending of a soft mode
    assert finished.energy_N_mm["total"] == pytest.approx(relaxed.energy_N_mm["total"], rel=1e-10)
    np.testing.assert_allclose(finished.r, relaxed.r, rtol=0.0, atol=1e-5)
    assert 0 < finished_rows(finished) < 60
    assert finished.steps < relaxed.steps
    assert finished_rows(relaxed) == 0


def test_slack_sheet_comes_to_the_energy_and_reactions_that_relaxation_finds() -> None:
    """Slack zones have no unique shape, but the energy is convex: energy, stress and reactions are unique."""
    finished, relaxed = both(holed(2500, 6.25, THIN), TENSION_FIELD, replace(FINE, tolerance=1e-8))
    assert finished.status is relaxed.status is Status.CONVERGED
    assert (finished.zone.state == 0).any()
    assert finished.energy_N_mm["total"] == pytest.approx(relaxed.energy_N_mm["total"], rel=1e-9)
    np.testing.assert_allclose(finished.zone.stress_major, relaxed.zone.stress_major, rtol=0.0, atol=1e-2)
    force = {name: reaction.force_N for name, reaction in finished.reactions.items()}
    # residuals of 1e-8 on the nodes of an edge add up to less than a millionth of its force
    np.testing.assert_allclose(
        force["top"], relaxed.reactions["top"].force_N, rtol=0.0, atol=1e-6 * force["top"][1]
    )
    np.testing.assert_allclose(force["top"], -force["bottom"], rtol=0.0, atol=1e-6 * force["top"][1])
    assert finished_rows(finished) < 60 and finished.steps < 0.2 * relaxed.steps


@pytest.mark.parametrize("part", [None, "half-x", "half-y"])
def test_the_part_that_is_factorised_changes_nothing(
    part: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A quarter leads where the whole mesh and each half lead: to one energy, one stress and one pull."""
    problem, settings = holed(1500, 6.25, THIN), Settings(tolerance=1e-9, levels=1, finish="on")
    quarter = solve(problem, TENSION_FIELD, settings)

    def other(level: Level) -> Level:
        symmetry = None if part is None else Symmetry(part)
        return level_on(replace(level.problem, symmetry=symmetry), level.model, level.grid, 1)

    monkeypatch.setattr(finish, "mirrored_part", other)
    again = solve(problem, TENSION_FIELD, settings)
    assert quarter.status is again.status is Status.CONVERGED
    assert 0 < finished_rows(quarter) < 60 and 0 < finished_rows(again) < 60
    assert quarter.energy_N_mm["total"] == pytest.approx(again.energy_N_mm["total"], rel=1e-10)
    np.testing.assert_allclose(quarter.zone.stress_major, again.zone.stress_major, rtol=0.0, atol=1e-3)
    top = (solution.reactions["top"].force_N for solution in (quarter, again))
    np.testing.assert_allclose(*top, rtol=0.0, atol=1e-6)
    for solution in (quarter, again):
        assert solution.history["energy"][-1] == pytest.approx(solution.energy_N_mm["total"], rel=1e-12)


def test_a_step_of_a_part_is_that_of_the_whole_sheet() -> None:
    problem = holed(1500, 6.25, THIN)
    whole = Level(problem, replace(TENSION_FIELD, out_of_plane=False), problem.grid, 1)
    part = mirrored_part(whole)
    stepped = []
    for level in (whole, part):
        closed = level.force.closed
        path = taut._Path(level, level.start(), Pattern(dissect(~level.fixed, 1, closed), closed, 2))
        for _ in range(3):
            path.advance()
        stepped.append(level.unscaled(path.r))
    np.testing.assert_allclose(*stepped, rtol=0.0, atol=1e-9)
    assert np.abs(stepped[0] - whole.unscaled(whole.start())).max() > 0.1


def test_parts_are_those_that_mesh_and_loads_repeat() -> None:
    """A pull at one end is symmetric, for a sheet that moves; lifting that end leaves a half, a push sideways none."""
    hole = holed(1500, 6.25, THIN)
    moves = {
        "quarter": {"top": EdgeCondition("pinned", move_mm=(0.0, 3.0, 0.0))},
        "half-x": {"top": EdgeCondition("pinned", move_mm=(0.0, 3.0, 1.0))},
        None: {"top": EdgeCondition("pinned", move_mm=(1.0, 3.0, 0.0))},
    }
    for expected, edges in moves.items():
        problem = replace(hole, edges={"bottom": EdgeCondition("pinned"), **edges})
        part = mirrored_part(Level(problem, TENSION_FIELD, problem.grid, 1))
        found = part.problem.symmetry.reduce if isinstance(part, ReducedLevel) else None
        assert found == expected


def test_a_part_that_a_user_asked_for_is_finished_as_well() -> None:
    problem = replace(holed(1500, 6.25, THIN), symmetry=Symmetry("quarter"))
    solution = solve(problem, TENSION_FIELD, Settings(tolerance=1e-9, levels=1))
    whole = solve(replace(problem, symmetry=None), TENSION_FIELD, Settings(tolerance=1e-9, levels=1))
    assert solution.status is Status.CONVERGED and finished_rows(solution)
    assert solution.energy_N_mm["total"] == pytest.approx(whole.energy_N_mm["total"], rel=1e-10)


def test_relaxed_annulus_in_space_comes_to_the_same_state() -> None:
    finished, relaxed = both(ring(800, THIN), TENSION_FIELD, FINE)
    assert finished.status is relaxed.status is Status.CONVERGED and finished_rows(finished)
    np.testing.assert_allclose(finished.r, relaxed.r, rtol=0.0, atol=1e-5)


class Kept:
    """A store that keeps all checkpoints, and gives one of another run."""

    def __init__(self, start: dict | None = None) -> None:
        self.start, self.saved = start, []

    def save(self, state) -> None:
        self.saved.append({name: np.array(value) for name, value in state.items()})

    def load(self) -> dict | None:
        return self.start


def test_a_run_that_is_finished_goes_on_from_every_checkpoint_with_the_same_bits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An attempt to finish has more in hand than the state: killed, it begins anew, and not where it was."""
    monkeypatch.setattr(multilevel, "SAVE_SECONDS", -1.0)
    problem, settings = ring(800, THIN), replace(FINE, tolerance=1e-8, finish="on")
    store = Kept()
    whole = solve(problem, TENSION_FIELD, settings, checkpoint=store)
    assert finished_rows(whole) > 5 and len(store.saved) > 5
    for start in store.saved[-3:]:
        again = solve(problem, TENSION_FIELD, settings, checkpoint=Kept(start))
        np.testing.assert_array_equal(again.r, whole.r)
        for name, values in whole.history.items():
            np.testing.assert_array_equal(again.history[name], values, err_msg=name)


def test_indefinite_state_goes_back_to_relaxation() -> None:
    """A sheet pressed flat has no Cholesky factor: the attempt leaves the state alone and relaxation goes on."""
    grid = meshes.rectangle(20.0, 12.0, 400)
    edges = {
        name: EdgeCondition("pinned", move_mm=(x, 0.0, 0.0)) for name, x in (("left", 0.2), ("right", -0.2))
    }
    level = Level(Problem(THIN, edges, grid, lambda n: grid, perturbation=0.0), KOITER, grid, 1)
    state = begin(level.start())
    before = state.r.copy()
    assert finish.finish(level, level, state, replace(FINE, finish="on")) is None
    np.testing.assert_array_equal(state.r, before)
    assert state.step == 0
    settings = replace(FINE, finish="on", tolerance=1e-30, max_steps=900)
    assert relax_or_finish(level, state, settings) is Status.STEP_LIMIT
    assert state.step == 900 and state.finish_at == 1800  # attempts at 200 and 600


def test_interrupted_finish_leaves_the_state_as_it_was() -> None:
    problem = holed(700, 6.25, THIN)
    level = Level(problem, TENSION_FIELD, problem.grid, 1)
    state = begin(level.start())
    before = {name: np.copy(value) for name, value in state.as_arrays().items()}

    def interrupt(_: object) -> None:
        if state.step >= 3:
            raise KeyboardInterrupt

    assert finish.finish(level, mirrored_part(level), state, FINE, interrupt) is Status.INTERRUPTED
    for name, value in state.as_arrays().items():
        if name != "seconds":
            np.testing.assert_array_equal(value, before[name], err_msg=name)


def test_same_bits_for_one_and_two_threads() -> None:
    problem = holed(1000, 1.0, THICK)
    one, two = (solve(problem, KOITER, replace(FINE, finish="on", threads=n)) for n in (1, 2))
    assert finished_rows(one)
    np.testing.assert_array_equal(one.r, two.r)


def test_who_is_finished() -> None:
    grid = meshes.rectangle(20.0, 12.0, 400)
    for model, settings, expected in (
        (TENSION_FIELD, Settings(), True),
        (TENSION_FIELD, Settings(finish="off"), False),
        (TENSION_FIELD, Settings(damping="kinetic-published"), False),
        (KOITER, Settings(), False),
        (KOITER, Settings(finish="on"), True),
        (MEMBRANE, Settings(finish="on"), False),
    ):
        level = Level(Problem(THIN, {}, grid, lambda n: grid), model, grid, 1)
        assert suits(level, settings) is expected


def test_steps_left_are_those_of_a_residual_that_goes_on_falling() -> None:
    """1e-2 at the start, a decade every 100 steps: from 1e-5 at step 300 another 300 lead to 1e-8."""
    state = begin(np.zeros((2, 3, 3)))
    state.history = [(float(n), 0.0, 0.0, 10.0 ** (-2.0 - n / 100.0), 0.0) for n in range(0, 301, 10)]
    # the last look at or before the middle is at step 150
    assert finish.steps_left(state, 1e-8) == pytest.approx(300.0, rel=1e-9)
    state.history = [(float(n), 0.0, 0.0, 1e-4, 0.0) for n in range(0, 301, 10)]
    assert finish.steps_left(state, 1e-8) == np.inf


def test_only_sheets_that_come_to_rest_slowly_are_finished_unasked() -> None:
    settings = Settings(tolerance=1e-8)
    annulus, hole = (
        solve(problem, TENSION_FIELD, settings) for problem in (ring(800, THIN), holed(4000, 6.25, THIN))
    )
    assert annulus.status is hole.status is Status.CONVERGED
    assert finished_rows(annulus) == 0 < finished_rows(hole)
