"""From the equilibria of `postbuckling` to the solution that users see: the whole sheet, measures and their errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.bicubic import sample_field, stored_derivatives, stored_mesh
from cases.boundary import sheet_of
from cases.envelope import envelope
from cases.mesh_sequence import mesh_limit
from cases.probe import measure_section
from cases.quantities import INSIGNIFICANT
from cases.schema import Scene
from cases.unstructured import FiniteElementSolution
from fdsolver.result import Reaction, Status, ZoneFields

if TYPE_CHECKING:
    from femref.assembly import SheetEnergy
    from femref.postbuckle import Postbuckled


@dataclass(frozen=True)
class Whole:
    """A state of the whole sheet, in the scene's place.

    energy : its functional. q : (ni, nj, 4, 3) mm. parts : membrane and bending energy, N mm. gained_N_mm : energy of
    the flat sheet on the same mesh less that of this state; None without a flat state.
    """

    energy: SheetEnergy
    q: np.ndarray
    parts: np.ndarray
    gained_N_mm: float | None
    level: Postbuckled


def whole_of(level: Postbuckled, rigid_move_mm: np.ndarray) -> Whole:
    """Unfold the planes of symmetry and give the sheet its rigid motion."""
    from dataclasses import replace

    from femref.held import unfold

    problem, flat = level.problem, level.flat
    mesh, q = unfold(problem.mesh, level.state.q, problem.mirrors)
    energy = replace(problem, mesh=mesh).energy()
    gained = None
    if flat is not None:
        # Differences on one mesh: the parts are summed over the same elements.
        copies = (2 if problem.mirrors.x else 1) * (2 if problem.mirrors.y else 1)
        gained = copies * (flat.energy_N_mm - problem.energy().value(level.state.q))
    parts = energy.energy(q)
    q = q.copy()
    q[:, :, 0] += rigid_move_mm
    return Whole(energy, q, parts, gained, level)


def measured(scene: Scene, whole: Whole) -> dict[str, float]:
    """What is compared between meshes and methods, by keys of result.json: energies, reactions, sections."""
    membrane, bending = (float(part) for part in whole.parts)
    found = {"energy_N_mm.total": membrane + bending, "energy_N_mm.bending": bending}
    if whole.gained_N_mm is not None:
        found["energy_N_mm.gained"] = whole.gained_N_mm
    reactions = reactions_of(scene, whole)
    largest = max((float(np.abs(reaction.force_N).max()) for reaction in reactions.values()), default=0.0)
    for name, reaction in reactions.items():
        for axis, force in zip("xyz", reaction.force_N.tolist(), strict=True):
            if abs(force) > INSIGNIFICANT * largest:
                found[f"reactions.{name}.force_N.{axis}"] = force
    for name, line in scene.sections.items():
        section = sample_field(whole.energy.mesh, whole.q, line)
        measures = measure_section(section, scene.sheet.thickness_mm)
        for key in ("amplitude_mm", "rms_mm", "wavelength_mm"):
            if value := getattr(measures, key):
                found[f"sections.{name}.{key}"] = value
        if measures.amplitude_mm > 0.0:
            found[f"sections.{name}.envelope_mm"] = float(envelope(section.z).max())
    return found


def reactions_of(scene: Scene, whole: Whole) -> dict[str, Reaction]:
    """What the supported edges exert on the sheet, about the origin."""
    from femref.reactions import reactions

    supported = [name for name, edge in scene.edges.items() if edge.support != "free"]
    return {
        name: Reaction(force, moment)
        for name, (force, moment) in reactions(whole.energy, whole.q, supported).items()
    }


def errors_of(levels: Sequence[Whole], values: Sequence[Mapping[str, float]]) -> tuple[dict[str, Any], ...]:
    """One entry per quantity: the error of the finest mesh's value, from the sequence of meshes.

    values : what was `measured` on each.
    """
    elements = [math.prod(len(axis) - 1 for axis in whole.energy.mesh.breaks) for whole in levels]
    entries = []
    for name, finest in values[-1].items():
        column = [level[name] for level in values if name in level]
        if len(column) < 2 or len(column) < len(levels):
            continue
        entries.append({"quantity": name, "value": finest, "iteration": None, **_error(elements, column)})
    return tuple(entries)


def _error(elements: Sequence[int], values: Sequence[float]) -> dict[str, Any]:
    if len(values) < 3:
        return {
            "discretisation": abs(values[-1] - values[-2]),
            "order": None,
            "how": "change from the coarser mesh",
        }
    limit = mesh_limit(elements, values)
    if limit.refused:
        how = f"range on the last three meshes: {limit.refused}"
        return {"discretisation": limit.band, "order": None, "how": how}
    how = "1.25 times the distance from the limit of three meshes"
    return {"discretisation": limit.error_of_finest, "order": limit.order, "how": how}


def zone_fields(scene: Scene, whole: Whole) -> ZoneFields:
    """Principal stretches and stresses of each element's mean Green strain, (m,) in the order of the cells."""
    from femref.strain import mean_strain

    strain = mean_strain(whole.energy.mesh, whole.q).reshape(-1, 2, 2)
    minor, major = np.linalg.eigvalsh(strain).T
    sheet = sheet_of(scene)
    nu = sheet.poisson
    factor = sheet.young_MPa / (1.0 - nu**2)
    tense = (major > 0.0) & (minor > -nu * major)
    state = np.where(tense, 2, np.where(major > 0.0, 1, 0)).astype(np.int8)
    stress = [factor * (first + nu * second) for first, second in ((major, minor), (minor, major))]
    return ZoneFields(np.sqrt(1.0 + 2.0 * major), np.sqrt(1.0 + 2.0 * minor), stress[0], stress[1], state)


