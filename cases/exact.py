"""Method `exact`: scenes whose relaxed (tension-field) equilibrium is known to all digits, on the scene's
mesh.

Annulus between two supported circles: the axisymmetric boundary-value problem (`tensionfield.annulus`).
Rectangles and holed rectangles: homogeneous states, where the supported edges move by one affine map and the
free edges carry no stress.
"""

from __future__ import annotations

import time

import numpy as np

from cases.boundary import edges_of, sheet_of
from cases.exact_annulus import coaxial, exact_solution, solve_annulus_scene
from cases.methods import MethodError
from cases.schema import AnnulusSheet, Scene
from fdsolver.edges import EdgeCondition
from fdsolver.fields import principal_strains, zone_state
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.result import Reaction, Solution, ZoneFields
from fdsolver.start import moved

# Edges are given to 16 digits, some by trigonometric functions: an affine map holds to a few roundings of the
# size.
_AFFINE = 1e-12
# A stress below this part of Young's modulus is rounding of strains near 1.
_STRESS_FREE = 1e-12

Affine = tuple[np.ndarray, np.ndarray]


def has_exact(scene: Scene) -> bool:
    """Whether a scene has a closed form: a homogeneous state, or an annulus held at both circles about one
    axis.
    """
    if isinstance(scene.sheet, AnnulusSheet):
        return coaxial(edges_of(scene))
    return homogeneous_map(scene) is not None


def solve_exact(scene: Scene, grid: Grid) -> Solution:
    """The exact solution of a scene on `grid`.

    Raises MethodError for a scene that has none.
    """
    if isinstance(scene.sheet, AnnulusSheet):
        return solve_annulus_scene(scene, grid)
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
    return exact_solution(grid, sheet, r, zone, energy, reactions, 0.0, (), "homogeneous state", started)


def _uniform_zone(gradient: np.ndarray, sheet: Sheet, shape: tuple[int, ...]) -> ZoneFields:
    """The same fields in every zone; taken from one gradient, so that rounding cannot speckle a border
    state.
    """
    major, minor = principal_strains(gradient)
    lateral, tension = np.linalg.eigvalsh(_relaxed_stress(gradient, sheet))
    values = (np.sqrt(1.0 + 2.0 * major), np.sqrt(1.0 + 2.0 * minor), tension, lateral)
    state = zone_state(major, minor, sheet.poisson)
    return ZoneFields(*(np.full(shape, value) for value in (*values, state)))


def _relaxed_stress(gradient: np.ndarray, sheet: Sheet) -> np.ndarray:
    """2nd Piola stress (2, 2) MPa of the relaxed membrane (Pipkin 1986) for a deformation gradient (3,
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
