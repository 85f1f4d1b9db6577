"""Nested runs: same answer as without nesting, same bits when stopped and resumed, on threads, and by seed."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fdsolver import meshes, multilevel
from fdsolver.checkpoint import Checkpoint
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER, Model
from fdsolver.multilevel import level_nodes, solve
from fdsolver.problem import Problem
from fdsolver.relax import BLOCK, Progress, Settings
from fdsolver.result import Solution, Status
from tensionfield.relaxed import TENSION_FIELD

NODES = 2000


def ring(nodes: int) -> Grid:
    return meshes.annulus(62.5, 250.0, nodes)


def plate(nodes: int) -> Grid:
    return meshes.rectangle(20.0, 8.0, nodes)


def annulus(seed: int = 0) -> tuple[Problem, Model]:
    """The ring, lifted and twisted: tense, wrinkled, and large rotations."""
    sheet = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=0.025)
    edges = {
        "inner": EdgeCondition("pinned", move_mm=(0.0, 0.0, 60.0), rotate_deg=30.0),
        "outer": EdgeCondition("pinned"),
    }
    return Problem(sheet, edges, ring(NODES), ring, seed=seed), TENSION_FIELD


def arch(seed: int = 0) -> tuple[Problem, Model]:
    """A plate pressed to twice its Euler load: it is kicked out of the flat state on the way."""
    sheet = Sheet(young_MPa=3500.0, poisson=0.0, thickness_mm=1.0)
    shortening = 2.0 * 20.0 * (np.pi / 20.0) ** 2 / 12.0
    edges = {
        "left": EdgeCondition("pinned"),
        "right": EdgeCondition("pinned", move_mm=(-shortening, 0.0, 0.0)),
    }
    return Problem(sheet, edges, plate(NODES), plate, seed=seed), KOITER


CASES: dict[str, tuple[Callable[..., tuple[Problem, Model]], Settings]] = {
    "tension field": (annulus, Settings(tolerance=1e-7, levels=2)),
    "koiter": (arch, Settings(tolerance=1e-6, levels=2, snapshots=6)),
    "koiter, thick on the coarse mesh": (
        arch,
        Settings(tolerance=1e-6, levels=2, thicken=True, damping="kinetic", snapshots=6),
    ),
    "koiter, thinned": (arch, Settings(tolerance=1e-6, levels=2, thinning=(2.0, 1.5), snapshots=6)),
}


def solved(name: str, seed: int = 0, **words: Any) -> Solution:
    case, settings = CASES[name]
    store, watch = words.pop("checkpoint", None), words.pop("progress", None)
    return solve(*case(seed), dataclasses.replace(settings, **words), watch, store)


WHOLE: dict[str, Solution] = {}


def whole(name: str) -> Solution:
    """The uninterrupted run, made once."""
    if name not in WHOLE:
        WHOLE[name] = solved(name)
        assert WHOLE[name].status is Status.CONVERGED
    return WHOLE[name]


SAME = (
    *("status", "steps", "force_evaluations", "residual", "energy_N_mm"),
    *("stability", "warnings", "hourglass"),
)


def same_bits(one: Solution, other: Solution) -> None:
    """All of two solutions but the clock's part."""
    np.testing.assert_array_equal(one.r, other.r)
    for name, column in one.history.items():
        np.testing.assert_array_equal(column, other.history[name], err_msg=name)
    for name in SAME:
        assert getattr(one, name) == getattr(other, name), name
    for row, other_row in zip(one.levels, other.levels, strict=True):
        assert {**row, "seconds": 0.0} == {**other_row, "seconds": 0.0}
    for edge, reaction in one.reactions.items():
        np.testing.assert_array_equal(reaction.force_N, other.reactions[edge].force_N)
        np.testing.assert_array_equal(reaction.moment_N_mm, other.reactions[edge].moment_N_mm)
    assert set(one.snapshots) == set(other.snapshots)
    for name, array in one.snapshots.items():
        np.testing.assert_array_equal(array, other.snapshots[name], err_msg=name)


@pytest.mark.parametrize(
    ("nodes", "levels", "expected"),
    [
        (400, None, [400]),
        (3999, None, [3999]),
        (4000, None, [1000, 4000]),
        (40_000, None, [2500, 10_000, 40_000]),
        (120_000, None, [1875, 7500, 30_000, 120_000]),
        (40_000, 1, [40_000]),
        (40_000, 2, [10_000, 40_000]),
        (40_000, 9, [625, 2500, 10_000, 40_000]),  # none below 400 nodes
        (400, 3, [400]),
    ],
)
def test_level_nodes(nodes: int, levels: int | None, expected: list[int]) -> None:
    assert level_nodes(nodes, levels) == expected


