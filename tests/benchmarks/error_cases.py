"""Runs whose truth is known, for the coverage of the error estimates: each gives estimates and true values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from cases import load_scene, run
from cases.boundary import edges_of, sheet_of
from cases.errors import ErrorEstimate, errors_of
from cases.exact_annulus import annulus_problem
from cases.schema import Line, Scene
from fdsolver.fields import zone_fields
from fdsolver.meshes import rectangle
from fdsolver.result import Status
from tensionfield.annulus import NoAnnulusSolution, solve_annulus
from tests.cases.made import SHEET, made_solution

KINDS = ("lift and twist", "lift", "twist", "shrink")


@dataclass(frozen=True)
class Case:
    """One run: what it is, its estimates, and the true values of some of their quantities."""

    name: str
    estimates: list[ErrorEstimate]
    truth: Mapping[str, float]


def annulus_cases(count: int, seed: int) -> Iterator[Case]:
    """Relaxed annuli of random size, material, load and mesh that come to rest, against the closed form."""
    random = np.random.default_rng(seed)
    made = 0
    while made < count:
        kind = KINDS[made % len(KINDS)]
        scene, nodes = _annulus_scene(kind, random)
        try:
            truth = annulus_truth(scene)
        except NoAnnulusSolution:
            continue
        solution = run(scene, "tension-field", nodes=nodes)
        if solution.status is not Status.CONVERGED:
            continue  # a strong twist folds zones over: refused as a result, so nothing to estimate
        made += 1
        yield Case(f"annulus, {kind}, {nodes} nodes", errors_of(solution, scene), truth)


def _annulus_scene(kind: str, random: np.random.Generator) -> tuple[Scene, int]:
    inner = float(random.choice([30.0, 62.5, 100.0, 150.0]))
    lift = random.uniform(0.2, 0.9) * (250.0 - inner) if "lift" in kind else 0.0
    changes = {
        "sheet.inner_radius_mm": inner,
        "edges.inner.move_mm": [0.0, 0.0, lift],
        "edges.inner.rotate_deg": random.uniform(10.0, 100.0) if "twist" in kind else 0.0,
        "edges.inner.grow_mm": -random.uniform(0.02, 0.3) * inner if kind == "shrink" else 0.0,
        "material.poisson": float(random.choice([0.0, 0.2, 0.31, 0.5])),
        "solver.levels": 3,
        "paths": {},
        "sections": {},
    }
    return load_scene("annulus", changes), int(random.choice([6500, 8000, 12000, 20000]))


def annulus_truth(scene: Scene) -> dict[str, float]:
    """The quantities of the closed form."""
    exact = solve_annulus(annulus_problem(scene.sheet, sheet_of(scene), edges_of(scene)), tolerance=1e-11)
    # 20 001 radii: the trapezoidal rule is exact to 1e-9 there, the estimates are of 1e-5 and more
    radius = np.linspace(exact.problem.inner_radius_mm, exact.problem.outer_radius_mm, 20_001)
    major, minor = exact.stretches(radius)
    z = exact.position(radius)[2]
    return {
        "energy_N_mm.total": exact.energy_N_mm,
        "reactions.inner.force_N.z": exact.axial_force_N,
        "reactions.outer.force_N.z": -exact.axial_force_N,
        "reactions.inner.moment_N_mm.z": exact.torque_N_mm,
        "reactions.outer.moment_N_mm.z": -exact.torque_N_mm,
        "stretch.major_max": float(major.max()),
        "stretch.major_min": float(major.min()),
        "stretch.minor_min": float(minor.min()),
        "out_of_plane_mm.rms": float(
            np.sqrt(np.trapezoid(z**2 * radius, radius) / np.trapezoid(radius, radius))
        ),
    }


def manufactured_cases(count: int, seed: int) -> Iterator[Case]:
    """Given shapes of a strip, wavy across and bulging along it, on three meshes: what is read off against calculus."""
    random = np.random.default_rng(seed)
    width, height = 100.0, 60.0
    x = np.linspace(-width / 2.0, width / 2.0, 200_001)
    for k in range(count):
        amplitude, stretch = random.uniform(0.2, 2.0), random.uniform(1.0, 1.3)
        waves, phase = random.uniform(1.0, 4.0), random.uniform(0.0, 2.0 * np.pi)
        nodes = int(random.choice([6400, 10_000, 20_000]))

        def lift(x: np.ndarray, y: np.ndarray, form=(amplitude, waves, phase)) -> np.ndarray:
            size, number, shift = form
            return size * np.sin(2.0 * np.pi * number * x / width + shift) * np.cos(np.pi * y / height)

        states = [_made(rectangle(width, height, n), lift, stretch) for n in (nodes // 16, nodes // 4, nodes)]
        scene = load_scene(
            "strip-tension",
            {
                "sheet.width_mm": width,
                "sheet.height_mm": height,
                "sections.midsection.from_mm": [-width / 2.0, 0.0],
                "sections.midsection.to_mm": [width / 2.0, 0.0],
                "paths": {},
            },
        )
        assert isinstance(scene.sections["midsection"], Line)
        estimates = errors_of(replace(states[-1], coarser=tuple(states[:-1])), scene)
        z = lift(x, 0.0 * x)
        square = np.trapezoid(z**2, x) / width
        truth = {
            "sections.midsection.amplitude_mm": float(np.abs(z).max()),
            "sections.midsection.rms_mm": float(np.sqrt(square)),
            "out_of_plane_mm.max_abs": float(np.abs(z).max()),
            "out_of_plane_mm.rms": float(np.sqrt(square / 2.0)),  # the mean of cos^2 over the height
            "stretch.major_max": _largest_stretch(lift, stretch, width, height),
        }
        yield Case(f"given shape {k}, {nodes} nodes", estimates, truth)


def _made(grid, lift, stretch):
    solution = made_solution(grid, lift, stretch)
    return replace(solution, zone=zone_fields(grid, SHEET, solution.r, relaxed=False))


def _largest_stretch(lift, stretch: float, width: float, height: float) -> float:
    """From differences over 1e-4 mm at a million places, good to 1e-7."""
    x, y = np.meshgrid(
        np.linspace(-width / 2, width / 2, 2001), np.linspace(-height / 2, height / 2, 601), indexing="ij"
    )
    d = 1e-4
    along = (lift(x + d, y) - lift(x - d, y)) / (2.0 * d)
    across = (lift(x, y + d) - lift(x, y - d)) / (2.0 * d)
    c11, c22, c12 = stretch**2 + along**2, 1.0 + across**2, along * across
    mean, half = (c11 + c22) / 2.0, (c11 - c22) / 2.0
    return float(np.sqrt((mean + np.hypot(half, c12)).max()))


def homogeneous_cases() -> Iterator[Case]:
    """States that every mesh has exactly: what is left is the iteration error."""
    for nodes in (1600, 3600, 6400, 12_000):
        for strain in (0.02, 0.1, 0.3):
            scene = load_scene(
                "strip-tension",
                {
                    "edges.right.move_mm": [100.0 * strain, 0.0, 0.0],
                    "solver.levels": 2,
                    "start.perturbation": 1e-4,
                },
            )
            exact = run(scene, "exact", nodes=nodes)
            solution = run(scene, "koiter", nodes=nodes)
            truth = {
                "energy_N_mm.total": exact.energy_N_mm["total"],
                "reactions.right.force_N.x": float(exact.reactions["right"].force_N[0]),
                "stretch.major_max": float(exact.zone.stretch_major.max()),
            }
            yield Case(f"strip, strain {strain:g}, {nodes} nodes", errors_of(solution, scene), truth)
