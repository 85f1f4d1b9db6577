"""The method `buckling`: a scene as input of the finite elements, and their factors and modes as a solution."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.boundary import sheet_of
from cases.methods import tension_length_mm
from cases.schema import AnnulusSheet, Edge, HoleSheet, Scene
from cases.unstructured import FiniteElementMesh, FiniteElementSolution
from fdsolver.result import Reaction, Status, ZoneFields

if TYPE_CHECKING:
    from femref.buckle import Factors
    from femref.parity import Parities
    from femref.prestress import Movement, PlaneState
    from femref.sheet_mesh import PlateMaterial, SheetMesh

FACTORS = 10
# Successive factors that are nearer than this part of each other are reported as a pair.
PAIR = 0.01
COARSER = 4  # vertices of the mesh over those of the coarse one beneath it
_SUPPORTED = ("pinned", "clamped")


@dataclass(frozen=True)
class Level:
    """One mesh: what was found on it, and what it took."""

    sheet: SheetMesh
    state: PlaneState
    factors: Factors
    modes: np.ndarray
    unknowns: int
    seconds: Mapping[str, float]


def unfit(scene: Scene) -> str | None:
    """Why the scene has no buckling load, as a clause; None if it has one."""
    held = {name: edge for name, edge in scene.edges.items() if edge.support in _SUPPORTED}
    if any(edge.move_mm[2] != 0.0 for edge in held.values()):
        return (
            f"an edge of the scene {scene.name} moves along z, and a sheet buckles under a load in its plane"
        )
    if nominal_displacement_mm(scene) == 0.0:
        return f"no supported edge of the scene {scene.name} moves against another, so there is no load to multiply"
    return None


def default_vertices(scene: Scene) -> int:
    """Vertices for factors good to about 0.1 % on the built-in scenes."""
    return 3000 if isinstance(scene.sheet, HoleSheet) else 2000


def sheet_mesh(scene: Scene, vertices: int, rectangles: bool = False) -> SheetMesh:
    """The finite-element mesh of a scene's sheet."""
    from femref import meshes

    sheet = scene.sheet
    if isinstance(sheet, AnnulusSheet):
        return meshes.annulus(sheet.inner_radius_mm, sheet.outer_radius_mm, vertices, grading=0.5)
    if isinstance(sheet, HoleSheet):
        return meshes.rectangle_with_hole(sheet.width_mm, sheet.height_mm, sheet.hole_radius_mm, vertices)
    cells = "rectangles" if rectangles else "triangles"
    return meshes.rectangle(
        sheet.width_mm, sheet.height_mm, vertices, grading=0.7, aspect=_aspect(scene), cells=cells
    )


def plate_material(scene: Scene) -> PlateMaterial:
    """Material and thickness of a scene."""
    from femref.sheet_mesh import PlateMaterial

    return PlateMaterial(scene.material.young_MPa, scene.material.poisson, scene.sheet.thickness_mm)


def supports_of(scene: Scene) -> dict[str, str]:
    """Edge name -> support."""
    return {name: edge.support for name, edge in scene.edges.items()}


def movements_of(scene: Scene, finite: bool) -> dict[str, Movement]:
    """How the supported edges move at a multiple of the load: grown, turned, moved; turned by a finite angle or not."""
    return {name: _movement(edge, finite) for name, edge in scene.edges.items() if edge.support in _SUPPORTED}


def _movement(edge: Edge, finite: bool) -> Movement:
    shift, angle = np.array(edge.move_mm[:2])[:, None], math.radians(edge.rotate_deg)

    def movement(position: np.ndarray, load: float) -> np.ndarray:
        radius = np.linalg.norm(position, axis=0)
        grown = load * edge.grow_mm * position / np.where(radius > 0.0, radius, 1.0)
        turned = np.stack([-position[1], position[0]])
        if not finite:
            return grown + load * (angle * turned + shift)
        x, y = position + grown
        c, s = math.cos(load * angle), math.sin(load * angle)
        return np.stack([c * x - s * y, s * x + c * y]) - position + load * shift

    return movement


def nominal_displacement_mm(scene: Scene) -> float:
    """Largest displacement of one supported edge against another, mm."""
    held = [edge for edge in scene.edges.values() if edge.support in _SUPPORTED]
    sheet = scene.sheet
    arm = sheet.inner_radius_mm if isinstance(sheet, AnnulusSheet) else sheet.size_mm / 2.0
    return max(
        (
            math.dist(one.move_mm, other.move_mm)
            + abs(one.grow_mm - other.grow_mm)
            + arm * math.radians(abs(one.rotate_deg - other.rotate_deg))
            for one, other in combinations(held, 2)
        ),
        default=0.0,
    )


