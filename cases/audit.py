"""Was it right to leave an effect out? A verdict on every result, by a measure that can see the effect.

    out_of_plane      stability against motion out of the plane; the relaxed energy is convex and needs none
    bending           a sheet in its plane: its stability. Others: no zone may be compressed, for a membrane does not
                      say what its wrinkles are; where all is tense, energy and forces that the plate puts back. What
                      wrinkles would hold of the energy follows from stress and shortening of the result
    strain_gradient   change of energies and of force when the effect is put back on the result
    kinematics        the same
    symmetry          stability of the whole sheet against the modes that the reduced one excludes, and whether the mesh
                      resolves its wrinkles: others are as many as the mesh and the start make them

Forces on a planar state vanish by symmetry and prove nothing about it; the curvature of slack or folded zones is noise.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cases.advice import FEWEST_NODES_PER_WRINKLE
from cases.boundary import problem_of
from cases.effects import JUSTIFIED, NOT_JUSTIFIED, Effect, Effects
from cases.probe import nodes_per_wrinkle, sample_section
from cases.schema import Scene
from cases.survey import Wrinkles, tension_length_mm, wrinkles_of
from fdsolver.fields import TENSE
from fdsolver.level import Level, make_level
from fdsolver.mass import invert, nodal_masses
from fdsolver.model import KOITER, Model
from fdsolver.relax import State, begin
from fdsolver.residual import residual
from fdsolver.result import Solution
from fdsolver.stability import HELD_FLAT, PLANAR, examine

SMALL = 1e-3  # relative change of a reported quantity that counts as none
NEGLIGIBLE = (
    5e-4  # share of the energy, half of SMALL: on taut sheets bending changes forces as much as energies
)
# Change of energies and forces when an effect is put back on the result, relative: the state then follows, and full
# runs found quantities that changed by up to four times as much.
PUT_BACK = 2e-4
NOTHING = 1e-9  # size below which an effect that was on did nothing


def audit(solution: Solution, scene: Scene, model: Model, effects: Effects) -> Effects:
    """The effects of a run with the verdicts on those that were left out, and the sizes of those that were not.

    model : as it was solved. A state that is not finite is not judged.
    """
    if not np.isfinite(solution.r).all():
        return effects
    judges = {
        "out_of_plane": _out_of_plane,
        "bending": _bending,
        "strain_gradient": _strain_gradient,
        "kinematics": _kinematics,
        "symmetry": _symmetry,
    }
    return {name: judges[name](effect, solution, scene, model) for name, effect in effects.items()}


def _verdict(effect: Effect, size: float, fine: bool, how: str) -> Effect:
    word = JUSTIFIED if fine else NOT_JUSTIFIED
    return replace(effect, why=f"{effect.why}; {how}", size=size, justified=word)


def _used(effect: Effect, size: float, what: str) -> Effect:
    """An effect that was on, with its size; named if it did nothing."""
    nothing = "" if size > NOTHING else "; it did nothing"
    return replace(effect, why=f"{effect.why}; {what} {size:.2g}{nothing}", size=size)


def _out_of_plane(effect: Effect, solution: Solution, scene: Scene, model: Model) -> Effect:
    if effect.on:
        height = float(np.abs(solution.r[..., 2]).max()) / solution.grid.length_mm
        return _used(effect, height, "largest height over L")
    if model.relaxed:
        return _verdict(effect, 0.0, True, "the relaxed energy is convex")
    stable, lowest = solution.stability.get("stable"), solution.stability.get("lowest")
    size = float(lowest) if isinstance(lowest, int | float) else float("nan")
    how = f"lowest out-of-plane eigenvalue {size:.2g}"
    if solution.stability.get("how") == HELD_FLAT:
        return _verdict(effect, size, True, HELD_FLAT)
    if stable is True and model.bending is False and not model.relaxed:
        how += " without bending, which would only raise it"
    return _verdict(effect, size, stable is True, how)


def _bending(effect: Effect, solution: Solution, scene: Scene, model: Model) -> Effect:
    total = max(abs(solution.energy_N_mm["total"]), 1e-300)
    if effect.on:
        return _used(effect, solution.energy_N_mm["bending"] / total, "share of the energy")
    if model.bending:
        stable = solution.stability.get("stable") is True
        return _verdict(effect, 0.0, stable, "and it stays there" if stable else "but it does not stay there")
    wrinkles = wrinkles_of(
        solution.grid, solution.sheet, solution.r, tension_length_mm(scene), model.moderate
    )
    size = (wrinkles.energy_N_mm + _smooth_bending(solution, scene, model)) / total
    if wrinkles.share > 0.0:
        return _verdict(effect, size, False, _left_out(wrinkles, size))
    local = _local_change(solution, scene, model)
    fine = size < NEGLIGIBLE and local < SMALL and solution.stability.get("stable") is not False
    how = f"nothing wrinkles; bending would hold {size:.1e} of the energy and change forces by {local:.1e}"
    return _verdict(effect, size, fine, how)


def _left_out(wrinkles: Wrinkles, size: float) -> str:
    """What a membrane leaves out where it is compressed."""
    where = f"{100.0 * wrinkles.share:.2g} % of the sheet is compressed"
    if np.isinf(wrinkles.wavelength_mm):
        return f"{where} and slack: its shape is left out"
    return (
        f"{where}: wrinkles of about {wrinkles.wavelength_mm:.3g} mm, {wrinkles.height_mm:.2g} mm high, are left out,"
        f" with {size:.1e} of the energy"
    )


def _local_change(solution: Solution, scene: Scene, model: Model) -> float:
    """Largest force that the plate's bending and hourglass energy put on a free node of the result.

    As a residual, relative to the largest strain: near enough the relative change of the strain there.
    """
    plate = replace(KOITER, out_of_plane=model.out_of_plane, moderate=model.moderate)
    forces = []
    for each in (model, plate):
        level, r = _level(solution, scene, each)
        forces.append(np.zeros_like(r))
        level.force(r, forces[-1])
    stretch = solution.zone.stretch_major
    strain = max(float(np.abs(0.5 * (stretch**2 - 1.0)).max()), 1e-300)
    return residual(forces[1] - forces[0], level.weight) / strain


def _smooth_bending(solution: Solution, scene: Scene, model: Model) -> float:
    """Bending energy, N mm, that the shape would have where the sheet is tense; elsewhere curvature is noise."""
    if not model.out_of_plane:
        return 0.0
    level, r = _level(solution, scene, KOITER)
    tense = solution.zone.state == TENSE
    around = np.ones((level.grid.ni, level.grid.nj), dtype=bool)  # nodes of which every zone is tense
    for i, j in np.argwhere(~tense):
        around[np.ix_([i, (i + 1) % level.grid.ni], [j, j + 1])] = False
    node, twist = level.force.node, level.force.twist
    assert node is not None and twist is not None, "the plate has bending"
    node[:6] *= around
    twist[:2] *= tense
    return float(level.force(r, np.zeros_like(r))[1]) * level.energy_unit


def _level(solution: Solution, scene: Scene, model: Model) -> tuple[Level, np.ndarray]:
    """The whole sheet with a model, and the result's positions on it, scaled."""
    problem = replace(
        problem_of(scene, model, solution.seed), symmetry=None, grid=solution.grid, initial=None
    )
    level = make_level(problem, model, solution.grid, 1)
    return level, level.scaled(solution.r)


