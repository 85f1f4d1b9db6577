"""Method `exact`: scenes whose relaxed (tension-field) equilibrium is known to all digits, on the scene's
mesh.

Annulus between two supported circles: the axisymmetric boundary-value problem (`tensionfield.annulus`).
Rectangles and holed rectangles: homogeneous states, where the supported edges move by one affine map and the
free edges carry no stress.
"""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from cases.lattice import zone_centres
from cases.methods import MethodError, edges_of, sheet_of
from cases.schema import AnnulusSheet, Scene
from fdsolver.edges import EdgeCondition
from fdsolver.fields import principal_strains, zone_state
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.result import Reaction, Solution, Status, ZoneFields
from fdsolver.start import moved
from tensionfield.annulus import AnnulusProblem, AnnulusSolution, NoAnnulusSolution, solve_annulus

# Edges are given to 16 digits, some by trigonometric functions: an affine map holds to a few roundings of the
# size.
_AFFINE = 1e-12
# A stress below this part of Young's modulus is rounding of strains near 1.
_STRESS_FREE = 1e-12
_TOLERANCE = 1e-11

Affine = tuple[np.ndarray, np.ndarray]


def has_exact(scene: Scene) -> bool:
    """Whether a scene has a closed form: a homogeneous state, or an annulus held at both circles about one
    axis.
    """
    if isinstance(scene.sheet, AnnulusSheet):
        return _coaxial(edges_of(scene))
    return homogeneous_map(scene) is not None


def solve_exact(scene: Scene, grid: Grid) -> Solution:
    """The exact solution of a scene on `grid`.

    Raises MethodError for a scene that has none.
    """
    if isinstance(scene.sheet, AnnulusSheet):
        return _annulus(scene, grid)
    affine = homogeneous_map(scene)
    if affine is None:
        raise MethodError(
            f"The scene {scene.name} has no closed form: it is no annulus held at both circles, and its"
            " edges leave no homogeneous state."
        )
    return _homogeneous(scene, grid, affine)


def homogeneous_map(scene: Scene) -> Affine | None:
    """F (3, 2) and b (3,) mm with r = F u + b if the scene's relaxed equilibrium is homogeneous, else
    None.
    """
    edges, corners = edges_of(scene), _corners(scene)
    held = [name for name, edge in edges.items() if edge.support != "free"]
    if not held or not set(held) <= set(corners):
        return None
    reference = np.concatenate([corners[name] for name in held])
    target = np.concatenate([_moved(corners[name], edges[name]) for name in held])
    known = np.column_stack([reference, np.ones(len(reference))])
    if np.linalg.matrix_rank(known) < 3:
        return None
    solution = np.linalg.lstsq(known, target, rcond=None)[0]
    if np.abs(known @ solution - target).max() > _AFFINE * scene.sheet.size_mm:
        return None
    gradient = solution[:2].T
    free = [name for name in edges if name not in held]
    stress = _relaxed_stress(gradient, sheet_of(scene))
    if "hole" in free and np.abs(stress).max() > _STRESS_FREE * scene.material.young_MPa:
        return None
    for name in set(free) & set(corners):
        if np.abs(stress @ _normal(corners[name])).max() > _STRESS_FREE * scene.material.young_MPa:
            return None
    return gradient, solution[2]


def _homogeneous(scene: Scene, grid: Grid, affine: Affine) -> Solution:
    started = time.perf_counter(), time.process_time()
    gradient, shift = affine
    sheet = sheet_of(scene)
    r = grid.u @ gradient.T + shift
    stress = _relaxed_stress(gradient, sheet)
    strain = 0.5 * (gradient.T @ gradient - np.eye(2))
    # The relaxed energy is half of S : E: it is quadratic in E in every state.
    energy = 0.5 * float(np.sum(stress * strain)) * sheet.thickness_mm * float(grid.zone_area.sum())
    reactions = {}
    for name, ends in _corners(scene).items():
        if scene.edges[name].support == "free":
            continue
        length = float(np.linalg.norm(ends[1] - ends[0]))
        force = sheet.thickness_mm * length * gradient @ stress @ _normal(ends)
        middle = gradient @ ends.mean(axis=0) + shift
        reactions[name] = Reaction(force, np.cross(middle, force))
    zone = _uniform_zone(gradient, sheet, grid.zone_area.shape)
    return _solution(grid, sheet, r, zone, energy, reactions, 0.0, (), "homogeneous state", started)


