"""The energy that wrinkling gains: that of the sheet kept flat less that of the wrinkled one, on the same mesh.

Wrinkles change the total energy of a pulled sheet by a hundred-thousandth: less than a change of mesh does. The
difference on one mesh is free of that error, if both states have the same energy: the plate's, with all that it does
in its plane. The sheet kept flat is therefore the plate's own planar equilibrium, found without a perturbation, and
examined for stability but not left where it is unstable.
"""

from __future__ import annotations

from dataclasses import replace

from cases.boundary import problem_of, settings_of
from cases.methods import METHODS, with_numbers
from cases.schema import Scene
from fdsolver.model import KOITER
from fdsolver.multilevel import solve
from fdsolver.result import Solution, Status

KEPT_FLAT = replace(KOITER, buckles=False)


class NotComparable(ValueError):
    """Two states whose energies cannot be compared; the message is one sentence."""


def flat_state(scene: Scene, nodes: int | None = None, tolerance: float | None = None) -> Solution:
    """The plate of a scene kept in its plane, at its planar equilibrium; `stability` says what it would do.

    nodes, tolerance : instead of the scene's. The status may be any of a run's; the sheet is flat to the last bit.
    """
    resolved = with_numbers(scene, METHODS["koiter"], nodes, tolerance)
    assert resolved.solver.tolerance is not None, "with_numbers sets the tolerance"
    settings = settings_of(resolved, resolved.solver.tolerance)
    problem = replace(problem_of(resolved, KEPT_FLAT, seed=0), perturbation=0.0, initial=None)
    return solve(problem, KEPT_FLAT, settings)


def energy_gained(wrinkled: Solution, flat: Solution) -> float:
    """Total energy of the flat state less that of the wrinkled one, N mm; positive where wrinkling pays.

    Raises NotComparable for states that are not both converged, of different meshes or sheets, or not flat.
    """
    for name, state in (("wrinkled", wrinkled), ("flat", flat)):
        if state.status is not Status.CONVERGED:
            raise NotComparable(f"The {name} state is not converged but {state.status.value}.")
    if wrinkled.grid.u.shape != flat.grid.u.shape or (wrinkled.grid.u != flat.grid.u).any():
        raise NotComparable(
            f"The states are of different meshes, {wrinkled.grid.nodes} and {flat.grid.nodes} nodes."
        )
    if wrinkled.sheet != flat.sheet:
        raise NotComparable("The states are of different sheets.")
    if flat.r[..., 2].any():
        raise NotComparable("The state to compare with is not flat.")
    return flat.energy_N_mm["total"] - wrinkled.energy_N_mm["total"]
