"""The method `buckling`: factors and modes of a scene on two meshes, as a solution."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.boundary import sheet_of
from cases.finite_elements import (
    default_vertices,
    movements_of,
    nominal_displacement_mm,
    plate_material,
    reactions_of,
    sheet_mesh,
    supports_of,
    zone_fields,
)
from cases.schema import AnnulusSheet, Scene
from cases.survey import tension_length_mm
from cases.unstructured import FiniteElementMesh, FiniteElementSolution
from fdsolver.result import Status

if TYPE_CHECKING:
    from femref.buckle import Factors
    from femref.parity import Parities
    from femref.prestress import PlaneState
    from femref.sheet_mesh import SheetMesh

FACTORS = 10
# Successive factors that are nearer than this part of each other are reported as a pair.
PAIR = 0.01
COARSER = 4  # vertices of the mesh over those of the coarse one beneath it


@dataclass(frozen=True)
class Level:
    """One mesh: what was found on it, and what it took."""

    sheet: SheetMesh
    state: PlaneState
    factors: Factors
    modes: np.ndarray
    unknowns: int
    seconds: Mapping[str, float]


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
        reactions=reactions_of(fine.state),
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
        times = float(f"{1.0 / lowest:.3g}")  # three digits, but no power of ten
        said.append(
            f"the load is {times:.12g} times the critical one: the factors say when wrinkles appear, not how they look"
            " at the load"
        )
    return tuple(said)