@pytest.mark.parametrize("name", ["tension field", "koiter"])
def test_nesting_changes_the_way_but_not_the_answer(name: str) -> None:
    nested, single = (solved(name, tolerance=1e-10, levels=levels) for levels in (2, 1))
    assert [level["nodes"] for level in nested.levels][1:] == [single.grid.nodes]
    assert len(single.levels) == 1
    # an arch up or down
    sign = np.sign(np.sum(nested.r[..., 2] * single.r[..., 2])) if name == "koiter" else 1.0
    # residual over the softest stiffness, about (1 / cells)^2 with 40 cells across
    np.testing.assert_allclose(
        nested.r * [1.0, 1.0, sign], single.r, rtol=0.0, atol=1e-6 * nested.grid.length_mm
    )
    assert nested.energy_N_mm["total"] == pytest.approx(single.energy_N_mm["total"], rel=1e-10)


def test_nesting_saves_steps_on_the_fine_mesh() -> None:
    nested, single = (solved("tension field", levels=levels) for levels in (2, 1))
    assert nested.levels[-1]["steps"] < single.steps


def test_a_plate_is_thinned_on_its_finest_mesh() -> None:
    """Twice and one and a half times as thick first, on the way to the same arch."""
    thinned, straight = whole("koiter, thinned"), whole("koiter")
    nodes, thickness = ([row[key] for row in thinned.levels] for key in ("nodes", "thickness_mm"))
    assert nodes == [straight.levels[0]["nodes"], *3 * [straight.grid.nodes]]
    assert thickness == [2.0, 2.0, 1.5, 1.0] and thinned.sheet == straight.sheet
    assert thinned.energy_N_mm["total"] == pytest.approx(straight.energy_N_mm["total"], rel=1e-5)
    assert [state.sheet.thickness_mm for state in thinned.coarser] == thickness[:-1]
    assert set(thinned.snapshots["level"]) <= {0, 1, 2, 3}