def solve_buckling(scene: Scene, threads: int, seed: int) -> FiniteElementSolution:
    """Critical factors and modes of a scene on its mesh and on one of a quarter of its vertices.

    Raises NoBuckling, NoPrestress and NotCertified of `femref`.
    """
    started, started_cpu = time.perf_counter(), time.process_time()
    vertices = scene.mesh.vertices or default_vertices(scene)
    coarse = solve_level(scene, max(vertices // COARSER, 100), None)
    fine = solve_level(scene, vertices, coarse.factors.factor)
    from femref.parity import parities

    found = parities(fine.sheet.mesh, fine.factors.factor, fine.modes)
    count = _reported(fine.factors.factor)
    critical = critical_entries(scene, fine.factors.factor, found)[:count]
    lowest = float(fine.factors.factor[0])
    assert scene.solver.tolerance is not None, "the runner resolves the tolerance"
    status = Status.CONVERGED if fine.factors.residual <= scene.solver.tolerance else Status.STALLED
    return FiniteElementSolution(
        method="buckling",
        status=status,
        message=status.sentence,
        grid=FiniteElementMesh(scene.sheet.shape, fine.sheet.positions_mm, fine.sheet.cells),
        sheet=sheet_of(scene),
        r=np.column_stack([fine.sheet.positions_mm + fine.state.displacement_mm, np.zeros(len(fine.modes))]),
        steps=coarse.factors.factorisations + fine.factors.factorisations,
        force_evaluations=0,
        residual=fine.factors.residual,
        seconds=time.perf_counter() - started,
        cpu_seconds=time.process_time() - started_cpu,
        seconds_compile=0.0,
        energy_N_mm={"total": fine.state.energy_N_mm, "membrane": fine.state.energy_N_mm, "bending": 0.0},
        reactions={name: _reaction(values) for name, values in fine.state.reaction_N.items()},
        zone=zone_fields(scene, fine.state),
        history={"factor": fine.factors.factor[:count]},
        hourglass={},
        stability={
            "stable": lowest > 1.0,
            "how": "the flat sheet under its load: lowest is the smallest buckling factor, below 1 if unstable; the"
            " inertia of the stiffness certifies that no factor is missing",
            "lowest": lowest,
        },
        warnings=_warnings(scene, lowest),
        levels=tuple(_level_entry(level) for level in (coarse, fine)),
        threads=threads,
        seed=seed,
        modes=(found.modes / np.abs(found.modes).max(axis=0)).T[:count],
        critical=critical,
        errors=_errors(coarse.factors.factor, fine.factors.factor[:count]),
    )


def solve_level(scene: Scene, vertices: int, known: np.ndarray | None) -> Level:
    """Factors on one mesh. known : factors of a coarser mesh, which say how far to look."""
    from femref.buckle import guess_of, shift_after, smallest_factors
    from femref.plate_matrices import PlateSpace, bending_stiffness, geometric_stiffness
    from femref.prestress import PlaneProblem, finite_state, linear_state

    element, finite = scene.solver.element, scene.solver.prestress == "finite"
    sheet, material = sheet_mesh(scene, vertices, element == "bogner-fox-schmit"), plate_material(scene)
    space = PlateSpace(sheet, material, supports_of(scene), element)
    marks = [time.process_time()]
    problem = PlaneProblem(sheet, material, movements_of(scene, finite), space.points)
    state = finite_state(problem) if finite else linear_state(problem)
    marks.append(time.process_time())
    bending, geometric = bending_stiffness(space), geometric_stiffness(space, state.stress)
    marks.append(time.process_time())
    guess = guess_of(space, state.stress) if known is None else shift_after(known, FACTORS)
    factors = smallest_factors(bending, geometric, FACTORS, guess)
    seconds = {"prestress": marks[1] - marks[0], "assemble": marks[2] - marks[1], **factors.seconds}
    return Level(sheet, state, factors, space.vertex_heights(factors.shape), bending.shape[0], seconds)


def critical_entries(scene: Scene, factor: np.ndarray, found: Parities) -> tuple[dict[str, Any], ...]:
    """One entry per factor for `buckling.critical`."""
    image, displacement = found.clear(), nominal_displacement_mm(scene)
    entries = []
    for k, (value, pair) in enumerate(zip(factor, pair_numbers(factor), strict=True)):
        correlation = {name: float(values[k]) for name, values in found.correlation.items()}
        entries.append(
            {
                "factor": float(value),
                "parity": None if image is None else _word(correlation[image]),
                "pair": pair,
                "displacement_mm": float(value) * displacement,
                "strain": float(value) * displacement / tension_length_mm(scene),
                "about": image,
                "correlation": correlation,
            }
        )
    return tuple(entries)


def pair_numbers(factor: Sequence[float] | np.ndarray) -> list[int | None]:
    """1, 2, ... for both members of each near-degenerate pair of ascending factors, None for single ones."""
    numbers: list[int | None] = [None] * len(factor)
    count, k = 0, 0
    while k + 1 < len(factor):
        if factor[k + 1] - factor[k] < PAIR * factor[k + 1]:
            count += 1
            numbers[k] = numbers[k + 1] = count
            k += 1
        k += 1
    return numbers


def _reported(factor: np.ndarray) -> int:
    """Ten factors, or eleven if the tenth has its partner after it."""
    numbers = pair_numbers(factor)
    more = len(factor) > FACTORS and numbers[FACTORS] is not None and numbers[FACTORS] == numbers[FACTORS - 1]
    return FACTORS + more


def _word(correlation: float) -> str:
    return "symmetric" if correlation > 0.0 else "antisymmetric"


def zone_fields(scene: Scene, state: PlaneState) -> ZoneFields:
    """Principal stretches and stresses of each cell, means over it; the linear theory's stretch is 1 + strain."""
    gradient = state.gradient.mean(axis=-1).transpose(2, 0, 1)
    strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
    finite = scene.solver.prestress == "finite"
    if finite:
        strain = strain + 0.5 * gradient.transpose(0, 2, 1) @ gradient
    minor, major = np.linalg.eigvalsh(strain).T
    stress_minor, stress_major = (
        scene.material.young_MPa * np.linalg.eigvalsh(state.stress.mean(axis=-1).transpose(2, 0, 1)).T
    )
    tense = (major > 0.0) & (minor > -scene.material.poisson * major)
    zone_state = np.where(tense, 2, np.where(major > 0.0, 1, 0)).astype(np.int8)
    stretches = [np.sqrt(1.0 + 2.0 * e) if finite else 1.0 + e for e in (major, minor)]
    return ZoneFields(stretches[0], stretches[1], stress_major, stress_minor, zone_state)


def _reaction(values: tuple[float, float, float]) -> Reaction:
    fx, fy, moment = values
    return Reaction(np.array([fx, fy, 0.0]), np.array([0.0, 0.0, moment]))


def _aspect(scene: Scene) -> float:
    """Wrinkles run along a pull: cells twice as long there."""
    held = {name: edge.move_mm for name, edge in scene.edges.items() if edge.support in _SUPPORTED}
    if set(held) == {"bottom", "top"}:
        across, along = (abs(held["top"][k] - held["bottom"][k]) for k in range(2))
        return 2.0 if along > across else 1.0
    if set(held) == {"left", "right"}:
        along, across = (abs(held["right"][k] - held["left"][k]) for k in range(2))
        return 0.5 if along > across else 1.0
    return 1.0


def _level_entry(level: Level) -> dict[str, Any]:
    return {
        "nodes": level.sheet.mesh.nvertices,
        "unknowns": level.unknowns,
        "factor": float(level.factors.factor[0]),
        "seconds": level.seconds,
        "factor_entries": level.factors.entries,
    }


def _errors(coarse: np.ndarray, fine: np.ndarray) -> tuple[dict[str, Any], ...]:
    """The change from the coarse mesh: the fine one is nearer than that as long as the method converges at all."""
    return tuple(
        {
            "quantity": f"buckling factor {k + 1}",
            "value": float(value),
            "discretisation": abs(float(value) - float(coarse[k])),
            "iteration": None,
            "order": None,
            "how": "change from a mesh of a quarter of the vertices",
        }
        for k, value in enumerate(fine)
        if k < len(coarse)
    )


def _warnings(scene: Scene, lowest: float) -> tuple[str, ...]:
    said = []
    if isinstance(scene.sheet, AnnulusSheet):
        said.append(
            "circles are polygons here: factors carry their error, which falls with the square of the mesh size"
        )
    if lowest < 0.1 and scene.solver.prestress == "linear":
        said.append(
            f"the load is {1.0 / lowest:.3g} times the critical one: the factors say when wrinkles appear, not how they"
            " look at the load"
        )
    return tuple(said)