def _uniform_zone(gradient: np.ndarray, sheet: Sheet, shape: tuple[int, ...]) -> ZoneFields:
    """The same fields in every zone; taken from one gradient, so that rounding cannot speckle a border
    state.
    """
    major, minor = principal_strains(gradient)
    lateral, tension = np.linalg.eigvalsh(_relaxed_stress(gradient, sheet))
    values = (np.sqrt(1.0 + 2.0 * major), np.sqrt(1.0 + 2.0 * minor), tension, lateral)
    state = zone_state(major, minor, sheet.poisson)
    return ZoneFields(*(np.full(shape, value) for value in (*values, state)))


def _annulus(scene: Scene, grid: Grid) -> Solution:
    edges, sheet = edges_of(scene), sheet_of(scene)
    if not _coaxial(edges):
        raise MethodError(
            f"The scene {scene.name} has no closed form: both circles must be supported and keep one axis."
        )
    started = time.perf_counter(), time.process_time()
    try:
        exact = solve_annulus(_annulus_problem(scene.sheet, sheet, edges), tolerance=_TOLERANCE)
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
    return _solution(
        grid, sheet, r, zone, exact.energy_N_mm, reactions, _TOLERANCE, exact.warnings, how, started
    )


def _annulus_problem(ring: object, sheet: Sheet, edges: Mapping[str, EdgeCondition]) -> AnnulusProblem:
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


def _coaxial(edges: Mapping[str, EdgeCondition]) -> bool:
    """Whether both circles are supported and displaced along and about one common vertical axis."""
    inner, outer = edges["inner"], edges["outer"]
    return "free" not in (inner.support, outer.support) and inner.move_mm[:2] == outer.move_mm[:2]


def _relaxed_stress(gradient: np.ndarray, sheet: Sheet) -> np.ndarray:
    """2nd Piola stress (2, 2) MPa of the relaxed membrane (MODEL section 2) for a deformation gradient (3,
    2).
    """
    strain, directions = np.linalg.eigh(0.5 * (gradient.T @ gradient - np.eye(2)))
    minor, major = strain
    nu = sheet.poisson
    lateral = max(minor + nu * major, 0.0) / (1.0 - nu**2)
    principal = (lateral, max(major, 0.0) + nu * lateral)
    return sheet.young_MPa * (directions * principal) @ directions.T


def _moved(u: np.ndarray, edge: EdgeCondition) -> np.ndarray:
    """Where an edge carries its points u (n, 2): (n, 3) mm."""
    size = len(u)
    turn = np.full(size, np.radians(edge.rotate_deg))
    return moved(u, np.full(size, edge.grow_mm), turn, np.tile(edge.move_mm, (size, 1)))


def _corners(scene: Scene) -> dict[str, np.ndarray]:
    """Straight edges and their two ends (2, 2) mm, with the sheet on the left."""
    sheet = scene.sheet
    if isinstance(sheet, AnnulusSheet):
        return {}
    x, y = sheet.width_mm / 2.0, sheet.height_mm / 2.0
    corner = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    order = {"bottom": (0, 1), "right": (1, 2), "top": (2, 3), "left": (3, 0)}
    return {name: corner[list(ends)] for name, ends in order.items()}


def _normal(ends: np.ndarray) -> np.ndarray:
    """Outward unit normal (2,) of an edge with the sheet on its left."""
    along = ends[1] - ends[0]
    return np.array([along[1], -along[0]]) / np.linalg.norm(along)


def _solution(
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
