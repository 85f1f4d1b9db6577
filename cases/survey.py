"""What a coarse tension-field solve tells of a scene before it is solved: where it is wrinkled, and with which waves.

The relaxed membrane has no bending, so its stress does not depend on the thickness and is found on a coarse mesh in a
moment. From it follow the share of the sheet that is wrinkled or slack, and the wavelength and energy that wrinkles of
the real thickness will have (Cerda and Mahadevan 2003): with the tension T along the wrinkles, their length l and the
shortening d across them,

    wavelength = 2 sqrt(pi) (D / T)^(1/4) l^(1/2),      energy per area = 2 D (2 pi / wavelength)^2 d,

half of it bending and half the stretching that keeps the waves short. Whether the plate can wrinkle at all is asked of
its own flat state on a coarse mesh: a stiff one stays flat although it is compressed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cases.boundary import edges_of, grid_of, sheet_of
from cases.scene_text import scene_toml
from cases.schema import AnnulusSheet, Scene
from fdsolver.fields import SLACK, WRINKLED, principal_strains, zone_gradient
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER, Model
from fdsolver.problem import Problem
from fdsolver.relax import Settings
from fdsolver.result import Solution, Status

NODES = 1500  # of the coarse mesh: shares of the area to a few percent, which is all that is asked of it
TOLERANCE = 1e-5
FLAT_TOLERANCE = 1e-8  # of the flat plate: at 1e-5 the compression that wrinkles it may not have grown yet
MOST_SECONDS = 20.0
FLAT_LOAD = 1e-12  # out-of-plane movement of an edge, over the sheet's size, below which it is none
COMPRESSED = (
    1e-5  # compression over the largest strain below which it is what a solve leaves where there is none
)
PER_WAVE = 8.0  # nodes that a wave of the flat plate's buckling takes
MOST_FLAT_NODES = 6000  # of a coarse flat plate: beyond, its waves are too short for cheap calculations


@dataclass(frozen=True)
class Wrinkles:
    """Wrinkles to expect from a state of the membrane.

    wavelength_mm : typical one, area-weighted; infinite where nothing wrinkles. energy_N_mm : of all wrinkles.
    height_mm : amplitude that takes up the mean shortening of the wrinkled part. share : of the area that is
    compressed, in one direction or in both.
    """

    wavelength_mm: float
    energy_N_mm: float
    height_mm: float
    share: float


@dataclass(frozen=True)
class Survey:
    """What the coarse solve found. wrinkled, slack : shares of the area. slope : largest slope of the sheet, dy/dx.

    converged : whether the coarse solve did. least_tension : smallest minor over largest major principal stress of the
    membrane before relaxation: positive where the whole sheet is safely tense.
    """

    solution: Solution
    wrinkled: float
    slack: float
    slope: float
    least_tension: float
    wrinkles: Wrinkles
    converged: bool


def loads_in_plane(scene: Scene) -> bool:
    """Whether every supported edge stays in the plane of the sheet."""
    size = scene.sheet.size_mm
    moves = [abs(edge.move_mm[2]) for edge in scene.edges.values() if edge.support != "free"]
    # edges that all move alike out of the plane carry the plane with them, but the sheet starts below
    return max(moves, default=0.0) <= FLAT_LOAD * size


def tension_length_mm(scene: Scene) -> float:
    """Length along which the sheet is pulled: between its most distant supports, or between the circles."""
    sheet = scene.sheet
    if isinstance(sheet, AnnulusSheet):
        return sheet.smallest_width_mm
    upright = {"bottom", "top"} & {name for name, edge in scene.edges.items() if edge.support != "free"}
    return sheet.height_mm if upright else sheet.width_mm


def survey(scene: Scene, nodes: int = NODES) -> Survey:
    """Solve the scene's tension field on a coarse mesh, once per scene and process."""
    return _once(f"survey {nodes}", scene, lambda: _solve(scene, nodes))


def stiffness_against_buckling(scene: Scene) -> float | None:
    """Lowest eigenvalue (`fdsolver.planar`) of the scene's plate kept in its plane, on a coarse mesh.

    Negative where the flat plate is unstable. None where no coarse mesh has `PER_WAVE` nodes for every wave that the
    tension field lets expect, and where the flat state is not found.
    """
    found = survey(scene)
    area = float(found.solution.grid.zone_area.sum())
    needed = max(NODES, math.ceil(area * (PER_WAVE / found.wrinkles.wavelength_mm) ** 2))
    if needed > MOST_FLAT_NODES:
        return None
    solution = _once(f"flat {needed}", scene, lambda: _flat_plate(scene, needed))
    lowest = solution.stability["lowest"]
    return lowest if isinstance(lowest, float) and math.isfinite(lowest) else None


