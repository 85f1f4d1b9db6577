"""Hard cases of the time step and of units: masses too light or too heavy, a million steps, nm and km."""

from __future__ import annotations

import dataclasses
from functools import partial

import numpy as np

from cases.hard import Finding, HardCase, Requirement, about, at_most
from cases.hard_engine import pulled_strip, relax_from
from cases.hard_starts import PLATE, PULL, like_usual
from fdsolver.edges import EdgeCondition
from fdsolver.level import Level
from fdsolver.mass import SAFETY
from fdsolver.material import Sheet
from fdsolver.meshes import annulus
from fdsolver.model import KOITER, Model
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.relax import Settings, begin, relax
from fdsolver.result import Solution, Status
from tensionfield.relaxed import TENSION_FIELD

NODES = 3000
MILLION = 1_000_000
ONE_MESH = Settings(tolerance=1e-6, levels=1, max_seconds=60.0)


def time_steps() -> list[HardCase]:
    """The time step at and beyond its bound; beyond it the engine must notice, go back and raise the masses."""
    reason = "the time step changes the way, not the equilibrium; an unstable one must be taken back"

    def find(share: float) -> Finding:
        # the unit time step is `share` of the bound where the masses are 1 / share^2 of the bound's
        factor = 1.0 / (SAFETY * share * share)
        solution = relax_from(pulled_strip(PULL, NODES), KOITER, PLATE, mass_factor=factor)
        return Finding(solution, like_usual(solution, KOITER))

    return [
        HardCase(
            f"time-step-{share:g}",
            "time step",
            f"time step of {share:g} times its bound",
            ("converged",),
            reason,
            partial(find, share),
        )
        for share in (0.5, 0.9, 0.99, 1.01, 1.5, 4.0)
    ]


def _million_steps() -> Finding:
    """Go on for a million steps from an equilibrium, with a tolerance that cannot be met."""
    problem = pulled_strip(PULL, 400)
    rest = relax_from(problem, TENSION_FIELD, Settings(tolerance=1e-11, levels=1, max_seconds=100.0))
    level = Level(problem, TENSION_FIELD, problem.grid, 1)
    state = begin(level.scaled(rest.r))
    settings = Settings(tolerance=1e-30, max_steps=MILLION, max_seconds=400.0)
    while relax(level.force, ~level.fixed, level.weight, state, settings) is Status.STALLED:
        vars(state).update(best_residual=np.inf, stalls=0, mass_factor=1.0)  # go on all the same
    drift = float(np.abs(level.unscaled(state.r) - rest.r).max()) / problem.grid.length_mm
    energy = float(level.force(state.r, np.empty_like(state.r)).sum()) * level.energy_unit
    return Finding(
        dataclasses.replace(rest, steps=state.step, cpu_seconds=state.seconds),
        (
            about("steps", state.step, MILLION, 0.0),
            about("energy, N mm", energy, rest.energy_N_mm["total"], 1e-11),
            at_most("largest movement / width", drift, 1e-5),
        ),
    )


def _annulus(length: float, stress: float) -> Problem:
    """The paper's annulus in other units: `length` per mm, `stress` per MPa."""
    inner, outer = 62.5 * length, 250.0 * length
    edges = {
        "inner": EdgeCondition("pinned", move_mm=(0.0, 0.0, 125.0 * length), rotate_deg=90.0),
        "outer": EdgeCondition("pinned"),
    }
    sheet = Sheet(young_MPa=3500.0 * stress, poisson=0.31, thickness_mm=0.1 * length)
    grid = annulus(inner, outer, 2000)
    return Problem(sheet, edges, grid, lambda nodes: annulus(inner, outer, nodes))


def _in_units(model: Model, length: float, stress: float, bits: bool) -> Finding:
    """Compare a run in other units with the same in mm and MPa."""
    settings = dataclasses.replace(ONE_MESH, tolerance=1e-6)
    plain, other = (solve(_annulus(*units), model, settings) for units in ((1.0, 1.0), (length, stress)))
    return Finding(other, same_in_units(plain, other, length, bits))


def same_in_units(plain: Solution, other: Solution, length: float, bits: bool) -> tuple[Requirement, ...]:
    """Require the same number of steps, and the same bits or nearly the same shape."""
    size = float(np.abs(plain.r).max())
    difference = float(np.abs(other.r / length - plain.r).max()) / size
    steps = about("steps", other.steps, plain.steps, 0.0)
    return (steps, at_most("difference of shape / size", difference, 0.0 if bits else 1e-6))


def units() -> list[HardCase]:
    """From nanometres and GPa to kilometres and Pa."""
    reason = "the kernels work on lengths / L and stresses / Y: a change of units changes no iteration"
    scales: list[tuple[str, float, float, bool]] = [
        ("powers of two", 2.0**20, 2.0**-30, True),
        ("nanometres and GPa", 1e-6, 1e3, False),
        ("kilometres and Pa", 1e6, 1e-6, False),
    ]

    def case(name: str, length: float, stress: float, bits: bool, model: Model) -> HardCase:
        find = partial(_in_units, model, length, stress, bits)
        title = f"annulus, {model.name}, numbers of the size of {name}" + (": the same bits" if bits else "")
        return HardCase(
            f"units-{name.replace(' ', '-')}-{model.name}", "units", title, ("converged",), reason, find
        )

    return [case(*scale, model) for scale in scales for model in (TENSION_FIELD, KOITER)]


def step_cases() -> list[HardCase]:
    """All hard cases of time steps and units."""
    million = HardCase(
        "million-steps",
        "time step",
        "a million steps from an equilibrium on",
        ("converged",),
        "an equilibrium stays: rounding must not gather into a drift",
        _million_steps,
    )
    return [*time_steps(), million, *units()]
