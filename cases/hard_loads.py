"""Hard cases of the load: stretches beyond the material's limit, twists to a full turn, lifts of two radii."""

from __future__ import annotations

import numpy as np

from cases.hard import HardCase, Requirement, about
from cases.hard_scenes import MESH_ERROR, exact_energy, near_relaxed, scene_case
from cases.runner import run
from cases.scene import Scene, load_scene
from fdsolver.result import Solution

TWIST = "twist and lift"


def limit_stretches() -> list[HardCase]:
    """Stretches near and beyond sqrt(1 + 1/nu), where the material has no natural width."""
    family = "limit stretch"
    limit = float(np.sqrt(1.0 + 1.0 / 0.31))
    reason = "closed form; beyond sqrt(1 + 1/nu) zones are simply tense, which is a warning and no refusal"
    cases = []
    for share in (0.9, 0.99, 1.01, 1.5):
        grown = 187.5 * (share * limit - 1.0)
        cases.append(
            scene_case(
                f"annulus-lift-limit-{share}",
                family,
                f"annulus lifted until the mean stretch is {share} sqrt(1 + 1/nu)",
                reason,
                "annulus-lift",
                "tension-field",
                5000,
                {"edges.inner.move_mm": [0.0, 0.0, float(np.sqrt((187.5 + grown) ** 2 - 187.5**2))]},
                exact_energy(),
            )
        )
    for pull in (50.0, 100.0):
        cases.append(
            scene_case(
                f"strip-pull-{pull:g}",
                family,
                f"strip without Poisson effect pulled by {pull:g} %",
                "uniform stretch in closed form; without Poisson effect there is no limit",
                "strip-tension",
                "koiter",
                1000,
                {"edges.right.move_mm": [pull, 0.0, 0.0]},
                exact_energy(1e-7),
            )
        )
    return cases


def turned_annuli() -> list[HardCase]:
    """Twists up to a full turn, and lifts to twice the outer radius."""
    closed_form = "closed form of the relaxed annulus, by shooting and by collocation"
    same_edges = (
        "the edges stand where the smaller turn puts them, and the relaxed energy is convex: one equilibrium"
    )
    mirror = "mirror image of the scene, whose energy is the same"
    cases = [
        _turned(angle, lift, abs(angle), closed_form if angle > 0.0 else mirror)
        for angle, lift in ((90.0, 125.0), (150.0, 125.0), (90.0, 250.0), (90.0, 500.0), (-90.0, 125.0))
    ]
    cases += [_turned(270.0, 125.0, 90.0, same_edges), _turned(360.0, 125.0, 0.0, same_edges)]
    collapsed = scene_case(
        "annulus-180-125",
        TWIST,
        "annulus turned by 180 degrees: the sheet closes on its axis",
        "left and right turn are one and the same, so the one equilibrium passes through the axis: no sheet any more",
        "annulus",
        "tension-field",
        5000,
        {"edges.inner.rotate_deg": 180.0},
        lambda solution, scene: (),
        ("outside_validity",),
    )
    plate = scene_case(
        "annulus-plate-150",
        TWIST,
        "annulus turned by 150 degrees, plate of 0.1 mm",
        "a plate cannot have less energy than the relaxed membrane, and thin wrinkles cost little",
        "annulus",
        "koiter",
        5000,
        {"edges.inner.rotate_deg": 150.0, "sheet.thickness_mm": 0.1},
        near_relaxed(0.05),
        ("converged", "stalled", "under_resolved"),
    )
    return [*cases, collapsed, plate]


def _turned(angle: float, lift: float, same_as: float, reason: str) -> HardCase:
    """The relaxed annulus turned by `angle` degrees, with the energy of the closed form at `same_as` degrees."""
    turn, move = "edges.inner.rotate_deg", "edges.inner.move_mm"

    def require(solution: Solution, scene: Scene) -> tuple[Requirement, ...]:
        turned = load_scene("annulus", {turn: same_as, move: [0.0, 0.0, lift]})
        exact = run(turned, "exact", nodes=400).energy_N_mm["total"]
        return (about("energy, N mm", solution.energy_N_mm["total"], exact, MESH_ERROR),)

    title = f"annulus turned by {angle:g} degrees and lifted by {lift:g} mm"
    changes = {turn: angle, move: [0.0, 0.0, lift]}
    name = f"annulus-{angle:g}-{lift:g}"
    return scene_case(name, TWIST, title, reason, "annulus", "tension-field", 5000, changes, require)


def load_cases() -> list[HardCase]:
    """All hard cases of the load."""
    return [*limit_stretches(), *turned_annuli()]
