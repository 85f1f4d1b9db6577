"""The paper's own scheme beside the conservative one on the sheared sheet: one sheet, and a checkerboard."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cases import load_scene
from cases.boundary import problem_of
from fdsolver.level import Level
from fdsolver.model import KOITER
from fdsolver.result import Solution
from tests.benchmarks.checkerboard import energy_of_waves
from tests.benchmarks.published_runs import HEALTHY, sheared, solved

MESHES = (5000, 10000, 20000)
# At the usual tolerance the flaps at the free corners are still 0.1 to 1.7 % of their height from rest.
AT_REST = {"solver.tolerance": 1e-11, "solver.finish": "on"}
AT_REST_PUBLISHED = {"solver.tolerance": 1e-10, "solver.published": "stabilised"}


def rms(z: np.ndarray) -> float:
    return float(np.sqrt(np.mean(z**2)))


def order(nodes: list[int], differences: list[float]) -> float:
    """p of difference = c h^p, by least squares of the logarithms; the mesh width h goes with nodes^-1/2."""
    return float(-2.0 * np.polyfit(np.log(nodes), np.log(np.abs(differences)), 1)[0])


def at_zero_width(nodes: list[int], values: list[float]) -> float:
    """What the last two values of a difference of second order leave at zero mesh width (Richardson)."""
    (coarse, fine), (before, last) = nodes[-2:], values[-2:]
    return last + (last - before) * coarse / (fine - coarse)


def conservative_energy(keys: dict[str, object], state: Solution) -> float:
    """The conservative scheme's energy of any state on its mesh, scaled."""
    problem = replace(problem_of(load_scene("shear", keys), KOITER, seed=0), perturbation=0.0)
    level = Level(problem, KOITER, state.grid, 1)
    r = level.scaled(state.r)
    return float(level.force(r, np.zeros_like(r)).sum())


def test_stabilised_it_tends_to_the_same_sheet(verify):
    """The stabilised scheme and the conservative one, sheared by 0.05 mm: one state as the mesh gets finer"""
    keys, name = sheared(0.05), "published-shear-0.05"
    _, first = solved(verify, f"{name}-cold", "shear", "koiter", MESHES[-1], keys)
    pairs = []
    for nodes in MESHES:
        start = {**keys, "start.from": str(first), "start.perturbation": 0.0}
        known, folder = solved(
            verify, f"{name}-{nodes}-koiter", "shear", "koiter", nodes, {**start, **AT_REST}
        )
        start["start.from"] = str(folder)
        found, _ = solved(
            verify,
            f"{name}-{nodes}-stabilised",
            "shear",
            "koiter-published",
            nodes,
            {**start, **AT_REST_PUBLISHED},
        )
        for who, state in (("conservative", known), ("stabilised", found)):
            verify.equal(
                f"{who}, {nodes} nodes", state.status.value, "converged", "all meshes bear the state"
            )
        pairs.append((known, found))
    nodes = [known.grid.nodes for known, _ in pairs]
    relative = {
        "energy": [found.energy_N_mm["total"] / known.energy_N_mm["total"] - 1.0 for known, found in pairs],
        "shear reaction": [
            float(found.reactions["top"].force_N[0] / known.reactions["top"].force_N[0]) - 1.0
            for known, found in pairs
        ],
        "rms height": [rms(found.r[..., 2]) / rms(known.r[..., 2]) - 1.0 for known, found in pairs],
    }
    apart = [rms(found.r[..., 2] - known.r[..., 2]) / rms(known.r[..., 2]) for known, found in pairs]
    second = "both schemes are of second order: else a part of the difference would stay on all meshes"
    for quantity in ("energy", "shear reaction"):
        verify.above(
            f"order of the difference of the {quantity}", order(nodes, relative[quantity]), 1.8, second
        )
    verify.above("order of the rms of the difference of the heights", order(nodes, apart), 1.8, second)
    for quantity, limit in (("energy", 5e-4), ("shear reaction", 5e-4), ("rms height", 5e-3)):
        verify.below(
            f"difference of the {quantity}, extrapolated to zero mesh width",
            abs(at_zero_width(nodes, relative[quantity])),
            limit,
            "what is left is of higher order; heights are soft where energies and forces are firm",
        )
    costs = [
        conservative_energy(keys, found) / conservative_energy(keys, known) - 1.0 for known, found in pairs
    ]
    verify.above(
        "order of the conservative energy of the stabilised state above its least",
        order(nodes, costs),
        3.5,
        "a state that is off by the square of the mesh width costs its fourth power",
    )
    for (known, found), cost, count in zip(pairs, costs, nodes, strict=True):
        crests = [float(np.abs(state.r[..., 2]).max()) for state in (found, known)]
        verify.note(
            f"{count} nodes: difference of the largest height, a flap at a free corner",
            crests[0] / crests[1] - 1.0,
        )
        verify.note(f"{count} nodes: what that costs of the energy", cost)