def solution_of(
    scene: Scene, levels: Sequence[Whole], status: Status, stability: Mapping[str, object], steps: int
) -> FiniteElementSolution:
    """The solution of the finest mesh; message, times, threads and seed are the caller's."""
    whole, values = levels[-1], [measured(scene, each) for each in levels]
    mesh, state = whole.energy.mesh, whole.level.state
    grid = stored_mesh(mesh, scene.sheet.shape)
    membrane, bending = (float(part) for part in whole.parts)
    energies = {"total": membrane + bending, "membrane": membrane, "bending": bending}
    if whole.gained_N_mm is not None:
        energies["gained"] = whole.gained_N_mm
    history = np.array(state.history, dtype=float).reshape(-1, 4).T
    return FiniteElementSolution(
        method="postbuckling",
        status=status,
        message=status.sentence,
        grid=grid,
        sheet=sheet_of(scene),
        r=np.ascontiguousarray(whole.q[:, :, 0].reshape(-1, 3)),
        steps=steps,
        force_evaluations=steps,
        residual=state.residual,
        seconds=0.0,
        cpu_seconds=0.0,
        seconds_compile=0.0,
        energy_N_mm=energies,
        reactions=reactions_of(scene, whole),
        zone=zone_fields(scene, whole),
        history=dict(zip(("energy", "residual", "shift", "part_of_step"), history, strict=True)),
        hourglass={},
        stability=stability,
        warnings=_warnings(stability),
        levels=tuple(
            {**_level_entry(each), "quantities": found} for each, found in zip(levels, values, strict=True)
        ),
        threads=1,
        seed=0,
        modes=np.zeros((0, grid.nodes)),
        errors=errors_of(levels, values) if status is Status.CONVERGED else (),
        derivatives=stored_derivatives(mesh, whole.q),
    )


def _level_entry(whole: Whole) -> dict[str, float]:
    level = whole.level
    return {
        "nodes": math.prod(whole.energy.mesh.shape),
        "unknowns": int((~level.problem.held()).sum()),
        "steps": level.state.iterations,
        "residual": level.state.residual,
        "energy_N_mm": float(whole.parts.sum()),
        "bending_energy_N_mm": float(whole.parts[1]),
        "seconds": level.seconds,
    }


def _warnings(stability: Mapping[str, object]) -> tuple[str, ...]:
    if stability["stable"] is False:
        return (f"the state is unstable: its lowest eigenvalue is {stability['lowest']:.2g} N/mm^3",)
    return ()