def _changes(solution: Solution, scene: Scene, model: Model, full: Model) -> float:
    """Largest relative change of an energy, and of the force on the supports, from one model to a fuller one."""
    energies, pushes = [], []
    for each in (model, full):
        level, r = _level(solution, scene, each)
        f = np.zeros_like(r)
        parts = level.force(r, f)
        energies.append(np.array([parts.sum(), parts[1]]))
        pushes.append(f[:, level.fixed])
    size = np.maximum(np.abs(energies[1]), 1e-12 * abs(energies[1][0]) + 1e-300)
    change = np.abs(energies[0] - energies[1]) / size
    change[1] *= float(energies[1][1] > NOTHING * energies[1][0])
    push = np.abs(pushes[1].sum(axis=1) - pushes[0].sum(axis=1)).max() if pushes[0].size else 0.0
    scale = np.abs(pushes[1]).sum() + 1e-300 if pushes[0].size else 1.0
    return float(max(change.max(), push / scale))


def _strain_gradient(effect: Effect, solution: Solution, scene: Scene, model: Model) -> Effect:
    if model.curvature == "none" or solution.energy_N_mm["bending"] == 0.0:
        return (
            effect
            if effect.on or model.curvature == "none"
            else _verdict(effect, 0.0, True, "nothing is bent")
        )
    plain = replace(model, strain_gradient=True, moderate=False)
    size = _changes(solution, scene, replace(plain, strain_gradient=False), plain)
    if effect.on:
        return _used(effect, size, "without it energies and forces would change by")
    return _verdict(effect, size, size < PUT_BACK, f"with it energies and forces change by {size:.1e}")


def _kinematics(effect: Effect, solution: Solution, scene: Scene, model: Model) -> Effect:
    if effect.on:
        return effect
    size = _changes(solution, scene, model, replace(model, moderate=False, strain_gradient=False))
    return _verdict(effect, size, size < PUT_BACK, f"finite strains change energies and forces by {size:.1e}")


def _symmetry(effect: Effect, solution: Solution, scene: Scene, model: Model) -> Effect:
    if model.relaxed:
        return _verdict(
            effect, 0.0, True, "the relaxed energy is convex: its state has the symmetry of the load"
        )
    level, r = _level(solution, scene, replace(model, out_of_plane=True))
    verdict = examine(level, _at_rest(level, r), _flat(solution))
    how = f"whole sheet: {verdict.how}, {verdict.lowest:.2g}"
    sections = [sample_section(solution.grid, solution.r, line) for line in scene.sections.values()]
    nodes = nodes_per_wrinkle(sections, solution.sheet.thickness_mm)
    resolved = nodes is None or nodes >= FEWEST_NODES_PER_WRINKLE
    if not resolved:
        how += f"; its wrinkles have {nodes:.1f} nodes each, too few to be those of any other mesh or start"
    return _verdict(effect, verdict.lowest, verdict.stable and resolved, how)


def _flat(solution: Solution) -> float:
    return PLANAR * solution.sheet.thickness_mm / solution.grid.length_mm


def _at_rest(level: Level, r: np.ndarray) -> State:
    """A state at rest with its masses, for the examination."""
    state = begin(r)
    state.mass = nodal_masses(level.force, r, r, level.force.relaxed)
    invert(
        state.mass.reshape(len(state.mass), -1),
        ~level.fixed.reshape(-1),
        state.inverse_mass.reshape(len(state.mass), -1),
    )
    return state
