"""The methods: what each solves for, its defaults, and how it is called for a scene."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from cases import effects
from cases.boundary import grid_of, problem_of, settings_of, sheet_of
from cases.schema import Effects, Scene
from cases.survey import tension_length_mm
from cases.unstructured import AnySolution
from fdsolver.checkpoint import Checkpoint
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.relax import Progress
from fdsolver.result import Solution


class MethodError(ValueError):
    """A method that does not exist, does not fit the scene, or is still to come; the message is one
    sentence.
    """


@dataclass(frozen=True)
class Task:
    """One solve. scene : resolved, with its node count and tolerance."""

    scene: Scene
    seed: int
    threads: int
    progress: Callable[[Progress], None] | None
    checkpoint: Checkpoint | None


@dataclass(frozen=True)
class Method:
    """A way to solve a scene.

    name : on the command line. title : for tables. bending, wrinkles : whether its energy has bending,
        whether it resolves
    single wrinkles. tolerance : default residual. solve : Task -> solution. finite_elements : whether its nodes are
        the scene's `mesh.vertices`. model : what is relaxed, all effects on, where effects may be left out of it.
    """

    name: str
    title: str
    bending: bool
    wrinkles: bool
    tolerance: float
    solve: Callable[[Task], AnySolution]
    finite_elements: bool = False
    model: Callable[[], Model] | None = None


def _tension_field() -> Model:
    from tensionfield.relaxed import TENSION_FIELD

    return TENSION_FIELD


def _with_effects(model: Callable[[], Model]) -> Callable[[Task], Solution]:
    """The relaxation of a model without what the scene leaves out of it."""
    return lambda task: _relaxed_by(effects.decide(task.scene, model())[0], task)


def _published(task: Task) -> Solution:
    from cases.published import published_of

    return _relaxed_by(published_of(task.scene), task)


def _exact(task: Task) -> Solution:
    from cases.exact import solve_exact

    return solve_exact(task.scene, grid_of(task.scene)(task.scene.mesh.nodes))


def _buckling(task: Task) -> AnySolution:
    from cases.buckling import solve_buckling
    from femref.buckle import NoBuckling
    from femref.inertia import NotCertified
    from femref.prestress import NoPrestress

    try:
        return solve_buckling(task.scene, task.threads, task.seed)
    except (NoBuckling, NoPrestress, NotCertified) as reason:
        raise MethodError(str(reason)) from reason


def _postbuckling(task: Task) -> AnySolution:
    from cases.postbuckling import solve_postbuckling
    from femref.inertia import NotCertified

    try:
        return solve_postbuckling(task.scene, task.threads, task.seed, task.progress)
    except NotCertified as reason:
        raise MethodError(str(reason)) from reason


def _relaxation(name: str, title: str, plate: bool, tolerance: float, model: Callable[[], Model]) -> Method:
    return Method(name, title, plate, plate, tolerance, _with_effects(model), model=model)


METHODS = {
    method.name: method
    for method in (
        _relaxation("tension-field", "tension field (relaxed membrane)", False, 1e-8, _tension_field),
        _relaxation("membrane", "unrelaxed membrane", False, 1e-8, lambda: MEMBRANE),
        _relaxation("koiter", "Koiter plate", True, 1e-6, lambda: KOITER),
        Method("koiter-published", "Koiter plate, published scheme", True, True, 1e-8, _published),
        Method("buckling", "buckling factors (finite elements)", True, False, 1e-6, _buckling, True),
        Method(
            "postbuckling",
            "Koiter plate (finite elements)",
            True,
            True,
            1e-9,
            _postbuckling,
            finite_elements=True,
        ),
        Method("exact", "closed form", False, False, 1e-10, _exact),
    )
}
NAMES = ("auto", *METHODS)


def choose(scene: Scene, name: str) -> tuple[Method, str]:
    """The method of this name for a scene, and why (empty unless `auto` chose).

    Raises MethodError for a name that is unknown and for a scene that the method cannot solve.
    """
    why = ""
    if name == "auto":
        name, why = effects.choose_method(scene)
    if name not in METHODS:
        raise MethodError(f"There is no method {name!r}; there are auto, {', '.join(METHODS)}.")
    _refuse_options(scene, METHODS[name])
    if name != "exact" and (reason := why_unfit(scene, name)):
        raise MethodError(f"The method {name} cannot solve this: {reason}.")
    return METHODS[name], why


def methods_of(scene: Scene) -> tuple[str, ...]:
    """Names of the methods that can solve a scene now: `exact` only where a closed form exists, `buckling` only
    under a load in the plane, `postbuckling` only for a moderate number of wrinkles.
    """
    return tuple(
        name
        for name in METHODS
        if why_unfit(scene, name) is None and not (name == "postbuckling" and _too_many_wrinkles(scene))
    )


def _too_many_wrinkles(scene: Scene) -> bool:
    """Whether Newton's method would take far longer than the relaxation; it still solves the scene when asked."""
    from cases.postbuckling_scene import MOST_HALF_WAVES

    strain = nominal_strain(scene)
    return strain > 0.0 and scene.sheet.size_mm > MOST_HALF_WAVES * 0.5 * predicted_wavelength(scene, strain)


