"""Which effects a run computes, and why: decided from the scene and from cheap calculations, before the run.

The method fixes the model; "auto" leaves out only what the model permits and what makes no difference to it: the
out-of-plane component of a relaxed membrane under loads in the plane (its energy is convex), of the unrelaxed membrane
there (without a perturbation nothing leaves the plane), and of a plate that a coarse solve finds tense. Loads in
the plane alone do not make a plate planar, and a missing perturbation does not either. `--method auto` chooses the
model as well.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace

from cases.boundary import edges_of, grid_of, symmetry_of
from cases.schema import Scene
from cases.survey import Survey, loads_in_plane, survey
from fdsolver.model import Model
from fdsolver.symmetry import reduction, refuse_unsymmetric

JUSTIFIED, NOT_JUSTIFIED = "justified", "not justified"
NODES_PER_WRINKLE = 6.0
COMPRESSED = (
    -1e-5
)  # minor stress over the largest: what a coarse solve may show where there is no compression
# Share of the energy that wrinkles are foretold to hold, below which they change no reported quantity by 0.1 %: full
# runs of five scenes found 1.0 to 6 times what was foretold.
NEGLIGIBLE = 1.5e-4
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
    bending = Effect(model.bending, f"the model of {model.name}")
    if model.bending and asked.bending == "off":
        bending = Effect(False, "the scene leaves it out")
    curved = bending.on and out_of_plane.on
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
    symmetry = symmetry_of(scene)
    if symmetry is not None:
        try:
            grid = grid_of(scene)(scene.mesh.nodes)
            if grid.nodes > 1.2 * scene.mesh.nodes:
                raise EffectError(
                    f"symmetry.reduce = {scene.symmetry.reduce!r} needs at least {grid.nodes} nodes."
                )
            refuse_unsymmetric(symmetry, edges_of(scene), grid.shape, grid.length_mm)
            reduction(grid, symmetry)
        except EffectError:
            raise
        except ValueError as reason:
            raise EffectError(f"symmetry.reduce = {scene.symmetry.reduce!r}: {reason}.") from reason
        effects["symmetry"] = Effect(False, f"the scene asks for {scene.symmetry.reduce}, {symmetry.parity}")
    chosen = replace(
        model,
        out_of_plane=out_of_plane.on,
        bending=bending.on,
        buckles=model.buckles and bending.on,
        strain_gradient=gradient.on or not curved,
        moderate=moderate,
    )
    return chosen, effects


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
    found = survey(scene)
    if found.converged and found.least_tension > COMPRESSED:
        why = f"no compression on a coarse mesh: the least stress is {found.least_tension:.2g} of the largest"
        return Effect(False, why, found.least_tension)
    compressed = found.wrinkled + found.slack
    why = f"{100.0 * compressed:.2g} % of the sheet wrinkled or slack on a coarse mesh: it may buckle"
    return Effect(True, why, compressed)


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
    area = float(grid_of(scene)(scene.mesh.nodes).zone_area.mean())
    energy = max(float(found.solution.energy_N_mm["total"]), 1e-300)
    share = found.wrinkles.energy_N_mm / energy
    if not found.converged:
        return "koiter", "auto chose koiter: a coarse tension field did not converge."
    if found.solution.energy_N_mm["total"] == 0.0:
        return "koiter", "auto chose koiter: nothing is strained, so nothing says that the sheet wrinkles."
    if math.isinf(found.wrinkles.wavelength_mm):
        return (
            "tension-field",
            "auto chose tension-field: the sheet is tense everywhere, bending changes nothing.",
        )
    per_wrinkle = found.wrinkles.wavelength_mm / math.sqrt(area)
    expected = (
        f"{100.0 * found.wrinkled:.2g} % wrinkled, waves of about {found.wrinkles.wavelength_mm:.3g} mm,"
        f" {per_wrinkle:.2g} nodes each, {share:.1e} of the energy"
    )
    if per_wrinkle < NODES_PER_WRINKLE:
        return (
            "tension-field",
            f"auto chose tension-field: the mesh cannot resolve the wrinkles ({expected}).",
        )
    return "koiter", f"auto chose koiter: the mesh resolves the wrinkles ({expected})."


def bending_matters(found: Survey) -> bool:
    """Whether wrinkles hold enough of the energy to show in what is reported."""
    return found.wrinkles.energy_N_mm > NEGLIGIBLE * float(found.solution.energy_N_mm["total"])
