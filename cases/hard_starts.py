"""Hard cases of the start: checkerboards, huge and turned starts, loads taken back, the unstable flat state."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np

from cases.hard import Finding, HardCase, Requirement, about, at_least
from cases.hard_engine import pulled_strip, relax_from
from fdsolver.level import Level
from fdsolver.meshes import rectangle
from fdsolver.model import KOITER, Model
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.relax import Settings
from fdsolver.result import Solution
from tensionfield.relaxed import TENSION_FIELD

NODES = 3000
PULL = 0.1
PLATE = Settings(tolerance=1e-8, max_seconds=60.0)  # at 1e-6 wrinkles have not grown: 5 % of bending energy
MEMBRANE = Settings(tolerance=1e-8, max_seconds=60.0)
SAME_WRINKLES = (
    0.03  # wrinkles that a start leaves in another phase differ in bending energy by less on this mesh
)
SAME_ENERGY = 1e-6  # the relaxed energy is convex: one energy, up to the square of what the tolerance leaves

Start = Callable[[Level], np.ndarray]


def _lines(level: Level) -> tuple[np.ndarray, np.ndarray]:
    return np.meshgrid(np.arange(level.grid.ni), np.arange(level.grid.nj), indexing="ij")


def _out_of_plane(level: Level, height: np.ndarray) -> np.ndarray:
    """The interpolated start with z = height (in thicknesses) at the free nodes."""
    r = level.start()
    r[2] = np.where(level.fixed, 0.0, height * level.problem.sheet.thickness_mm / level.grid.length_mm)
    return r


def checkerboard(level: Level) -> np.ndarray:
    """One thickness up and down from node to node."""
    i, j = _lines(level)
    return _out_of_plane(level, (-1.0) ** (i + j))


def saw_tooth(level: Level) -> np.ndarray:
    """One thickness up and down from mesh line to mesh line."""
    return _out_of_plane(level, (-1.0) ** _lines(level)[0])


def hundred_thicknesses(level: Level) -> np.ndarray:
    """Random, a hundred thicknesses high."""
    return _out_of_plane(level, 100.0 * np.random.default_rng(3).uniform(-1.0, 1.0, level.fixed.shape))


def in_plane_checkerboard(level: Level) -> np.ndarray:
    """The free nodes moved along x by a tenth of a cell, to and fro."""
    i, j = _lines(level)
    r = level.start()
    r[0] += np.where(level.fixed, 0.0, 0.1 / level.grid.ni * (-1.0) ** (i + j))
    return r


def turned_over(level: Level) -> np.ndarray:
    """The free nodes turned by 180 degrees about the strip's long axis: every zone starts inside out."""
    r = level.start()
    r[0] = np.where(level.fixed, r[0], -r[0])
    return r


