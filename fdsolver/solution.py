"""From the final state of a run to the `Solution` that users see: units, reactions, checks, warnings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from fdsolver.fields import hourglass_share, reactions, zone_fields
from fdsolver.level import Level
from fdsolver.model import Model
from fdsolver.relax import Settings
from fdsolver.result import Solution, Status
from fdsolver.turns import turn_warnings
from fdsolver.verdict import judge

if TYPE_CHECKING:
    from fdsolver.multilevel import Run

HISTORY = ("level", "step", "energy", "kinetic", "residual", "restart")


def assemble(
    model: Model,
    settings: Settings,
    level: Level,
    status: Status,
    stability: Mapping[str, object],
    run: Run,
    seconds_compile: float,
) -> Solution:
    """The Solution of a finished (or stopped) run on its last mesh."""
    problem, grid = level.problem, level.grid
    sheet = problem.sheet
    f = np.zeros_like(run.state.r)
    membrane, bending, control = (level.force(run.state.r, f) * level.energy_unit).tolist()
    r = level.unscaled(run.state.r)
    fields = zone_fields(grid, sheet, r, model.relaxed, model.moderate)
    hourglass = hourglass_share(grid, r)
    status, folds = judge(status, grid, sheet.thickness_mm, r, fields, hourglass, model.relaxed)
    status, message = level.verdict(status, run.state.r)
    history = np.asarray(run.history, dtype=float).reshape(-1, len(HISTORY)).T.copy()
    return Solution(
        method=model.name,
        status=status,
        message=message,
        grid=grid,
        sheet=sheet,
        r=r,
        steps=int(sum(row["steps"] for row in run.done)),
        force_evaluations=int(sum(row["force_evaluations"] for row in run.done)),
        residual=run.state.residual,
        seconds=run.seconds,
        cpu_seconds=run.cpu_seconds,
        seconds_compile=seconds_compile,
        energy_N_mm={
            "total": membrane + bending + control,
            "membrane": membrane,
            "bending": bending,
            "hourglass": control,
        },
        reactions=reactions(grid, problem.edges, r, level.unscaled(f) * (level.force_unit / grid.length_mm)),
        zone=fields,
        history=dict(zip(HISTORY, history, strict=True)),
        hourglass=hourglass,
        stability=stability,
        warnings=(
            *_warnings(level, run, fields.stretch_major),
            *turn_warnings(problem.edges, grid, r),
            *_unstable(stability, model),
            *folds,
        ),
        levels=tuple(run.done),
        threads=settings.threads,
        seed=problem.seed,
    )


def _warnings(level: Level, run: Run, stretch_major: np.ndarray) -> list[str]:
    """What a user should know besides the status."""
    warnings = []
    limit, largest = level.problem.sheet.natural_width_limit, float(stretch_major.max())
    if largest > limit:
        share = float(np.mean(stretch_major > limit))
        warnings.append(
            f"The largest principal stretch, {largest:.4g}, is beyond sqrt(1 + 1/nu) = {limit:.4g}, where the"
            f" material has no natural width, in {100.0 * share:.2g} % of the zones; such zones are simply tense."
        )
    if run.state.recoveries:
        count = run.state.recoveries
        warnings.append(f"{count} unstable step{'s' * (count > 1)} taken back, with the masses raised.")
    return warnings


def _unstable(stability: Mapping[str, object], model: Model) -> list[str]:
    """A warning about an equilibrium that kicks did not turn into a stable one."""
    if stability["stable"] is not False or not model.buckles:
        return []
    return [
        f"The state is not shown stable: a direction of eigenvalue {stability['lowest']:.2g} remains, which kicks"
        " along it did not remove."
    ]
