"""Nested meshes: relax on a coarse mesh, carry the displacement to the next finer one, relax again."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numba
import numpy as np

from fdsolver.finish import FINISHED
from fdsolver.grid import Grid
from fdsolver.level import Level
from fdsolver.model import Model
from fdsolver.problem import Problem
from fdsolver.reduced import level_on, unfolded
from fdsolver.relax import Progress, Settings, State, begin
from fdsolver.result import Solution, Status
from fdsolver.snapshots import Recorder, final_shape
from fdsolver.solution import assemble
from fdsolver.stability import relax_to_stable
from fdsolver.trail import Trail, with_trail
from fdsolver.warm import compile_kernels

COARSEST = 1000  # nodes: below this a coarser level saves nothing
RATIO = 4  # nodes of a level over those of the next coarser one
SAVE_SECONDS = 5.0  # between two checkpoints
RESUMABLE = (Status.INTERRUPTED, Status.TIME_LIMIT, Status.STEP_LIMIT)
LAST_STATUS = (*RESUMABLE, Status.NOT_FINITE)  # no finer mesh after these


class Store(Protocol):
    """Where checkpoints go (`fdsolver.checkpoint.Checkpoint`)."""

    def save(self, state: Mapping[str, Any]) -> None:
        """Replace the stored state."""

    def load(self) -> Mapping[str, Any] | None:
        """The stored state, or None."""


@dataclass
class Run:
    """Where a nested run stands; with `state` it is all that a checkpoint holds.

    level : index of the present mesh, coarsest first. done : summaries of the finished levels. history : rows
    (level, step, energy, kinetic, residual, restart) of the finished levels, energies in N mm. limit_steps,
    limit_seconds : what the run had used when it last ended at a limit; a resumed run gets as much again.
    trail : states on the way, for the error estimate.
    """

    state: State
    level: int = 0
    done: list[dict[str, float]] = field(default_factory=list)
    history: list[tuple[float, ...]] = field(default_factory=list)
    seconds: float = 0.0
    cpu_seconds: float = 0.0
    limit_steps: int = 0
    limit_seconds: float = 0.0
    trail: Trail = field(default_factory=Trail)

    def as_arrays(self) -> dict[str, Any]:
        """The run as named arrays and strings."""
        state = {f"state_{name}": value for name, value in self.state.as_arrays().items()}
        history = np.asarray(self.history, dtype=float).reshape(-1, 6)
        own = {"level": self.level, "done": json.dumps(self.done), "history": history}
        used = {"seconds": self.seconds, "cpu_seconds": self.cpu_seconds}
        limits = {"limit_steps": self.limit_steps, "limit_seconds": self.limit_seconds}
        return {**state, **own, **used, **limits, **self.trail.as_arrays()}

    @classmethod
    def from_arrays(cls, saved: Mapping[str, Any]) -> Run:
        """The run that `as_arrays` gave."""
        state = {
            name.removeprefix("state_"): value for name, value in saved.items() if name.startswith("state_")
        }
        return cls(
            state=State.from_arrays(state),
            level=int(saved["level"]),
            done=json.loads(str(saved["done"])),
            history=[tuple(row) for row in np.asarray(saved["history"]).tolist()],
            seconds=float(saved["seconds"]),
            cpu_seconds=float(saved["cpu_seconds"]),
            limit_steps=int(saved["limit_steps"]),
            limit_seconds=float(saved["limit_seconds"]),
            trail=Trail.from_arrays(saved),
        )

    @property
    def steps(self) -> int:
        """Steps on all levels so far."""
        return self.state.step + int(sum(row["steps"] for row in self.done))

    def limits(self, settings: Settings) -> Settings:
        """The settings with limits that count from the beginning of the present level."""
        steps = settings.max_steps + self.limit_steps - self.steps + self.state.step
        seconds = settings.max_seconds + self.limit_seconds - self.seconds + self.state.seconds
        return replace(settings, max_steps=steps, max_seconds=seconds)

    def finish_level(self, level: Level) -> None:
        """Move the state's history and summary over to the finished levels."""
        state = self.state
        unit = level.energy_unit
        self.history += [(self.level, step, e * unit, k * unit, *rest) for step, e, k, *rest in state.history]
        self.done.append(
            {
                "nodes": level.grid.nodes,
                "thickness_mm": level.problem.sheet.thickness_mm,
                "steps": state.step,
                "force_evaluations": state.evaluations,
                "residual": state.residual,
                "energy": state.history[-1][1] * level.energy_unit,
                "seconds": state.seconds,
            }
        )