def one_node_across(level: Level) -> np.ndarray:
    """One inner node thrown over its neighbours: zones inverted on the way."""
    r = level.start()
    r[0, level.grid.ni // 2, level.grid.nj // 2] += 3.0 / level.grid.ni
    return r


def pulled_further(level: Level) -> np.ndarray:
    """The start of a strip pulled three times as far: the load is taken back."""
    further = pulled_strip(3.0 * PULL, NODES)
    r = Level(further, level.model, level.grid, 1).start()
    return np.where(level.fixed, level.start(), r)


def loaded_row_only(level: Level) -> np.ndarray:
    """Only the loaded row of nodes moved, all in one step."""
    r = level.start()
    r[:2] = np.where(level.fixed, r[:2], level.scaled(level.flat)[:2])
    return r


STARTS: dict[str, Start] = {
    "checkerboard": checkerboard,
    "saw-tooth": saw_tooth,
    "hundred-thicknesses": hundred_thicknesses,
    "in-plane-checkerboard": in_plane_checkerboard,
    "turned-over": turned_over,
    "one-node-across": one_node_across,
    "pulled-further": pulled_further,
    "loaded-row-only": loaded_row_only,
}
# A plate that starts inside out must cross itself, and may rest in a twisted state: a fold that its mesh cannot show.
MAY_END = {"turned-over": ("converged", "stalled", "hourglass", "zone_inverted", "step_limit", "time_limit")}


@functools.cache
def usual(model: Model) -> Solution:
    """The strip by the usual road: nested meshes from the interpolated start."""
    return solve(pulled_strip(PULL, NODES), model, PLATE if model is KOITER else MEMBRANE)


def height(solution: Solution) -> float:
    """Largest out-of-plane displacement, thicknesses."""
    return float(np.abs(solution.r[..., 2]).max()) / solution.sheet.thickness_mm


def like_usual(solution: Solution, model: Model) -> tuple[Requirement, ...]:
    """Require the energies of the usual road."""
    wanted = usual(model)
    total = about("energy, N mm", solution.energy_N_mm["total"], wanted.energy_N_mm["total"], SAME_ENERGY)
    if model is not KOITER:
        return (total,)
    bending = about(
        "bending energy, N mm", solution.energy_N_mm["bending"], wanted.energy_N_mm["bending"], SAME_WRINKLES
    )
    return (total, bending, at_least("height of the wrinkles / thickness", height(solution), 0.5))


def _start_case(name: str, start: Start, model: Model) -> HardCase:
    def find() -> Finding:
        settings = PLATE if model is KOITER else MEMBRANE
        solution = relax_from(pulled_strip(PULL, NODES), model, settings, start)
        return Finding(solution, like_usual(solution, model))

    reason = (
        "equilibrium does not remember its start: wrinkles but for their phase, the relaxed energy is convex"
    )
    title = (start.__doc__ or "").split("\n")[0].rstrip(".")
    return HardCase(
        f"start-{name}-{model.name}", "start", title, MAY_END.get(name, ("converged",)), reason, find
    )


def _disguise(name: str, title: str, make: Callable[[], Problem], settings: Settings) -> HardCase:
    """The strip at 10 %, where the flat state is in equilibrium and unstable."""

    def find() -> Finding:
        solution = solve(make(), KOITER, settings)
        return Finding(
            solution,
            (
                at_least("height of the wrinkles / thickness", height(solution), 0.5),
                at_least("shown stable", float(solution.stability["stable"] is True), 1.0),
            ),
        )

    reason = "at 10 % the flat strip is unstable (Zheng 2009; linearised buckling): flat must not pass for converged"
    return HardCase(f"flat-{name}", "unstable flat state", title, ("converged",), reason, find)


def _symmetric_noise() -> Problem:
    return pulled_strip(PULL, NODES, perturbation=0.0)


def _odd_mesh(columns: int) -> Problem:
    strip = pulled_strip(PULL, NODES)
    grid = rectangle(101.6, 254.0, columns, bias=0.3)
    return Problem(
        strip.sheet, strip.edges, grid, lambda nodes: rectangle(101.6, 254.0, nodes, bias=0.3), seed=1
    )


def disguises() -> list[HardCase]:
    """The unstable flat state in every disguise."""
    one_level = Settings(tolerance=1e-6, levels=1, max_seconds=60.0)
    cases = [
        _disguise("no-noise", "no perturbation at all", _symmetric_noise, one_level),
        _disguise(
            "no-noise-nested", "no perturbation, nested meshes", _symmetric_noise, Settings(1e-6, levels=2)
        ),
        _disguise("other-mesh", "another number and grading of cells", lambda: _odd_mesh(3500), one_level),
    ]
    for power in (-9, -12, -15):
        amplitude = 10.0**power
        cases.append(
            _disguise(
                f"noise-1e{power}",
                f"perturbation of 1e{power} widths",
                functools.partial(pulled_strip, PULL, NODES, perturbation=amplitude),
                one_level,
            )
        )
    for damping in ("adaptive", "kinetic", "viscous"):
        cases.append(
            _disguise(
                f"damping-{damping}",
                f"{damping} damping to a residual of 1e-4 only",
                lambda: pulled_strip(PULL, NODES, perturbation=1e-12),
                Settings(tolerance=1e-4, damping=damping, levels=1, max_seconds=60.0),
            )
        )
    return cases


def start_cases() -> list[HardCase]:
    """All hard cases of the start."""
    starts = [
        _start_case(name, start, model)
        for name, start in STARTS.items()
        for model in (KOITER, TENSION_FIELD)
        if not (model is TENSION_FIELD and name in ("checkerboard", "saw-tooth", "hundred-thicknesses"))
    ]
    return starts + disguises()
