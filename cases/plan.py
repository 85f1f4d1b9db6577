"""`wrinkle plan`: what a scene calls for and what it will cost, from cheap calculations, without the expensive solve.

mesh     second order: the energy of the tension field on two coarse meshes gives the error on any mesh; wrinkles
         need `PER_WRINKLE` nodes each
steps    of relaxation on all nested meshes, from those of a pilot run on coarse ones (`pilot`)
seconds  the pilot's, in proportion to the work; what steps and examinations take of it follows from the rate of the
         kernel, measured on this machine once and kept in the user's cache
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from cases import effects as effects_of_scene
from cases.boundary import grid_of, symmetry_of
from cases.methods import METHODS, MethodError, choose
from cases.pilot import Pilot, pilot
from cases.rates import rate
from cases.schema import LARGEST_NODES, SMALLEST_NODES, Scene
from cases.survey import NODES, Survey, survey
from fdsolver.grid import quality
from fdsolver.model import Model
from fdsolver.multilevel import level_nodes
from fdsolver.reduction import reduction
from fdsolver.spatial import MOST_NODES

PER_WRINKLE = 8.0
BESIDE = 1.3  # CPU seconds of a run's steps over those of the kernel's: masses, looks between blocks
BYTES_PER_COMPONENT = 8 * (
    5 + 4
)  # positions, velocities, forces, old and safe ones; masses and their inverses
BYTES_OF_CONSTANTS = {"none": 8 * 5, "linear": 8 * 16, "full": 8 * 17}
BYTES_OF_HOURGLASS = 8 * 3  # of a plate in its plane
BYTES_OF_TANGENT = 4000  # of a flat state, its factor and the vectors of its lowest eigenvalue
BYTES_OF_PROOF = 11_000  # of a bent state: tangent, factor and their pattern (5 000 to 20 000 nodes)
BASE_MB = 250.0  # interpreter, compiled kernels and libraries
LONGEST_CELL = 2.5  # ratio of a cell's sides beyond which checkerboards grew in published runs
MUCH_SLACK = 0.3


@dataclass(frozen=True)
class Plan:
    """What a run will be. nodes_for_accuracy, nodes_for_wrinkles : None where nothing asks for them.

    steps : on all nested meshes together.
    """

    method: str
    why: str
    effects: effects_of_scene.Effects
    nodes: int
    nodes_for_accuracy: int | None
    nodes_for_wrinkles: int | None
    wavelength_mm: float
    nodes_per_wrinkle: float
    steps: int
    cpu_seconds: float
    memory_MB: float
    warnings: tuple[str, ...]


def plan(scene: Scene, method: str = "auto", accuracy: float | None = None) -> Plan:
    """Plan a run. accuracy : relative error of the energy that is wanted.

    Raises MethodError for a method whose cost cannot be foretold, and as `choose`.
    """
    chosen, why = choose(scene, method)
    if chosen.model is None:
        known = [name for name, each in METHODS.items() if each.model is not None]
        raise MethodError(f"The cost of {chosen.name} is not foretold; it is of {', '.join(known)}.")
    found = survey(scene)
    wanted = None if accuracy is None else _nodes_for(scene, found, accuracy)
    waves = _nodes_for_wrinkles(scene, found)
    needed = [count for count in (wanted, waves if chosen.wrinkles else None) if count is not None]
    nodes = scene.mesh.nodes if accuracy is None else min(max([*needed, SMALLEST_NODES]), LARGEST_NODES)
    sized = replace(scene, mesh=scene.mesh.model_copy(update={"nodes": nodes}))
    model, decided = effects_of_scene.decide(sized, chosen.model())
    tolerance = scene.solver.tolerance or chosen.tolerance
    tried = pilot(sized, model, tolerance, BESIDE / rate(model))
    counts = _solved_nodes(sized, model)
    spacing = math.sqrt(_area(scene) / nodes)
    per_wrinkle = found.wrinkles.wavelength_mm / spacing
    return Plan(
        method=chosen.name,
        why=why or "asked for",
        effects=decided,
        nodes=nodes,
        nodes_for_accuracy=wanted,
        nodes_for_wrinkles=waves,
        wavelength_mm=found.wrinkles.wavelength_mm,
        nodes_per_wrinkle=per_wrinkle,
        steps=round(sum(tried.steps(counts))),
        cpu_seconds=tried.seconds(counts),
        memory_MB=_memory(counts, model, tried.examined > 0.0),
        warnings=tuple(_warnings(sized, found, tried, per_wrinkle if chosen.wrinkles else math.inf)),
    )


def _area(scene: Scene) -> float:
    return float(grid_of(scene)(NODES).zone_area.sum())


def _nodes_for(scene: Scene, found: Survey, accuracy: float) -> int:
    """Nodes for a relative error of the energy, by extrapolation of the two coarse meshes (second order)."""
    coarser = survey(scene, NODES // 4)
    energy = [float(each.solution.energy_N_mm["total"]) for each in (coarser, found)]
    counts = [each.solution.grid.nodes for each in (coarser, found)]
    if energy[1] == 0.0:
        return SMALLEST_NODES
    error = abs(energy[0] - energy[1]) / energy[1] / (counts[1] / counts[0] - 1.0)
    return min(math.ceil(counts[1] * error / accuracy), LARGEST_NODES)


def _nodes_for_wrinkles(scene: Scene, found: Survey) -> int | None:
    if math.isinf(found.wrinkles.wavelength_mm):
        return None
    return min(math.ceil(_area(scene) * (PER_WRINKLE / found.wrinkles.wavelength_mm) ** 2), LARGEST_NODES)


def _solved_nodes(scene: Scene, model: Model) -> list[int]:
    """Nodes that are solved for on every nested mesh, coarsest first: of a symmetric sheet those of its part."""
    counts = level_nodes(scene.mesh.nodes, scene.solver.levels)
    symmetry = symmetry_of(scene, model)
    if symmetry is None:
        return counts
    return [reduction(grid_of(scene)(count), symmetry).part.nodes for count in counts]


def _memory(counts: list[int], model: Model, examined: bool) -> float:
    nodes = counts[-1]
    per_node = model.components * BYTES_PER_COMPONENT + BYTES_OF_CONSTANTS[model.curvature]
    if model.bending and not model.out_of_plane:
        per_node += BYTES_OF_HOURGLASS
    if examined:
        per_node += BYTES_OF_TANGENT
    proved = 0
    if model.curvature != "none":
        proved = max((count for count in counts if count <= MOST_NODES), default=0)
    return BASE_MB + (nodes * per_node + proved * BYTES_OF_PROOF) / 2**20


def _warnings(scene: Scene, found: Survey, tried: Pilot, per_wrinkle: float) -> list[str]:
    warnings = []
    limit = found.solution.sheet.natural_width_limit
    largest = float(found.solution.zone.stretch_major.max())
    if largest > limit:
        warnings.append(
            f"the largest stretch, {largest:.3g}, is beyond {limit:.3g}, the material's natural width"
        )
    if found.slack > MUCH_SLACK:
        warnings.append(f"{100.0 * found.slack:.2g} % of the sheet is slack: its shape is not unique there")
    longest = quality(grid_of(scene)(scene.mesh.nodes)).largest_aspect
    if longest > LONGEST_CELL:
        warnings.append(f"cells up to {longest:.2g} times longer than wide: checkerboards grow on such cells")
    if per_wrinkle < effects_of_scene.NODES_PER_WRINKLE:
        warnings.append(
            f"{per_wrinkle:.2g} nodes per wrinkle do not resolve them: their number will be the mesh's"
        )
    if not found.converged:
        warnings.append("the coarse tension field did not converge: what follows from it is a guess")
    if not tried.finished:
        nodes = tried.levels[-1][0]
        warnings.append(
            f"a pilot run on {nodes} nodes did not converge: steps and seconds are at least these"
        )
    return warnings


def lines(found: Plan) -> list[str]:
    """The plan as lines of text."""
    text = [f"method    {found.method}: {found.why}"]
    text += [f"effect    {name} {'on' if e.on else 'off'}: {e.why}" for name, e in found.effects.items()]
    wave = (
        "nothing wrinkles"
        if math.isinf(found.wavelength_mm)
        else f"waves of about {found.wavelength_mm:.3g} mm"
    )
    text.append(f"wrinkles  {wave}, {found.nodes_per_wrinkle:.3g} nodes each")
    asked = {
        "the accuracy": found.nodes_for_accuracy,
        f"{PER_WRINKLE:g} nodes per wrinkle": found.nodes_for_wrinkles,
    }
    needs = [f"{count} for {what}" for what, count in asked.items() if count is not None]
    text.append(f"mesh      {found.nodes} nodes" + (f" (needed: {', '.join(needs)})" if needs else ""))
    text.append(
        f"cost      {found.steps} steps, {found.cpu_seconds:.2g} CPU seconds, {found.memory_MB:.0f} MB"
    )
    return text + [f"warning   {warning}" for warning in found.warnings]
