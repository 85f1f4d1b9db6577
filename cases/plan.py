"""`wrinkle plan`: what a scene calls for and what it will cost, from cheap calculations, without the expensive solve.

mesh     second order: the energy of the tension field on two coarse meshes gives the error on any mesh; wrinkles
         need `PER_WRINKLE` nodes each
steps    of relaxation, in proportion to the nodes along the sheet and to the digits asked for
seconds  node-steps over the rate of the kernel, measured on this machine once and kept in the user's cache
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass, replace
from pathlib import Path

from cases import effects as effects_of_scene
from cases.boundary import grid_of, symmetry_of
from cases.methods import METHODS, MethodError, choose
from cases.schema import LARGEST_NODES, SMALLEST_NODES, Scene
from cases.survey import NODES, Survey, survey
from fdsolver.grid import quality
from fdsolver.meshes import annulus
from fdsolver.model import Model
from fdsolver.multilevel import level_nodes
from fdsolver.symmetry import reduction

PER_WRINKLE = 8.0
STEPS = 25.0  # of a plate, per square root of the nodes, for six digits: the strip took 4 000 to 5 000 on 36 000 nodes
DIGITS = 6.0
BYTES_PER_COMPONENT = 8 * (
    5 + 4
)  # positions, velocities, forces, old and safe ones; masses and their inverses
BYTES_OF_CONSTANTS = {"none": 8 * 5, "linear": 8 * 16, "full": 8 * 17}
BASE_MB = 250.0  # interpreter, compiled kernels and libraries
LONGEST_CELL = 2.5  # ratio of a cell's sides beyond which checkerboards grew in published runs
MUCH_SLACK = 0.3


@dataclass(frozen=True)
class Plan:
    """What a run will be. nodes_for_accuracy, nodes_for_wrinkles : None where nothing asks for them."""

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
    steps, node_steps = _steps(sized, found, model, tolerance)
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
        steps=steps,
        cpu_seconds=node_steps / rate(model),
        memory_MB=_memory(sized, model),
        warnings=tuple(_warnings(sized, found, per_wrinkle if chosen.wrinkles else math.inf)),
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


def _steps(scene: Scene, found: Survey, model: Model, tolerance: float) -> tuple[int, float]:
    """Steps on the last mesh, and node-steps on all of them."""
    digits = math.log10(1.0 / tolerance)
    if model.buckles and model.out_of_plane:
        per_root = STEPS * digits / DIGITS
    else:
        coarse = found.solution
        reached = math.log10(1.0 / min(max(coarse.residual, 1e-12), 0.1))
        per_root = max(coarse.steps, 100) / math.sqrt(coarse.grid.nodes) * digits / reached
    counts = level_nodes(scene.mesh.nodes, scene.solver.levels)
    share = _solved_share(scene)
    steps = per_root * math.sqrt(scene.mesh.nodes)
    return round(steps), sum(share * count * per_root * math.sqrt(count) for count in counts)


def _solved_share(scene: Scene) -> float:
    """Nodes that are solved for over those of the whole sheet."""
    symmetry = symmetry_of(scene)
    if symmetry is None:
        return 1.0
    grid = grid_of(scene)(scene.mesh.nodes)
    return reduction(grid, symmetry).part.nodes / grid.nodes


def _memory(scene: Scene, model: Model) -> float:
    per_node = model.components * BYTES_PER_COMPONENT + BYTES_OF_CONSTANTS[model.curvature]
    return BASE_MB + scene.mesh.nodes * _solved_share(scene) * per_node / 2**20


def _warnings(scene: Scene, found: Survey, per_wrinkle: float) -> list[str]:
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
    return warnings


def rate(model: Model) -> float:
    """Node-steps per CPU second of a model's kernel on this machine, from the user's cache or measured now."""
    key = f"{model.law.__name__} {model.components} {model.curvature} {'moderate' if model.moderate else 'finite'}"
    path = _cache_file()
    known = _read(path)
    if key not in known:
        from fdsolver.bench import node_steps_per_second

        known[key] = node_steps_per_second(model, annulus(62.5, 250.0, 10_000), 1, 0.5)
        _write(path, known)
    return known[key]


def _cache_file() -> Path:
    from fdsolver.compile_cache import folder

    return Path(os.environ.get("NUMBA_CACHE_DIR") or folder()) / "rates.json"


def _read(path: Path) -> dict[str, float]:
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        return {str(name): float(value) for name, value in stored.items() if float(value) > 0.0}
    except (OSError, ValueError, AttributeError, TypeError):
        return {}


def _write(path: Path, rates: dict[str, float]) -> None:
    """Keep the rates; a cache that cannot be written is measured again next time."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        new = path.with_suffix(f".{os.getpid()}")
        new.write_text(json.dumps(rates), encoding="utf-8")
        new.replace(path)
    except OSError:
        return


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
