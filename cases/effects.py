"""Which effects a run computes, and why: decided from the scene and from cheap calculations, before the run.

The method fixes the model; "auto" leaves out only what the model permits and what makes no difference to it: the
out-of-plane component of a relaxed membrane under loads in the plane (its energy is convex), of the unrelaxed membrane
there (without a perturbation nothing leaves the plane), and of a plate that a coarse solve finds tense, or compressed
but stiff enough to stay flat; a plate in its plane does not bend. Loads in the plane alone do not make a plate planar,
and a missing perturbation does not either. `--method auto` chooses the model as well.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace

from cases.boundary import edges_of, grid_of, symmetry_of
from cases.schema import Scene
from cases.survey import COMPRESSED, loads_in_plane, stiffness_against_buckling, survey
from fdsolver.model import Model
from fdsolver.reduction import reduction
from fdsolver.symmetry import Symmetry, refuse_unsymmetric

JUSTIFIED, NOT_JUSTIFIED = "justified", "not justified"
NODES_PER_WRINKLE = 6.0
STIFF = 0.01  # lowest eigenvalue of the coarse flat plate from which finer meshes stay flat too (see fdsolver.planar)
STEEP = 0.2  # slope beyond which the normal of the flat sheet is not the sheet's: its square is 4 % of the curvature


class EffectError(ValueError):
    """An effect that cannot be left out, or a symmetry that the scene does not have; the message is one sentence."""


@dataclass(frozen=True)
class Effect:
    """One effect of a run, as in result.json. size : the number that `why` or the audit is about, dimensionless.

    justified : "justified" or "not justified" once a run was audited; None before, and where nothing is left out.
    """

    on: bool
    why: str
    size: float | None = None
    justified: str | None = None


Effects = dict[str, Effect]


def as_document(effects: Mapping[str, Effect]) -> dict[str, dict[str, object]]:
    """The effects in the form of result.json."""
    return {name: asdict(effect) for name, effect in effects.items()}


def not_justified(effects: Effects) -> list[str]:
    """Names of the effects that should not have been left out."""
    return [name for name, effect in effects.items() if effect.justified == NOT_JUSTIFIED]


def of_method(name: str, bending: bool, kinematics: str = "finite rotations and strains") -> Effects:
    """The effects of a method whose model is fixed."""
    why = f"the model of {name}"
    return {
        "out_of_plane": Effect(True, why),
        "bending": Effect(bending, why),
        "strain_gradient": Effect(bending, why),
        "kinematics": Effect(True, kinematics),
    }


def decide(scene: Scene, model: Model) -> tuple[Model, Effects]:
    """The model with what the scene leaves out of it, and the reasons.

    Raises EffectError for an effect that cannot be left out here, and for a symmetry that the loads do not have.
    """
    asked = scene.effects
    out_of_plane = _out_of_plane(scene, model)
    plate = model.bending and asked.bending != "off"
    bending = Effect(model.bending, f"the model of {model.name}")
    if not plate and model.bending:
        bending = Effect(False, "the scene leaves it out")
    elif plate and not out_of_plane.on:
        bending = Effect(False, "a sheet in its plane does not bend")
    curved = bending.on
    gradient = Effect(curved, f"the model of {model.name}" if curved else "no curvature carries energy")
    moderate = asked.kinematics == "moderate"
    if curved and asked.strain_gradient == "off":
        gradient = Effect(False, "the scene leaves it out: the normal of the flat sheet")
    elif curved and moderate:
        gradient = Effect(False, "moderate rotations have no such effect")
    if moderate or (curved and not gradient.on):
        key = "effects.kinematics = 'moderate'" if moderate else "effects.strain_gradient = 'off'"
        _refuse_steep(scene, key)
    words = "moderate rotations (Foeppl and von Karman)" if moderate else "finite rotations and strains"
    effects = {
        "out_of_plane": out_of_plane,
        "bending": bending,
        "strain_gradient": gradient,
        "kinematics": Effect(not moderate, words),
    }
    chosen = replace(
        model,
        out_of_plane=out_of_plane.on,
        bending=plate,
        buckles=model.buckles and plate,
        strain_gradient=gradient.on or not curved,
        moderate=moderate,
    )
    if (symmetry := symmetry_of(scene, chosen)) is not None:
        effects["symmetry"] = _symmetry(scene, symmetry)
    return chosen, effects


def _symmetry(scene: Scene, symmetry: Symmetry) -> Effect:
    """The part of the sheet that is left out. Raises EffectError where mesh or loads do not have the symmetry."""
    grid = grid_of(scene)(scene.mesh.nodes)
    if not scene.symmetry.asked:
        why = f"axisymmetric loads and a convex energy: one of {grid.ni} rays of nodes is solved"
        return Effect(False, why, 0.0)
    asked = f"symmetry.reduce = {scene.symmetry.reduce!r}"
    if grid.nodes > 1.2 * scene.mesh.nodes:
        raise EffectError(f"{asked} needs at least {grid.nodes} nodes.")
    try:
        refuse_unsymmetric(symmetry, edges_of(scene), grid.shape, grid.length_mm)
        reduction(grid, symmetry)
    except ValueError as reason:
        raise EffectError(f"{asked}: {reason}.") from reason
    return Effect(False, f"the scene asks for {scene.symmetry.reduce}, {symmetry.parity}")


def _out_of_plane(scene: Scene, model: Model) -> Effect:
    asked = scene.effects.out_of_plane
    flat_loads = loads_in_plane(scene)
    if asked == "off":
        if not flat_loads:
            raise EffectError("effects.out_of_plane = 'off' with an edge that moves out of the plane.")
        return Effect(False, "the scene leaves it out", 0.0)
    if asked == "on":
        return Effect(True, "the scene asks for it")
    if not flat_loads:
        lift = max(abs(edge.move_mm[2]) for edge in scene.edges.values()) / scene.sheet.size_mm
        return Effect(True, f"an edge moves out of the plane by {lift:.3g} of the sheet's size", lift)
    if scene.start.source is not None:
        return Effect(True, "the state that the run starts from may leave the plane")
    if model.relaxed:
        return Effect(False, "loads in the plane, and relaxed compression pushes nothing out of it", 0.0)
    if not model.buckles:
        return Effect(False, "loads in the plane; without a perturbation a membrane stays there", 0.0)
    return _of_plate(scene)


def _of_plate(scene: Scene) -> Effect:
    """Whether a plate under loads in its plane may leave it."""
    found = survey(scene)
    if found.converged and found.least_tension > -COMPRESSED:
        why = f"no compression on a coarse mesh: the least stress is {found.least_tension:.2g} of the largest"
        return Effect(False, why, found.least_tension)
    compressed = found.wrinkled + found.slack
    part = f"{100.0 * compressed:.2g} % of the sheet wrinkled or slack on a coarse mesh"
    lowest = stiffness_against_buckling(scene)
    if lowest is not None and lowest > STIFF:
        why = f"{part}, but too stiff to buckle: lowest eigenvalue of a coarse flat plate {lowest:.2g}"
        return Effect(False, why, lowest)
    return Effect(True, f"{part}: it may buckle", compressed)


def _refuse_steep(scene: Scene, key: str) -> None:
    """Raise EffectError where the sheet turns too far for the normal of the flat sheet."""
    if loads_in_plane(scene):
        return
    slope = survey(scene).slope
    if slope > STEEP:
        raise EffectError(
            f"{key} with a slope of {slope:.2g}: above {STEEP:g} the normal of the flat sheet is not that of the"
            " sheet."
        )


def choose_method(scene: Scene) -> tuple[str, str]:
    """The method whose model the scene calls for, and why."""
    found = survey(scene)
    if not found.converged:
        return "koiter", "auto chose koiter: a coarse tension field did not converge."
    energy = float(found.solution.energy_N_mm["total"])
    if energy == 0.0:
        return "koiter", "auto chose koiter: nothing is strained, so nothing says that the sheet wrinkles."
    if loads_in_plane(scene) and not _of_plate(scene).on:
        return (
            "koiter",
            "auto chose koiter: the sheet stays flat, where a plate costs no more than a membrane.",
        )
    if found.wrinkles.share == 0.0:
        return (
            "tension-field",
            "auto chose tension-field: the sheet is tense everywhere, bending changes nothing.",
        )
    spacing = math.sqrt(float(grid_of(scene)(scene.mesh.nodes).zone_area.mean()))
    per_wrinkle = found.wrinkles.wavelength_mm / spacing
    expected = (
        f"{100.0 * found.wrinkled:.2g} % wrinkled, waves of about {found.wrinkles.wavelength_mm:.3g} mm,"
        f" {per_wrinkle:.2g} nodes each, {found.wrinkles.energy_N_mm / energy:.1e} of the energy"
    )
    if per_wrinkle < NODES_PER_WRINKLE:
        return (
            "tension-field",
            f"auto chose tension-field: the mesh cannot resolve the wrinkles ({expected}).",
        )
    return "koiter", f"auto chose koiter: the mesh resolves the wrinkles ({expected})."
