"""The exact annulus on a scene's mesh, and the form of every exact solution."""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from cases.boundary import edges_of, sheet_of
from cases.lattice import zone_centres
from cases.methods import MethodError
from cases.schema import AnnulusSheet, Scene
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.result import Reaction, Solution, Status, ZoneFields
from tensionfield.annulus import AnnulusProblem, AnnulusSolution, NoAnnulusSolution, solve_annulus

# Of the rim conditions, over the outer radius.
_TOLERANCE = 1e-11


def solve_annulus_scene(scene: Scene, grid: Grid) -> Solution:
    """The exact solution of an annulus scene on `grid`. Raises MethodError if it has none."""
    edges, sheet = edges_of(scene), sheet_of(scene)
    if not coaxial(edges):
        raise MethodError(
            f"The scene {scene.name} has no closed form: both circles must be supported and keep one axis."
        )
    started = time.perf_counter(), time.process_time()
    try:
        exact = solve_annulus(annulus_problem(scene.sheet, sheet, edges), tolerance=_TOLERANCE)
    except NoAnnulusSolution as reason:
        raise MethodError(f"The scene {scene.name} has no closed form: {reason}") from reason
    outer = edges["outer"]
    shift = np.array(outer.move_mm)
    r = _annulus_positions(exact, grid.u, np.radians(outer.rotate_deg)) + shift
    zone = _annulus_zone(exact, grid)
    reactions = {
        "inner": _axial_reaction(exact.axial_force_N, exact.torque_N_mm, shift),
        "outer": _axial_reaction(-exact.axial_force_N, -exact.torque_N_mm, shift),
    }
    how = "axisymmetric boundary-value problem by shooting"
    return exact_solution(
        grid, sheet, r, zone, exact.energy_N_mm, reactions, _TOLERANCE, exact.warnings, how, started
    )


def annulus_problem(ring: object, sheet: Sheet, edges: Mapping[str, EdgeCondition]) -> AnnulusProblem:
    """The axisymmetric boundary-value problem of an annular sheet held at both circles, lengths in mm."""
    assert isinstance(ring, AnnulusSheet)
    inner, outer = edges["inner"], edges["outer"]
    return AnnulusProblem(
        ring.inner_radius_mm,
        ring.outer_radius_mm,
        sheet.young_MPa,
        sheet.poisson,
        sheet.thickness_mm,
        lift_mm=inner.move_mm[2] - outer.move_mm[2],
        twist_deg=inner.rotate_deg - outer.rotate_deg,
        inner_grow_mm=inner.grow_mm,
        outer_grow_mm=outer.grow_mm,
    )


def _annulus_positions(exact: AnnulusSolution, u: np.ndarray, turn: float) -> np.ndarray:
    """Deformed positions (..., 3) mm of reference points u (..., 2), all turned by `turn` radians."""
    radius, angle, height = exact.position(_radii(exact, u))
    angle = angle + turn + np.arctan2(u[..., 1], u[..., 0])
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)


def _annulus_zone(exact: AnnulusSolution, grid: Grid) -> ZoneFields:
    """The exact fields at the zone centres (means of the four node positions)."""
    radius = _radii(exact, zone_centres(grid))
    # The centres of a ring of zones differ by rounding only: one evaluation serves the ring.
    ring = radius.mean(axis=0)
    values = (*exact.stretches(ring), *exact.stresses(ring), exact.state(ring).astype(np.int8))
    return ZoneFields(*(np.tile(value, (len(radius), 1)) for value in values))


def _radii(exact: AnnulusSolution, u: np.ndarray) -> np.ndarray:
    """Radii of reference points; rounding must not carry the rims' own nodes off the sheet."""
    problem = exact.problem
    return np.clip(np.linalg.norm(u, axis=-1), problem.inner_radius_mm, problem.outer_radius_mm)


def _axial_reaction(force_N: float, torque_N_mm: float, axis_mm: np.ndarray) -> Reaction:
    """Reaction about the origin of a force along and a torque about the vertical axis through axis_mm."""
    force = np.array([0.0, 0.0, force_N])
    return Reaction(force, np.cross(axis_mm, force) + (0.0, 0.0, torque_N_mm))


def coaxial(edges: Mapping[str, EdgeCondition]) -> bool:
    """Whether both circles are supported and displaced along and about one common vertical axis."""
    inner, outer = edges["inner"], edges["outer"]
    return "free" not in (inner.support, outer.support) and inner.move_mm[:2] == outer.move_mm[:2]


def exact_solution(
    grid: Grid,
    sheet: Sheet,
    r: np.ndarray,
    zone: ZoneFields,
    energy: float,
    reactions: Mapping[str, Reaction],
    residual: float,
    warnings: tuple[str, ...],
    how: str,
    started: tuple[float, float],
) -> Solution:
    """A Solution without iterations. `started` : wall and CPU seconds at its begin; `how` : a phrase."""
    empty = np.zeros(0)
    return Solution(
        method="exact",
        status=Status.CONVERGED,
        message=f"Exact: {how}.",
        grid=grid,
        sheet=sheet,
        r=r,
        steps=0,
        force_evaluations=0,
        residual=residual,
        seconds=time.perf_counter() - started[0],
        cpu_seconds=time.process_time() - started[1],
        seconds_compile=0.0,
        energy_N_mm={"total": energy, "membrane": energy, "bending": 0.0},
        reactions=dict(reactions),
        zone=zone,
        history=dict.fromkeys(("level", "step", "energy", "kinetic", "residual", "restart"), empty),
        hourglass={"out_of_plane": None, "in_plane": None},
        # The relaxed energy is convex: an equilibrium of it is a minimum.
        stability={
            "stable": True,
            "how": "the relaxed energy is convex in the deformation gradient",
            "lowest": None,
        },
        warnings=warnings,
        levels=(),
        threads=1,
        seed=0,
    )
