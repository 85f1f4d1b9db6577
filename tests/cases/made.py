"""Solutions made from formulas, to test what is read off and stored without solving anything."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from cases.methods import Task
from fdsolver.fields import zone_fields
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.result import Reaction, Solution, Status

SHEET = Sheet(3500.0, 0.31, 0.025)


class Fake(Protocol):
    """The fixture `faked`: put a function in the place of a solver."""

    def __call__(self, solve: Callable[[Task], Solution], name: str = "tension-field") -> None: ...


def made_solution(
    grid: Grid, height: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None, stretch: float = 1.0
) -> Solution:
    """The sheet stretched along x and lifted to z = height(x, y), with numbers in every entry."""
    x, y = grid.u[..., 0], grid.u[..., 1]
    z = np.zeros_like(x) if height is None else height(x, y)
    r = np.stack([stretch * x, y, z], axis=-1)
    return Solution(
        method="koiter",
        status=Status.CONVERGED,
        message=Status.CONVERGED.sentence,
        grid=grid,
        sheet=SHEET,
        r=r,
        steps=20,
        force_evaluations=21,
        residual=3e-7,
        seconds=1.5,
        cpu_seconds=1.25,
        seconds_compile=0.5,
        energy_N_mm={"total": 3.0, "membrane": 2.0, "bending": 1.0},
        reactions={"left": Reaction(np.array([-1.0, 0.5, 0.1]), np.array([0.0, 2.0, 1 / 3]))},
        zone=zone_fields(grid, SHEET, r, relaxed=False),
        history={
            "level": np.array([0, 0, 1]),
            "step": np.array([0, 10, 0]),
            "energy": np.array([3.0, 2.0, 1 / 3]),
            "kinetic": np.array([0.0, 1e-300, 1e17]),
            "residual": np.array([np.inf, 1e-3, 3e-7]),
            "restart": np.array([0, 1, 0]),
        },
        hourglass={"out_of_plane": 1e-4, "in_plane": None},
        stability={"stable": True, "how": "re-kick", "lowest": 0.25},
        warnings=("a warning",),
        levels=({"nodes": 400, "steps": 10, "residual": 1e-3, "energy": 2.0, "seconds": 0.5},),
        threads=1,
        seed=7,
    )


def assert_same(first: Solution, second: Solution) -> None:
    """Equal in every bit that a folder stores."""
    assert first.r.tobytes() == second.r.tobytes()
    for name in ("stretch_major", "stretch_minor", "stress_major", "stress_minor", "state"):
        assert np.array_equal(getattr(first.zone, name), getattr(second.zone, name))
    for name in ("method", "status", "message", "steps", "force_evaluations", "residual", "warnings", "seed"):
        assert getattr(first, name) == getattr(second, name), name
    assert dict(first.energy_N_mm) == dict(second.energy_N_mm)
    assert set(first.reactions) == set(second.reactions)
    for edge, reaction in first.reactions.items():
        assert np.array_equal(reaction.force_N, second.reactions[edge].force_N)
        assert np.array_equal(reaction.moment_N_mm, second.reactions[edge].moment_N_mm)