@pytest.mark.parametrize("name", [name for name in CASES if name != "koiter, thinned"])
def test_solution_tells_its_levels_and_history(name: str) -> None:
    solution = whole(name)
    coarse, fine = solution.levels
    grid_of = CASES[name][0]()[0].grid_of
    assert coarse["nodes"] == grid_of(solution.grid.nodes // 4).nodes
    assert fine["nodes"] == solution.grid.nodes
    assert solution.steps == coarse["steps"] + fine["steps"]
    assert solution.residual == fine["residual"] < CASES[name][1].tolerance
    assert fine["energy"] == pytest.approx(solution.energy_N_mm["total"], rel=1e-12)
    level, step = solution.history["level"], solution.history["step"]
    assert set(level) == {0.0, 1.0}
    for number, row in enumerate(solution.levels):
        assert list(step[level == number]) == list(range(0, int(row["steps"]) + 1, BLOCK))
    assert solution.history["energy"][-1] == fine["energy"]
    assert solution.history["restart"].any() == (CASES[name][1].damping == "kinetic")
    thick = solution.sheet.thickness_mm * solution.grid.nodes / coarse["nodes"]
    assert fine["thickness_mm"] == solution.sheet.thickness_mm
    assert coarse["thickness_mm"] == pytest.approx(thick if "thick" in name else solution.sheet.thickness_mm)


class Stop:
    """A progress display in which something happens at chosen calls, counted over several runs."""

    def __init__(self, calls: list[int], what: type[BaseException]) -> None:
        self.calls, self.what, self.count, self.seen = calls, what, 0, []

    def __call__(self, progress: Progress) -> None:
        self.count += 1
        self.seen.append(progress)
        if self.count in self.calls:
            raise self.what


def blocks(solution: Solution) -> int:
    return solution.steps // BLOCK


@pytest.mark.parametrize("name", CASES)
def test_interrupted_anywhere_and_resumed_the_bits_are_the_same(name: str, tmp_path: Path) -> None:
    expected = whole(name)
    random = np.random.default_rng(7)
    calls = sorted(random.choice(np.arange(1, blocks(expected)), size=9, replace=False).tolist())
    coarse = int(expected.levels[0]["steps"]) // BLOCK
    stop = Stop(sorted({1, *calls, coarse, coarse + 2}), KeyboardInterrupt)
    store = Checkpoint(tmp_path / "checkpoint.npz", name)
    interrupts = 0
    while (solution := solved(name, progress=stop, checkpoint=store)).status is Status.INTERRUPTED:
        interrupts += 1
        assert np.isfinite(solution.r).all()
        assert store.path.exists()
    assert interrupts == len(stop.calls)
    assert {progress.level for progress in stop.seen} == set(range(1, len(expected.levels) + 1))
    same_bits(solution, expected)


@pytest.mark.parametrize("name", CASES)
def test_killed_anywhere_the_last_checkpoint_goes_on_with_the_same_bits(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is saved on the way out; what counts is the checkpoint that was written some blocks ago."""
    monkeypatch.setattr(multilevel, "SAVE_SECONDS", 0.0)
    expected = whole(name)
    coarse = int(expected.levels[0]["steps"]) // BLOCK
    for call in (2, coarse, coarse + 3, blocks(expected) - 1):
        store = Checkpoint(tmp_path / f"{call}.npz", name)
        with pytest.raises(SystemExit):
            solved(name, progress=Stop([call], SystemExit), checkpoint=store)
        assert store.path.exists()
        same_bits(solved(name, checkpoint=store), expected)


def test_interrupt_before_the_first_block_and_without_a_checkpoint() -> None:
    solution = solved("koiter", progress=Stop([1], KeyboardInterrupt))
    assert solution.status is Status.INTERRUPTED
    assert len(solution.levels) == 1
    assert solution.stability["stable"] is None


@pytest.mark.parametrize("name", CASES)
def test_step_limit_counts_over_all_levels_and_resume_grants_it_again(name: str, tmp_path: Path) -> None:
    expected = whole(name)
    limit = (expected.steps // 3 // BLOCK) * BLOCK
    store = Checkpoint(tmp_path / "checkpoint.npz", name)
    ends = []
    while (solution := solved(name, max_steps=limit, checkpoint=store)).status is Status.STEP_LIMIT:
        ends.append(solution.steps)
    assert ends == [limit, 2 * limit, 3 * limit][: len(ends)]
    assert len(ends) in (2, 3)
    same_bits(solution, expected)


def test_time_limit_ends_on_the_mesh_it_met_and_resume_goes_on_with_the_same_bits(tmp_path: Path) -> None:
    expected = whole("koiter")
    store = Checkpoint(tmp_path / "checkpoint.npz", "a run")
    first = solved("koiter", max_seconds=0.0, checkpoint=store)
    assert first.status is Status.TIME_LIMIT
    assert first.grid.nodes == expected.levels[0]["nodes"]
    assert len(first.levels) == 1
    same_bits(solved("koiter", checkpoint=store), expected)


@pytest.mark.parametrize("name", CASES)
def test_two_threads_make_the_bits_of_one(name: str) -> None:
    solution = solved(name, threads=2)
    assert solution.threads == 2
    same_bits(solution, whole(name))


def test_seeds_repeat_and_differ() -> None:
    """The random start decides the way to the arch, up or down, and the last bits of it."""
    same_bits(solved("koiter"), whole("koiter"))
    other = solved("koiter", seed=5)
    assert other.status is Status.CONVERGED
    assert (other.seed, whole("koiter").seed) == (5, 0)
    assert not np.array_equal(other.r, whole("koiter").r)
    # both are the same arch: the residual of 1e-6 leaves 1e-4 of the energy open
    assert other.energy_N_mm["total"] == pytest.approx(whole("koiter").energy_N_mm["total"], rel=1e-3)


def test_progress_tells_where_the_run_is() -> None:
    watch = Stop([], KeyboardInterrupt)
    solution = solved("tension field", progress=watch)
    assert len(watch.seen) == blocks(solution)
    assert {(p.level, p.levels, p.nodes) for p in watch.seen} == {
        (number + 1, 2, row["nodes"]) for number, row in enumerate(solution.levels)
    }
    assert [p.step for p in watch.seen if p.level == 2] == list(
        range(BLOCK, int(solution.levels[1]["steps"]) + 1, BLOCK)
    )
    seconds = [p.seconds for p in watch.seen]
    assert seconds == sorted(seconds)
    assert all(p.steps_per_second > 0.0 and p.tolerance == 1e-7 for p in watch.seen)


def test_clock_goes_on_over_a_resumed_run(tmp_path: Path) -> None:
    store = Checkpoint(tmp_path / "checkpoint.npz", "a run")
    first = solved("tension field", progress=Stop([30], KeyboardInterrupt), checkpoint=store)
    assert first.status is Status.INTERRUPTED
    assert first.seconds > 0.0
    assert solved("tension field", checkpoint=store).seconds > first.seconds