def why_unfit(scene: Scene, name: str) -> str | None:
    """Why the scene has no closed form, load, mesh of bicubic elements or ghost layer; None for a method that fits."""
    if name == "exact":
        from cases.exact import has_exact

        return None if has_exact(scene) else f"the scene {scene.name} has no closed form"
    if name == "buckling":
        from cases.finite_elements import unfit

        return unfit(scene)
    if name == "postbuckling":
        from cases import postbuckling_scene

        return postbuckling_scene.unfit(scene)
    if name == "koiter-published":
        from cases.published import unfit as unfit_for_published

        return unfit_for_published(scene)
    return None


def _relaxed_by(model: Model, task: Task) -> Solution:
    from fdsolver.multilevel import solve

    tolerance = task.scene.solver.tolerance
    assert tolerance is not None, "the runner resolves the tolerance"
    settings = settings_of(task.scene, tolerance, task.threads)
    problem = problem_of(task.scene, model, task.seed)
    return solve(problem, model, settings, progress=task.progress, checkpoint=task.checkpoint)


def _refuse_options(scene: Scene, method: Method) -> None:
    """Refuse keys whose meaning would otherwise silently be dropped. Raises MethodError."""
    from_mode = (scene.start.source or "").startswith("mode:")
    later = {
        f"symmetry.reduce = {scene.symmetry.reduce!r}": scene.symmetry.asked
        and method.name != "postbuckling"
        and method.model is None,
        f"start.from = {scene.start.source!r}": from_mode and method.name not in ("koiter", "postbuckling"),
        f"start.from = {scene.start.source!r} by {method.name}": method.name
        in ("exact", "buckling", "postbuckling")
        and scene.start.source is not None
        and not (from_mode and method.name == "postbuckling"),
        "solver.finish = 'on' on a part of a symmetric sheet": scene.solver.finish == "on"
        and scene.symmetry.asked
        and method.model is not None,
        "effects.kinematics = 'moderate'": scene.effects.kinematics == "moderate" and method.model is None,
        "effects.out_of_plane = 'off'": scene.effects.out_of_plane == "off" and method.model is None,
        "effects.bending = 'off' with a plate": scene.effects.bending == "off"
        and method.bending
        and method.model is None,
        "effects.strain_gradient = 'off' with a plate": scene.effects.strain_gradient == "off"
        and method.bending
        and method.model is None,
    }
    if from_mode and method.name == "koiter" and (reason := why_unfit(scene, "buckling")):
        raise MethodError(f"start.from = {scene.start.source!r} has no mode to start from: {reason}.")
    asked = [key for key, is_asked in later.items() if is_asked]
    if asked:
        raise MethodError(f"{' and '.join(asked)} cannot be solved by {method.name}.")
    if method.model is not None and (scene.symmetry.asked or scene.effects != Effects()):
        try:
            effects.decide(scene, method.model())
        except effects.EffectError as reason:
            raise MethodError(str(reason)) from reason


def predicted_wavelength(scene: Scene, strain: float) -> float:
    """Wavelength of tension wrinkles, mm: 2 sqrt(pi) (D / T)^(1/4) length^(1/2) with T = Y h strain (Cerda
    and Mahadevan 2003).
    """
    sheet = sheet_of(scene)
    stiffness_ratio = sheet.bending_stiffness_N_mm / (sheet.young_MPa * sheet.thickness_mm * strain)
    return 2.0 * math.sqrt(math.pi) * stiffness_ratio**0.25 * math.sqrt(tension_length_mm(scene))


def nominal_strain(scene: Scene) -> float:
    """Largest displacement of one supported edge against another, over the length between them."""
    from cases.finite_elements import nominal_displacement_mm

    return nominal_displacement_mm(scene) / tension_length_mm(scene)


def with_numbers(scene: Scene, method: Method, nodes: int | None, tolerance: float | None) -> Scene:
    """The scene with the node count and the tolerance that will be used."""
    chosen = tolerance if tolerance is not None else scene.solver.tolerance
    solver = scene.solver.model_copy(update={"tolerance": method.tolerance if chosen is None else chosen})
    mesh = scene.mesh
    if method.finite_elements:
        from cases import finite_elements, postbuckling_scene

        home = postbuckling_scene if method.name == "postbuckling" else finite_elements
        vertices = nodes or mesh.vertices or home.default_vertices(scene)
        mesh = mesh.model_copy(update={"vertices": vertices})
    elif nodes is not None:
        mesh = mesh.model_copy(update={"nodes": nodes})
    return replace(scene, solver=solver, mesh=mesh)


def _kinematics(method: Method) -> str:
    if method.name == "buckling":
        return "small rotations of a plate under a given plane stress"
    return "finite rotations and strains"


def effects_of(method: Method, solution: AnySolution, scene: Scene) -> effects.Effects:
    """The effects of a finished run; those that were left out are audited where the method leaves any out."""
    if method.model is None or not isinstance(solution, Solution):
        return effects.of_method(method.name, method.bending, _kinematics(method))
    from cases.audit import audit

    model, decided = effects.decide(scene, method.model())
    return audit(solution, scene, model, decided)