_KEPT: dict[str, Any] = {}
_MOST_KEPT = 32


def _once(kind: str, scene: Scene, make: Callable[[], Any]) -> Any:
    """What `make` gives for a scene, made once per process."""
    bare = replace(scene, sections={}, paths={}, name="survey", title="")
    key = f"{kind} {scene_toml(bare)}"
    if key not in _KEPT:
        if len(_KEPT) >= _MOST_KEPT:
            _KEPT.pop(next(iter(_KEPT)))
        _KEPT[key] = make()
    return _KEPT[key]


def _coarse(scene: Scene, model: Model, nodes: int, tolerance: float = TOLERANCE) -> Solution:
    """A model of the whole sheet, unperturbed, on a coarse mesh."""
    from fdsolver.multilevel import solve

    make = grid_of(scene)
    moderate = scene.effects.kinematics == "moderate"
    problem = Problem(sheet_of(scene), edges_of(scene), make(nodes), make, perturbation=0.0)
    settings = Settings(tolerance=tolerance, levels=1, max_seconds=MOST_SECONDS)
    return solve(problem, replace(model, moderate=moderate), settings)


def _flat_plate(scene: Scene, nodes: int) -> Solution:
    return _coarse(scene, replace(KOITER, out_of_plane=False), nodes, FLAT_TOLERANCE)


def _solve(scene: Scene, nodes: int) -> Survey:
    from tensionfield.relaxed import TENSION_FIELD

    moderate = scene.effects.kinematics == "moderate"
    solution = _coarse(scene, replace(TENSION_FIELD, out_of_plane=not loads_in_plane(scene)), nodes)
    area, state = solution.grid.zone_area, solution.zone.state
    total = area.sum()
    gradient = zone_gradient(solution.grid, solution.r)
    slope = np.hypot(gradient[2, 0], gradient[2, 1])
    major, minor = principal_strains(gradient, moderate)
    nu = solution.sheet.poisson
    across = (minor + nu * major) / (1.0 - nu**2)
    along = (major + nu * minor) / (1.0 - nu**2)
    return Survey(
        solution,
        wrinkled=float(area[state == WRINKLED].sum() / total),
        slack=float(area[state == SLACK].sum() / total),
        slope=float(slope.max()),
        least_tension=float(across.min() / max(float(np.abs(along).max()), 1e-300)),
        wrinkles=wrinkles_of(solution.grid, solution.sheet, solution.r, tension_length_mm(scene), moderate),
        converged=solution.status is Status.CONVERGED,
    )


def wrinkles_of(
    grid: Grid, sheet: Sheet, r: np.ndarray, length_mm: float, moderate: bool = False
) -> Wrinkles:
    """Wrinkles that bending makes of a state of the membrane, relaxed or not.

    r : (ni, nj, 3) mm. length_mm : of the wrinkles, along the tension. moderate : kinematics of the strains.
    """
    major, minor = principal_strains(zone_gradient(grid, r), moderate)
    shortening = np.maximum(-(minor + sheet.poisson * np.maximum(major, 0.0)), 0.0)
    compressed = shortening > COMPRESSED * max(float(np.abs(major).max()), float(np.abs(minor).max()))
    share = float(grid.zone_area[compressed].sum() / grid.zone_area.sum())
    wrinkled = compressed & (major > 0.0)
    if not wrinkled.any():
        return Wrinkles(math.inf, 0.0, 0.0, share)
    tension = sheet.young_MPa * sheet.thickness_mm * major[wrinkled]
    ratio = sheet.bending_stiffness_N_mm / tension
    wavelength = 2.0 * math.sqrt(math.pi) * ratio**0.25 * math.sqrt(length_mm)
    area = grid.zone_area[wrinkled]
    weight = area * shortening[wrinkled]
    energy = 2.0 * sheet.bending_stiffness_N_mm * (2.0 * math.pi / wavelength) ** 2 * weight
    # a wave of amplitude A shortens by (pi A / wavelength)^2
    height = np.average(wavelength * np.sqrt(shortening[wrinkled]) / math.pi, weights=area)
    return Wrinkles(float(np.average(wavelength, weights=weight)), float(energy.sum()), float(height), share)