def test_a_checkerboard_takes_the_shear_as_wrinkles_do(verify):
    """The filtered scheme, sheared by 0.05 mm: shear feeds a checkerboard as it feeds wrinkles, and it grows"""
    keys, nodes = sheared(0.05), 20000
    scene = load_scene("shear", {**keys, "mesh.nodes": nodes})
    for half_wavelength in (10.0, 15.0, 20.0):
        smooth, rough = energy_of_waves(scene, half_wavelength, "filtered")
        verify.below(
            f"{half_wavelength:g} mm: difference of the membrane energies",
            abs(float(rough[0] / smooth[0]) - 1.0),
            4e-4,
            "equal under shear alone; a shear strain of 3.9e-4 stretches the sheet by its square",
        )
        verify.below(
            f"{half_wavelength:g} mm: energy of the checkerboard over what waves gain",
            float(rough.sum() / abs(smooth.sum())),
            0.0,
            "it lowers the energy: nothing of the sheet holds it",
        )
        smooth, rough = energy_of_waves(scene, half_wavelength, "stabilised")
        verify.above(
            f"{half_wavelength:g} mm, stabilised: energy of the checkerboard over what waves gain",
            float(rough.sum() / abs(smooth.sum())),
            1.0,
            "hourglass stiffness makes a checkerboard cost more than waves gain",
        )
    _, folder = solved(verify, "published-shear-0.05-koiter", "shear", "koiter", nodes, keys)
    start = {**keys, "start.from": str(folder), "start.perturbation": 0.0, "solver.published": "filtered"}
    found, _ = solved(verify, "published-shear-0.05-filtered", "shear", "koiter-published", nodes, start)
    verify.equal("filtered", found.status.value, "hourglass", "the checkerboard grows, from right wrinkles")


def test_on_the_sheared_sheet_its_coarse_wrinkles_are_a_checkerboard(verify):
    """The published scheme on the sheet sheared by 0.5 mm, 5 nodes to a half-wave: what survives without control"""
    load, nodes, name = sheared(0.5), 10000, "published-shear-0.5"
    known, folder = solved(verify, f"{name}-koiter", "shear", "koiter", nodes, load)
    start = {**load, "start.from": str(folder), "start.perturbation": 0.0}
    found, cured = (
        solved(verify, f"{name}-{v}", "shear", "koiter-published", nodes, {**start, "solver.published": v})[0]
        for v in HEALTHY
    )
    verify.equal(
        "filtered", found.status.value, "hourglass", "a checkerboard grows, even from right wrinkles"
    )
    verify.equal("stabilised", cured.status.value, "converged", "hourglass stiffness holds it")
    verify.below(
        "stabilised: difference of the shear reaction",
        abs(float(cured.reactions["top"].force_N[0] / known.reactions["top"].force_N[0]) - 1.0),
        limit=5e-3,
        reason="forces are firm where heights are not",
    )
    heights = [float(np.abs(state.r[..., 2]).max()) for state in (cured, known)]
    verify.note("stabilised: difference of the largest height", heights[0] / heights[1] - 1.0)
    bending = [state.energy_N_mm["bending"] for state in (cured, known)]
    verify.note("stabilised: difference of the bending energy", bending[0] / bending[1] - 1.0)
