"""How wrong a result is, estimated from the run itself: `errors` of result.json.

Discretisation error: the quantity on the nested meshes of the run. Three meshes give an observed order and the
grid-convergence index (`cases.mesh_sequence`), with the order taken as at most the scheme's; two meshes allow only an
assumed order and earn the larger safety factor of that case. A sequence that does not converge in that way is refused:
the reason stands where the number would.

With its estimate comes the limit: where the values on the meshes lead.

Iteration error: near equilibrium every quantity approaches its value in proportion to the residual, so what changed
since the residual was larger, times the ratio of the residuals, is what further iterations would still change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cases.mesh_sequence import SAFETY, mesh_limit
from cases.quantities import quantities
from cases.schema import Scene
from fdsolver.result import Solution, Status

ORDER = 2.0  # of the scheme: energies, loads and positions
EXTREME_ORDER = (
    1.0  # of extreme stretches: zone centres are half a zone away from the edge that has the extreme
)
SAFETY_TWO_MESHES = 3.0  # Roache 1998, where the order is assumed
SAFETY_ITERATION = 3.0  # residuals fall in waves: two of them tell the rate to about this factor
HIGHEST_NODE = "out_of_plane_mm.max_abs"  # orders seen in its height are chance, and so is agreement
SHARE = 0.1  # of the discretisation error that the iteration error should not exceed


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated errors of one quantity, in its unit.

    discretisation : None where the meshes allow no estimate; `how` has the reason. iteration : None where the run
    gives none. order : observed order of convergence, None where it was not observed. limit : where the values on the
    meshes lead (Richardson 1911), mostly nearer to the truth than the value; None with the discretisation error.
    """

    quantity: str
    value: float
    discretisation: float | None
    iteration: float | None
    order: float | None
    how: str
    limit: float | None = None

    @property
    def total(self) -> float | None:
        """Discretisation and iteration error together; None without the former."""
        return None if self.discretisation is None else self.discretisation + (self.iteration or 0.0)


def errors_of(solution: Solution, scene: Scene) -> list[ErrorEstimate]:
    """One estimate per quantity of a nested run; none for a closed form, or one read back from its folder."""
    if not solution.levels:
        return []
    meshes = [*solution.coarser, solution]
    found = [quantities(state, scene) for state in meshes]
    before = {} if solution.earlier is None else quantities(solution.earlier, scene)
    zones = [state.grid.zone_area.size for state in meshes]
    reason = _unlike(solution)
    estimates = []
    for name, value in found[-1].items():
        iteration = _iteration(value, before.get(name), solution)
        values = [state[name] for state in found if name in state]
        if reason or len(values) < len(meshes):
            why = reason or "a coarser mesh does not have it"
            estimates.append(ErrorEstimate(name, value, None, iteration, None, f"refused: {why}"))
        else:
            formal = EXTREME_ORDER if name.startswith("stretch.") else ORDER
            error, order, how = discretisation_error(zones, values, formal, iteration or 0.0)
            if name == HIGHEST_NODE and not _highest_is_held(solution):
                error, order, how = None, None, "refused: no node stands on the crest, on any of the meshes"
            limit = None if error is None else _limit(zones, values, order or formal)
            estimates.append(ErrorEstimate(name, value, error, iteration, order, how, limit))
    return estimates


def _unlike(solution: Solution) -> str:
    """Why the meshes of a run cannot be compared, or ""."""
    if solution.status in (Status.NOT_FINITE, Status.DIVERGED):
        return "the run has no equilibrium"
    if not solution.coarser:
        return "the run had one mesh alone; solver.levels asks for more"
    if any(state.sheet != solution.sheet for state in solution.coarser):
        return "the coarser meshes were solved with a thicker sheet (solver.thicken, solver.thinning)"
    return ""


def _highest_is_held(solution: Solution) -> bool:
    """Whether the highest node is one of a supported edge, whose height is given."""
    height = np.abs(solution.r[..., 2])
    held = np.zeros(height.shape, dtype=bool)
    for edge in solution.reactions:
        held[tuple(solution.grid.edges[edge].T)] = True
    return bool(held[height == height.max()].all())


def discretisation_error(
    zones: Sequence[int], values: Sequence[float], formal: float = ORDER, noise: float = 0.0
) -> tuple[float | None, float | None, str]:
    """(error of the last value, observed order, how) from the values on meshes of ever more zones.

    formal : order of the scheme: two meshes are assumed to have it, three are not believed to have more.
    noise : iteration error of the values, below which their differences say nothing. The error is None where it is
    refused.
    """
    if len(values) < 2:
        return None, None, "refused: there is one mesh alone"
    change = abs(values[-1] - values[-2])
    if float(np.ptp(values[-3:])) <= noise:
        return noise, None, "the meshes agree to the iteration error"
    ratio = (zones[-1] / zones[-2]) ** 0.5
    if len(values) == 2:
        error = SAFETY_TWO_MESHES * change / (ratio**formal - 1.0)
        return error, None, f"two meshes, order {formal:g} assumed, safety factor {SAFETY_TWO_MESHES:g}"
    limit = mesh_limit(zones, values)
    if limit.refused:
        return None, None, f"refused: {limit.refused}"
    if limit.order is None:
        return limit.band, None, "the meshes agree to rounding"
    order = min(limit.order, formal)
    error = max(SAFETY * change / (ratio**order - 1.0), limit.error_of_finest)
    return error, limit.order, f"{len(values)} meshes, order observed, safety factor {SAFETY:g}"


def _limit(zones: Sequence[int], values: Sequence[float], order: float) -> float:
    """The value on ever finer meshes, from those on the last two, if errors fall with this order."""
    if zones[-1] == zones[-2]:
        return values[-1]
    return values[-1] + (values[-1] - values[-2]) / ((zones[-1] / zones[-2]) ** (0.5 * order) - 1.0)


def _iteration(value: float, before: float | None, solution: Solution) -> float | None:
    """What further iterations would change; None where the run does not tell."""
    if solution.levels[-1].get("steps") == 0:
        # At rest from the start: nodal forces of one sign, added up across the mesh, strain the sheet as much.
        return SAFETY_ITERATION * abs(value) * solution.residual * solution.grid.nodes**0.5
    if before is None or solution.earlier is None:
        return None
    share = solution.residual / solution.earlier.residual
    if not 0.0 <= share < 1.0:
        return None
    return SAFETY_ITERATION * abs(value - before) * share / (1.0 - share)
