"""What is read off a state: principal stretches and stresses, zone states, reactions, hourglass share."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.membrane import zone_constants
from fdsolver.result import Reaction, ZoneFields

SLACK, WRINKLED, TENSE = 0, 1, 2
STRAIN_ROUNDING = 1e-12  # a few thousand roundings of a stretch near one
HARDLY_MOVED = 1e-9  # of the sheet's size: a displacement below it has no hourglass share


def zone_gradient(grid: Grid, r: np.ndarray) -> np.ndarray:
    """Deformation gradient of every zone [57].

    r : (ni, nj, 3) float64, mm. Returns (3, 2, zone rows, nj - 1) float64, F_ka.
    """
    g1x, g1y, g2x, g2y, _ = zone_constants(grid) / grid.length_mm
    far = np.roll(r, -1, axis=0) if grid.closed else r[1:]
    near = r if grid.closed else r[:-1]
    d1 = np.moveaxis(far[:, 1:] - near[:, :-1], -1, 0)
    d2 = np.moveaxis(near[:, 1:] - far[:, :-1], -1, 0)
    return np.stack([d1 * g1x + d2 * g2x, d1 * g1y + d2 * g2y], axis=1)


def principal_strains(gradient: np.ndarray, moderate: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Principal strains E1 >= E2 of deformation gradients (3, 2, ...): Green's, or of moderate rotations."""
    if moderate:
        (f11, f12), (f21, f22), (w1, w2) = gradient
        e11, e22, e12 = f11 - 1.0 + 0.5 * w1**2, f22 - 1.0 + 0.5 * w2**2, 0.5 * (f12 + f21 + w1 * w2)
    else:
        e11 = 0.5 * (np.sum(gradient[:, 0] ** 2, axis=0) - 1.0)
        e22 = 0.5 * (np.sum(gradient[:, 1] ** 2, axis=0) - 1.0)
        e12 = 0.5 * np.sum(gradient[:, 0] * gradient[:, 1], axis=0)
    mean, radius = 0.5 * (e11 + e22), np.hypot(0.5 * (e11 - e22), e12)
    return mean + radius, mean - radius


def zone_state(major: np.ndarray, minor: np.ndarray, poisson: float) -> np.ndarray:
    """Slack, wrinkled or tense (0, 1, 2; int8) from the principal Green strains (Pipkin 1986).

    A largest strain that is no more than the rounding of positions is none: such a zone is slack.
    """
    wrinkled = np.where(minor + poisson * major > 0.0, TENSE, WRINKLED)
    return np.where(major > STRAIN_ROUNDING, wrinkled, SLACK).astype(np.int8)


def zone_fields(grid: Grid, sheet: Sheet, r: np.ndarray, relaxed: bool, moderate: bool = False) -> ZoneFields:
    """Principal stretches, principal 2nd Piola stresses (MPa) and states of all zones.

    r : (ni, nj, 3) float64, mm. relaxed : whether compression is relaxed away (tension field) or carried.
    moderate : whether the strains are those of moderate rotations.
    """
    major, minor = principal_strains(zone_gradient(grid, r), moderate)
    nu, young = sheet.poisson, sheet.young_MPa
    lateral = (minor + nu * major) / (1.0 - nu**2)
    tension = major
    if relaxed:
        lateral, tension = np.maximum(lateral, 0.0), np.maximum(major, 0.0)
    return ZoneFields(
        stretch_major=np.sqrt(np.maximum(1.0 + 2.0 * major, 0.0)),
        stretch_minor=np.sqrt(np.maximum(1.0 + 2.0 * minor, 0.0)),
        stress_major=young * (tension + nu * lateral),
        stress_minor=young * lateral,
        state=zone_state(major, minor, nu),
    )


def reactions(
    grid: Grid, edges: Mapping[str, EdgeCondition], r: np.ndarray, force_N: np.ndarray
) -> dict[str, Reaction]:
    """What each supported edge exerts on the sheet: minus the sheet's own force on the edge's nodes.

    r : (ni, nj, 3) mm. force_N : (ni, nj, 3) N, -dE/dr. A node of two supported edges counts for the first.
    """
    counted = np.zeros((grid.ni, grid.nj), dtype=bool)
    result = {}
    for name, condition in edges.items():
        if condition.support == "free":
            continue
        i, j = grid.edges[name].T
        new = ~counted[i, j]
        i, j = i[new], j[new]
        counted[i, j] = True
        push = -force_N[i, j]
        result[name] = Reaction(push.sum(axis=0), np.cross(r[i, j], push).sum(axis=0))
    return result


def hourglass_share(grid: Grid, r: np.ndarray) -> dict[str, float | None]:
    """Rms of the checkerboard part of the displacement over rms of its smooth part, out of plane and in plane.

    The checkerboard part is what the filter (-1, 2, -1)/4 in both mesh directions lets pass: all of (-1)^(i+j), and a
    fourth difference of a smooth field. None where both parts are below `HARDLY_MOVED` of the sheet's size; a
    checkerboard alone is measured against that size.
    """
    reference = np.concatenate([grid.u, np.zeros((grid.ni, grid.nj, 1))], axis=-1)
    w = r - reference
    along = np.concatenate([w[-1:], w, w[:1]]) if grid.closed else w
    high = (2.0 * along[1:-1] - along[:-2] - along[2:]) / 4.0
    high = (2.0 * high[:, 1:-1] - high[:, :-2] - high[:, 2:]) / 4.0
    smooth = (w if grid.closed else w[1:-1])[:, 1:-1] - high

    def share(axes: slice) -> float | None:
        size = float(np.sqrt(np.mean(np.sum(smooth[..., axes] ** 2, axis=-1))))
        rough = float(np.sqrt(np.mean(np.sum(high[..., axes] ** 2, axis=-1))))
        least = HARDLY_MOVED * grid.length_mm
        return rough / max(size, least) if max(size, rough) > least else None

    return {"out_of_plane": share(slice(2, 3)), "in_plane": share(slice(0, 2))}
