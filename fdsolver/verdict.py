"""From the end of the iteration to the status of the run: is the state found a state of the sheet at all?"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fdsolver.fields import TENSE
from fdsolver.grid import Grid
from fdsolver.result import Status, ZoneFields

MOST_HOURGLASS = 0.2  # share above which a result is a checkerboard rather than a deformation
LEFT_OVER = 0.01  # out-of-plane displacement / thickness that may be what is left of the random start
FLAT = 1e-9  # out-of-plane size / L below which a state is planar: there a zone that turns over is inverted
MOST_FOLDED = 0.01  # share of taut zones folded over, above which a relaxed membrane is no sheet any more
EITHER_WAY = (
    "across its wrinkles a relaxed membrane may lie either way up, which changes neither energy nor force."
)
TAUT = 1e-6  # share of the largest stress below which a zone is slack in all but name, and free to lie as it likes


def _area_normals(grid: Grid, r: np.ndarray) -> np.ndarray:
    """(zone rows, nj - 1, 3), mm^2: normal of every zone, twice its area long."""
    far, near = (np.roll(r, -1, axis=0), r) if grid.closed else (r[1:], r[:-1])
    return np.cross(far[:, 1:] - near[:, :-1], near[:, 1:] - far[:, :-1])


def turned_over(grid: Grid, r: np.ndarray) -> np.ndarray:
    """Zones of a planar state that lie upside down: their area has the other sign than in the reference.

    r : (ni, nj, 3) float64, mm. Returns (zone rows, nj - 1) bool.
    """
    reference = np.concatenate([grid.u, np.zeros((*grid.u.shape[:2], 1))], axis=-1)
    return _area_normals(grid, r)[..., 2] * _area_normals(grid, reference)[..., 2] < 0.0


def folded_zones(grid: Grid, r: np.ndarray) -> np.ndarray:
    """Zones whose normal is turned by more than 90 degrees against that of a zone beside them.

    r : (ni, nj, 3) float64, mm. Returns (zone rows, nj - 1) bool.
    """
    normal = _area_normals(grid, r)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-300)
    folded = np.zeros(normal.shape[:2], dtype=bool)
    across = np.sum(normal[:, 1:] * normal[:, :-1], axis=-1) < 0.0
    folded[:, 1:] |= across
    folded[:, :-1] |= across
    turned = np.sum(np.roll(normal, -1, axis=0) * normal, axis=-1) < 0.0
    if not grid.closed:
        turned[-1] = False  # the last row of zones has no next one
    return folded | turned | np.roll(turned, 1, axis=0)


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

    A converged state is refused where it is mostly a checkerboard (HOURGLASS) or where taut zones of a planar state
    are turned over (ZONE_INVERTED). Folds of a plate in space that are sharper than the mesh are a warning. So are
    wrinkled zones of a relaxed membrane that lie either way up: the relaxed energy, the least over all strains that
    exceed the zone's own by a positive semidefinite one, is convex in the gradient, so an equilibrium has the least
    energy of all states and the one stress, however its wrinkles lie. But a relaxed membrane has no folds of its own:
    many of them mean that it has collapsed (OUTSIDE_VALIDITY).
    r : (ni, nj, 3) float64, mm. relaxed : whether the model carries no compression.
    """
    height = float(np.abs(r[..., 2]).max())
    planar = height < FLAT * grid.length_mm
    over = turned_over(grid, r) if planar and relaxed else folded_zones(grid, r)
    folded = over & (zone.stress_major > TAUT * np.max(zone.stress_major))
    count, share = int(folded.sum()), float(folded.mean())
    warnings = []
    if count:
        warnings.append(
            f"{count} zones ({100.0 * share:.2g} %) turn by more than 90 degrees against the zones beside them: "
            + (EITHER_WAY if relaxed else "folds that this mesh cannot show.")
        )
    if status is not Status.CONVERGED:
        return status, warnings
    rough = hourglass["in_plane"] or 0.0
    if height > LEFT_OVER * thickness_mm:
        rough = max(rough, hourglass["out_of_plane"] or 0.0)
    if rough > MOST_HOURGLASS:
        return Status.HOURGLASS, warnings
    if planar and np.any(folded & (zone.state == TENSE) if relaxed else folded):
        return Status.ZONE_INVERTED, warnings
    if relaxed and share > MOST_FOLDED:
        return Status.OUTSIDE_VALIDITY, warnings
    return status, warnings
