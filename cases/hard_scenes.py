"""Hard cases that are scenes: extreme materials, slack sheets, extreme thickness."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cases.exact import has_exact
from cases.hard import Finding, HardCase, Requirement, about, at_least, at_most
from cases.runner import run
from cases.scene import Scene, load_scene
from fdsolver.result import Solution

Require = Callable[[Solution, Scene], tuple[Requirement, ...]]
CONVERGED = ("converged",)
MESH_ERROR = 2e-3  # relative error of an energy on the coarse meshes used here; second order, from the annulus sequence


def scene_case(
    name: str,
    family: str,
    title: str,
    reason: str,
    scene: str,
    method: str,
    nodes: int,
    changes: Mapping[str, Any],
    require: Require,
    expected: tuple[str, ...] = CONVERGED,
    seconds: float = 60.0,
) -> HardCase:
    """A case that solves a built-in scene with some keys changed."""

    def find() -> Finding:
        loaded = load_scene(scene, {"solver.max_seconds": seconds, **changes})
        solution = run(loaded, method, nodes=nodes)
        assert isinstance(solution, Solution), "a method on a structured mesh"
        return Finding(solution, require(solution, loaded))

    return HardCase(name, family, title, expected, reason, find)


def exact_energy(relative: float = MESH_ERROR) -> Require:
    """Require the energy of the closed form."""

    def require(solution: Solution, scene: Scene) -> tuple[Requirement, ...]:
        assert has_exact(scene)
        exact = run(scene, "exact", nodes=400).energy_N_mm["total"]
        scale = scene.material.young_MPa * scene.sheet.thickness_mm * scene.sheet.size_mm**2
        return (about("energy, N mm", solution.energy_N_mm["total"], exact, relative, 1e-12 * scale),)

    return require


def flat(solution: Solution, scene: Scene) -> tuple[Requirement, ...]:
    """Require a sheet that stayed in its plane and is shown stable."""
    height = float(np.abs(solution.r[..., 2]).max())
    return (
        at_most("out-of-plane displacement / thickness", height / scene.sheet.thickness_mm, 0.01),
        at_least("shown stable", float(solution.stability["stable"] is True), 1.0),
    )


def slack(solution: Solution, scene: Scene) -> tuple[Requirement, ...]:
    """Require the relaxed energy of a sheet that is pushed together: none."""
    scale = scene.material.young_MPa * scene.sheet.thickness_mm * scene.sheet.size_mm**2
    return (
        at_most("energy / (Y h L^2)", solution.energy_N_mm["total"] / scale, 1e-12),
        at_least("slack share of the zones", float(np.mean(solution.zone.state == 0)), 0.9),
    )


def near_relaxed(relative: float, nodes: int = 4000) -> Require:
    """Require an energy a little above the relaxed one, by the second method."""

    def require(solution: Solution, scene: Scene) -> tuple[Requirement, ...]:
        relaxed = run(scene, "tension-field", nodes=nodes).energy_N_mm["total"]
        ratio = solution.energy_N_mm["total"] / relaxed
        return (Requirement("energy / relaxed energy", ratio, 1.0 - MESH_ERROR, 1.0 + relative),)

    return require


def materials() -> list[HardCase]:
    """Poisson ratios at and near the ends of their range."""
    family = "Poisson ratio"
    same = "the closed form of the relaxed annulus holds for any Poisson ratio"
    annuli = [
        scene_case(
            f"annulus-poisson-{nu}",
            family,
            f"annulus, lift and quarter turn, Poisson ratio {nu}",
            same,
            "annulus",
            "tension-field",
            5000,
            {"material.poisson": nu},
            exact_energy(),
        )
        for nu in (0.5, 0.0, -0.5, -0.9)
    ]
    homogeneous = "with no Poisson effect pinned edges hinder nothing: the stretch is uniform, in closed form"
    strips = [
        scene_case(
            f"strip-poisson-0-{method}",
            family,
            f"strip pulled by 10 %, Poisson ratio 0, {method}",
            homogeneous,
            "strip-tension",
            method,
            1000,
            {},
            exact_energy(1e-7),
        )
        for method in ("tension-field", "membrane", "koiter")
    ]
    unstrained = scene_case(
        "stretch-poisson-0",
        family,
        "silicone strip pulled by 10 %, Poisson ratio 0, plate",
        "uniaxial stress without lateral strain: nothing is compressed, the sheet stays flat",
        "stretch",
        "koiter",
        4000,
        {"material.poisson": 0.0},
        flat,
    )
    return [*annuli, *strips, unstrained]


def slack_sheets() -> list[HardCase]:
    """Sheets that are slack, pushed together, or nearly cut through by a hole."""
    family = "slack"
    none = "a sheet pushed together has no relaxed energy"
    pushed = [
        scene_case(
            f"pushed-{push:g}",
            family,
            f"strip pushed together by {push:g} %, relaxed",
            none,
            "strip-tension",
            "tension-field",
            1000,
            {"edges.right.move_mm": [-push, 0.0, 0.0], "material.poisson": nu},
            slack,
        )
        for push, nu in ((1.0, 0.0), (10.0, 0.0), (50.0, 0.31))
    ]
    shrunk = scene_case(
        "annulus-outer-pushed",
        family,
        "both circles of an annulus pushed towards each other, relaxed",
        "the inner ring is stretched round, the rest is slack; closed form",
        "annulus",
        "tension-field",
        5000,
        {
            "edges.inner.rotate_deg": 0.0,
            "edges.inner.move_mm": [0.0, 0.0, 0.0],
            "edges.outer.grow_mm": -10.0,
        },
        slack,
    )
    holes = [
        scene_case(
            f"wide-hole-{radius:g}",
            family,
            f"hole of radius {radius:g} mm in a sheet 50 mm wide, pulled by 10 %",
            "the relaxed energy is convex: an equilibrium is the answer, and both ends pull with the same force",
            "hole",
            "tension-field",
            4000,
            {"sheet.hole_radius_mm": radius},
            _balanced,
        )
        for radius in (20.0, 24.0, 24.8)
    ]
    return [*pushed, shrunk, *holes]


def _balanced(solution: Solution, scene: Scene) -> tuple[Requirement, ...]:
    """Require reactions that add up to nothing and pull."""
    pull = solution.reactions["top"].force_N[1]
    total = sum(reaction.force_N for reaction in solution.reactions.values())
    return (
        at_least("pull, N", pull, 1e-9),
        at_most("sum of reactions / pull", float(np.abs(total).max()) / pull, 1e-5),
    )


def thicknesses() -> list[HardCase]:
    """Thickness from 1e-1 to 1e-7 of the width."""
    family = "thickness"
    width = 101.6
    thick = [
        scene_case(
            f"stretch-thickness-1e{power}",
            family,
            f"silicone strip pulled by 10 %, thickness 1e{power} of its width",
            "too stiff to wrinkle: the buckling strain grows with the square of the thickness",
            "stretch",
            "koiter",
            4000,
            {"sheet.thickness_mm": width * 10.0**power},
            flat,
        )
        for power in (-1, -2)
    ]
    thin = [
        scene_case(
            f"stretch-thickness-1e{power}",
            family,
            f"silicone strip pulled by 10 %, thickness 1e{power} of its width",
            "the thinner the sheet, the nearer its energy to the relaxed one, from above",
            "stretch",
            "koiter",
            4000,
            {"sheet.thickness_mm": width * 10.0**power},
            near_relaxed(0.01),
            ("converged", "under_resolved", "hourglass"),
        )
        for power in (-3, -4, -5, -6, -7)
    ]
    return thick + thin


def scene_cases() -> list[HardCase]:
    """All hard cases of material, slackness and thickness."""
    return [*materials(), *slack_sheets(), *thicknesses()]