def level_nodes(nodes: int, levels: int | None) -> list[int]:
    """Node counts of the nested meshes, coarsest first; `levels` None chooses."""
    counts = [nodes]
    while len(counts) < levels if levels else counts[-1] >= RATIO * COARSEST:
        if counts[-1] // RATIO < 400:
            break
        counts.append(counts[-1] // RATIO)
    return counts[::-1]


def solve(
    problem: Problem,
    model: Model,
    settings: Settings = Settings(),
    progress: Callable[[Progress], None] | None = None,
    checkpoint: Store | None = None,
) -> Solution:
    """Relax a problem through nested meshes, from the interpolated start or from a checkpoint.

    The result is bit-equal whether or not the run was stopped and resumed in between. A run that ended at a limit
    leaves its checkpoint and goes on from there. Raises ValueError for settings that cannot be and for
    `finish` "on" with a symmetry (the exact tangent is made for whole meshes), GridError for meshes, CheckpointError
    for a checkpoint of another run.
    """
    if problem.symmetry is not None and settings.finish == "on":
        raise ValueError("finish 'on' with a symmetry: the finisher solves whole meshes only")
    numba.set_num_threads(settings.threads)
    seconds_compile = compile_kernels(problem, model, settings.threads)
    # A given state would lose its wrinkles on a coarse mesh.
    levels = 1 if settings.levels is None and problem.initial is not None else settings.levels
    counts = level_nodes(problem.grid.nodes, levels)
    coarse = [problem.grid_of(nodes) for nodes in counts[:-1]]
    stages = _stages(coarse, problem.grid, settings, model.bending)
    clock = _Clock()
    saved = checkpoint.load() if checkpoint is not None else None
    run = Run.from_arrays(saved) if saved is not None else None
    at = run.level if run is not None else 0
    level = _level(problem, model, *stages[at], settings.threads)
    recorder = Recorder(settings.snapshots, settings.damping.startswith("kinetic"))
    if run is None or saved is None:
        run = Run(begin(level.start()))
        recorder.look(0, 0, level, run.state)
    else:
        recorder.restore(saved)
    while True:
        clock.charge(run)
        watch = _watcher(run, level, len(stages), settings, clock, progress, checkpoint, recorder)
        finest = run.level + 1 == len(stages)
        status, stability = relax_to_stable(level, run.state, run.limits(settings), watch, finest)
        clock.charge(run)
        last = finest or status in LAST_STATUS
        if last and checkpoint is not None and status in RESUMABLE:
            if status is not Status.INTERRUPTED:
                run.limit_steps, run.limit_seconds = run.steps, run.seconds
            checkpoint.save({**run.as_arrays(), **recorder.as_arrays()})
        before = run.steps - run.state.step
        run.finish_level(level)
        if last:
            break
        run.trail.finish_mesh(level, run.state)
        run.level += 1
        before_it, level = level, _level(problem, model, *stages[run.level], settings.threads)
        run.state = begin(level.start_from(before_it, run.state.r))
    shown, run.state = unfolded(level, run.state)
    solution = assemble(model, settings, shown, status, stability, run, seconds_compile)
    whole = replace(problem, symmetry=None)
    coarser = [_level(whole, model, *stage, settings.threads) for stage in stages[: run.level]]
    solution = with_trail(solution, run.trail, [*coarser, shown])
    if not settings.snapshots:
        return solution
    end = final_shape(run.level, before, shown, run.state)
    return replace(solution, snapshots=recorder.arrays([grid for grid, _ in stages], end))


def _stages(
    coarse: Sequence[Grid], finest: Grid, settings: Settings, bending: bool
) -> list[tuple[Grid, float]]:
    """The meshes of a run in their order, each with its sheet's thickness over the problem's own."""
    thicknesses = (*settings.thinning, 1.0) if bending else (1.0,)
    thicken = settings.thicken and bending
    nested = [(grid, thicknesses[0] * (finest.nodes / grid.nodes if thicken else 1.0)) for grid in coarse]
    return nested + [(finest, thickness) for thickness in thicknesses]


def _level(problem: Problem, model: Model, grid: Grid, thickness: float, threads: int) -> Level:
    """The problem on one of the meshes with its sheet's thickness times a factor."""
    sheet = replace(problem.sheet, thickness_mm=thickness * problem.sheet.thickness_mm)
    return level_on(replace(problem, sheet=sheet), model, grid, threads)


class _Clock:
    """Wall and CPU seconds, charged to a run piece by piece so that a resumed run goes on counting."""

    def __init__(self) -> None:
        self.wall, self.cpu = time.perf_counter(), time.process_time()

    def charge(self, run: Run) -> None:
        wall, cpu = time.perf_counter(), time.process_time()
        run.seconds += wall - self.wall
        run.cpu_seconds += cpu - self.cpu
        self.wall, self.cpu = wall, cpu


def _watcher(
    run: Run,
    level: Level,
    levels: int,
    settings: Settings,
    clock: _Clock,
    progress: Callable[[Progress], None] | None,
    checkpoint: Store | None,
    recorder: Recorder,
) -> Callable[[State], None]:
    """What happens between blocks: the progress display, snapshots, and a checkpoint every few seconds."""
    saved = time.monotonic()
    before = run.steps - run.state.step

    def watch(state: State) -> None:
        nonlocal saved
        clock.charge(run)
        run.trail.look(level, state)
        recorder.look(run.level, before, level, state)
        if progress is not None:
            rate = state.step / state.seconds if state.seconds > 0.0 else 0.0
            place = (run.level + 1, levels, level.grid.nodes, state.step)
            progress(Progress(*place, state.residual, state.wanted, rate, run.seconds))
        # an attempt to finish begins anew when it is resumed, so a state on its way is none to go on from
        finishing = state.history[-1][-1] == FINISHED
        if checkpoint is not None and not finishing and time.monotonic() - saved > SAVE_SECONDS:
            checkpoint.save({**run.as_arrays(), **recorder.as_arrays()})
            saved = time.monotonic()

    return watch
