"""How a solve ends (`Status`) and what it returns (`Answer`; on a structured mesh `Solution`)."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fdsolver.grid import Grid
from fdsolver.material import Sheet


class Status(enum.Enum):
    """The end of a run. `value` is the word in files, `sentence` what a user reads, `exit_code` the command's."""

    CONVERGED = ("converged", "Converged: the residual is below the tolerance.", 0)
    STEP_LIMIT = ("step_limit", "Stopped at the step limit before the residual reached the tolerance.", 3)
    TIME_LIMIT = ("time_limit", "Stopped at the time limit before the residual reached the tolerance.", 3)
    STALLED = ("stalled", "Stalled: the residual no longer falls although it is above the tolerance.", 3)
    DIVERGED = ("diverged", "Diverged: the energy kept growing after every recovery.", 3)
    NOT_FINITE = ("not_finite", "Not finite: a position or a force became NaN or infinite.", 3)
    UNSTABLE_FLAT = ("unstable_flat", "The equilibrium found is flat and unstable; it is not the answer.", 4)
    HOURGLASS = ("hourglass", "The result is mostly a checkerboard of the mesh, not a deformation.", 4)
    ZONE_INVERTED = ("zone_inverted", "A zone of the mesh has turned inside out.", 4)
    OUTSIDE_VALIDITY = ("outside_validity", "The state lies where the energy has no meaning.", 4)
    UNDER_RESOLVED = ("under_resolved", "The wrinkles have fewer than 6 nodes each.", 4)
    NOT_JUSTIFIED = ("not_justified", "An effect that was left out would have changed the result.", 4)
    INTERRUPTED = ("interrupted", "Interrupted; the run can be resumed.", 130)

    sentence: str
    exit_code: int

    def __new__(cls, value: str, sentence: str, exit_code: int) -> Status:
        """A member with its word, its sentence and its exit code."""
        member = object.__new__(cls)
        member._value_ = value
        member.sentence = sentence
        member.exit_code = exit_code
        return member


@dataclass(frozen=True)
class Reaction:
    """What a supported edge exerts on the sheet, about the origin.

    force_N : (3,) float64, N.
    moment_N_mm : (3,) float64, N mm.
    """

    force_N: np.ndarray
    moment_N_mm: np.ndarray


@dataclass(frozen=True)
class ZoneFields:
    """Membrane state of every zone, arrays of shape (zone rows, nj - 1).

    stretch_major, stretch_minor : principal stretches l_1 >= l_2, dimensionless.
    stress_major, stress_minor : principal 2nd Piola stresses, MPa.
    state : int8, 0 slack, 1 wrinkled, 2 tense (Pipkin 1986), whatever the method.
    """

    stretch_major: np.ndarray
    stretch_minor: np.ndarray
    stress_major: np.ndarray
    stress_minor: np.ndarray
    state: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What every method returns, whatever its mesh, with all that is needed to judge and to store it.

    r : (..., 3) float64, mm. Deformed positions of the mesh's nodes.
    residual : largest |dE/dr| over free nodes and components / (Y h L_n), L_n = square root of the nodal area.
    seconds, cpu_seconds : the solve without compilation; seconds_compile : compilation.
    energy_N_mm : {"total", "membrane", "bending"}, N mm.
    reactions : edge name -> Reaction, for supported edges.
    history : equal-length arrays, one value for each step that was noted.
    levels : per nested mesh: nodes, seconds, and what else the method knows of it.
    snapshots : empty, or the way to the equilibrium (`snapshots.Recorder.arrays`).
    """

    method: str
    status: Status
    message: str
    sheet: Sheet
    r: np.ndarray
    steps: int
    force_evaluations: int
    residual: float
    seconds: float
    cpu_seconds: float
    seconds_compile: float
    energy_N_mm: Mapping[str, float]
    reactions: Mapping[str, Reaction]
    zone: ZoneFields
    history: Mapping[str, np.ndarray]
    hourglass: Mapping[str, float | None]
    stability: Mapping[str, object]
    warnings: tuple[str, ...]
    levels: tuple[Mapping[str, Any], ...]
    threads: int
    seed: int
    snapshots: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Solution(Answer):
    """The answer of a structured-mesh method: r is (ni, nj, 3).

    grid : the mesh. history : "level", "step", "energy", "kinetic" (both N mm), "residual", "restart".
    coarser, earlier : the same problem's equilibria on coarser meshes, coarsest first, and its state on the last mesh
        some iterations before the end (`trail`); a solution read from a folder has neither.
    """

    grid: Grid
    coarser: tuple[Solution, ...] = ()
    earlier: Solution | None = None
