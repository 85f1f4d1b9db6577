"""From the end of the iteration to the status of the run: is the state found a state of the sheet at all?"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fdsolver.fields import TENSE
from fdsolver.folds import folded_against_tension, folded_zones, inverted_zones, turned_over
from fdsolver.grid import Grid
from fdsolver.result import Status, ZoneFields

MOST_HOURGLASS = 0.2  # share above which a result is a checkerboard rather than a deformation
LEFT_OVER = 0.01  # out-of-plane displacement / thickness that may be what is left of the random start
FLAT = 1e-9  # out-of-plane size / L below which a state is planar: there a zone that turns over is inverted
MOST_FOLDED = 0.01  # share of zones in faulty folds above which a relaxed membrane is no sheet any more
TURN = "turn by more than 90 degrees against the zones beside them"
EITHER_WAY = (
    "across its wrinkles a relaxed membrane may lie either way up, which changes neither energy nor force."
)
NO_SHEET = "are folded against their tension, or lie where the sheet runs together within less than a zone."
TAUT = 1e-6  # share of the largest stress below which a zone is slack in all but name, and free to lie as it likes


def judge(
    status: Status,
    grid: Grid,
    thickness_mm: float,
    r: np.ndarray,
    zone: ZoneFields,
    hourglass: Mapping[str, float | None],
    relaxed: bool = False,
) -> tuple[Status, list[str]]:
    """The status of a run whose iteration ended with `status`, and warnings about folds.

    A converged state is refused where it is mostly a checkerboard (HOURGLASS) or where zones of a planar state are
    inverted (ZONE_INVERTED). Folds of a plate in space that are sharper than the mesh are a warning.

    So are parts of a relaxed membrane that lie the other way up, planar or in space, wrinkled or tense, if nothing but
    folds of its tension field leads to them (`folds`). The relaxed energy, the least over all strains that exceed the
    zone's own by a positive semidefinite one, is convex in the gradient, so an equilibrium has the least energy of all
    states and the one stress, and no orientation of the surface enters it. Other folds of taut zones are faults: a
    tense zone that lies upside down behind one is inverted, and many of them mean that the membrane has collapsed, or
    that the mesh cannot tell whether it has (OUTSIDE_VALIDITY).
    r : (ni, nj, 3) float64, mm. relaxed : whether the model carries no compression.
    """
    height = float(np.abs(r[..., 2]).max())
    planar = height < FLAT * grid.length_mm
    taut = zone.stress_major > TAUT * np.max(zone.stress_major)
    if relaxed:
        faulty, warnings = _relaxed_folds(grid, r, zone, taut, planar)
    else:
        faulty = taut & folded_zones(grid, r)
        warnings = _counted(faulty, f"{TURN}: folds that this mesh cannot show.")
    if status is not Status.CONVERGED:
        return status, warnings
    rough = hourglass["in_plane"] or 0.0
    if height > LEFT_OVER * thickness_mm:
        rough = max(rough, hourglass["out_of_plane"] or 0.0)
    if rough > MOST_HOURGLASS:
        return Status.HOURGLASS, warnings
    if planar and np.any(faulty & (zone.state == TENSE) if relaxed else faulty):
        return Status.ZONE_INVERTED, warnings
    if relaxed and float(faulty.mean()) > MOST_FOLDED:
        return Status.OUTSIDE_VALIDITY, warnings
    return status, warnings


def _relaxed_folds(
    grid: Grid, r: np.ndarray, zone: ZoneFields, taut: np.ndarray, planar: bool
) -> tuple[np.ndarray, list[str]]:
    """Zones (zone rows, nj - 1) of a relaxed membrane whose folds are faults, and warnings about all its folds."""
    if planar:
        over, faulty = turned_over(grid, r), taut & inverted_zones(grid, r, zone)
        how = "lie upside down, and the flat sheet upon itself"
    else:
        over, faulty = folded_zones(grid, r), taut & folded_against_tension(grid, r, zone)
        how = TURN
    return faulty, _counted(taut & over, f"{how}: {EITHER_WAY}") + _counted(faulty, NO_SHEET)


def _counted(zones: np.ndarray, what: str) -> list[str]:
    """The sentence that so many zones do so, if any does."""
    count = int(zones.sum())
    return [f"{count} zones ({100.0 * float(zones.mean()):.2g} %) {what}"] if count else []
