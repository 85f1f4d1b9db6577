"""The methods: what each solves for, its defaults, and how it is called for a scene."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from cases.boundary import grid_of, problem_of, sheet_of
from cases.schema import AnnulusSheet, Scene
from cases.unstructured import AnySolution
from fdsolver.checkpoint import Checkpoint
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.relax import Progress, Settings
from fdsolver.result import Solution

FEWEST_NODES_PER_WRINKLE = 6


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
        the scene's `mesh.vertices`.
    """

    name: str
    title: str
    bending: bool
    wrinkles: bool
    tolerance: float
    solve: Callable[[Task], AnySolution]
    finite_elements: bool = False


def _tension_field(task: Task) -> Solution:
    from tensionfield.relaxed import TENSION_FIELD

    return _relaxed_by(TENSION_FIELD, task)


def _membrane(task: Task) -> Solution:
    return _relaxed_by(MEMBRANE, task)


def _koiter(task: Task) -> Solution:
    return _relaxed_by(KOITER, task)


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


METHODS = {
    method.name: method
    for method in (
        Method("tension-field", "tension field (relaxed membrane)", False, False, 1e-8, _tension_field),
        Method("membrane", "unrelaxed membrane", False, False, 1e-8, _membrane),
        Method("koiter", "Koiter plate", True, True, 1e-6, _koiter),
        Method("koiter-published", "Koiter plate, published scheme", True, True, 1e-8, _published),
        Method("buckling", "buckling factors (finite elements)", True, False, 1e-8, _buckling, True),
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
        name, why = _automatic(scene)
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

    strain = _nominal_strain(scene)
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

    solver = task.scene.solver
    assert solver.tolerance is not None, "the runner resolves the tolerance"
    settings = Settings(
        tolerance=solver.tolerance,
        damping=solver.damping,
        mass=solver.mass,
        levels=solver.levels,
        thicken=solver.thicken,
        max_steps=solver.max_steps,
        max_seconds=solver.max_seconds,
        threads=task.threads,
        snapshots=solver.snapshots,
    )
    problem = problem_of(task.scene, model, task.seed)
    return solve(problem, model, settings, progress=task.progress, checkpoint=task.checkpoint)


def _refuse_options(scene: Scene, method: Method) -> None:
    """Refuse keys whose meaning would otherwise silently be dropped. Raises MethodError."""
    from_mode = (scene.start.source or "").startswith("mode:")
    later = {
        f"symmetry.reduce = {scene.symmetry.reduce!r}": scene.symmetry.reduce != "none"
        and method.name != "postbuckling",
        f"start.from = {scene.start.source!r}": from_mode and method.name not in ("koiter", "postbuckling"),
        f"start.from = {scene.start.source!r} by {method.name}": method.name
        in ("exact", "buckling", "postbuckling")
        and scene.start.source is not None
        and not (from_mode and method.name == "postbuckling"),
        "effects.kinematics = 'moderate'": scene.effects.kinematics == "moderate",
        "effects.out_of_plane = 'off'": scene.effects.out_of_plane == "off",
        "effects.bending = 'off' with a plate": scene.effects.bending == "off" and method.bending,
        "effects.strain_gradient = 'off' with a plate": scene.effects.strain_gradient == "off"
        and method.bending,
    }
    if from_mode and method.name == "koiter" and (reason := why_unfit(scene, "buckling")):
        raise MethodError(f"start.from = {scene.start.source!r} has no mode to start from: {reason}.")
    asked = [key for key, is_asked in later.items() if is_asked]
    if asked:
        raise MethodError(f"{' and '.join(asked)} cannot be solved yet; it comes with a later version.")


def _automatic(scene: Scene) -> tuple[str, str]:
    """Koiter if the mesh can carry the wrinkles that a scaling law predicts, tension field otherwise."""
    strain = _nominal_strain(scene)
    if strain == 0.0:
        return "koiter", "auto chose koiter: no edge moves, so nothing says that the sheet wrinkles."
    wavelength = predicted_wavelength(scene, strain)
    area = float(grid_of(scene)(scene.mesh.nodes).zone_area.mean())
    per_wrinkle = wavelength / math.sqrt(area)
    predicted = f"wrinkles of about {wavelength:.3g} mm, {per_wrinkle:.2g} nodes each"
    if per_wrinkle >= FEWEST_NODES_PER_WRINKLE:
        return "koiter", f"auto chose koiter: the mesh resolves the expected {predicted}."
    return "tension-field", f"auto chose tension-field: the mesh cannot resolve the expected {predicted}."


def predicted_wavelength(scene: Scene, strain: float) -> float:
    """Wavelength of tension wrinkles, mm: 2 sqrt(pi) (D / T)^(1/4) length^(1/2) with T = Y h strain (Cerda
    and Mahadevan 2003).
    """
    sheet = sheet_of(scene)
    stiffness_ratio = sheet.bending_stiffness_N_mm / (sheet.young_MPa * sheet.thickness_mm * strain)
    return 2.0 * math.sqrt(math.pi) * stiffness_ratio**0.25 * math.sqrt(tension_length_mm(scene))


def _nominal_strain(scene: Scene) -> float:
    """Largest displacement of an edge point over the length that takes it up."""
    size = scene.sheet.size_mm / 2.0
    moves = [
        math.hypot(*edge.move_mm)
        + abs(edge.grow_mm)
        + abs(2.0 * size * math.sin(math.radians(edge.rotate_deg) / 2.0))
        for edge in scene.edges.values()
        if edge.support != "free"
    ]
    return max(moves, default=0.0) / tension_length_mm(scene)


def tension_length_mm(scene: Scene) -> float:
    """Length along which the sheet is pulled: between its most distant supports, or between the circles."""
    sheet = scene.sheet
    if isinstance(sheet, AnnulusSheet):
        return sheet.smallest_width_mm
    upright = {"bottom", "top"} & {name for name, edge in scene.edges.items() if edge.support != "free"}
    return sheet.height_mm if upright else sheet.width_mm


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


def effects_of(method: Method) -> dict[str, dict[str, object]]:
    """Which effects the method's model has, in the form of result.json; sizes are not measured."""
    why = f"the model of {method.name}"
    unmeasured = {"size": None, "justified": None}
    return {
        "out_of_plane": {"on": True, "why": why, **unmeasured},
        "bending": {"on": method.bending, "why": why, **unmeasured},
        "strain_gradient": {"on": method.bending, "why": why, **unmeasured},
        "kinematics": {"on": True, "why": _kinematics(method), **unmeasured},
    }
