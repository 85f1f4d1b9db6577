"""The paper's own scheme beside the conservative one: equal on healthy meshes, named failures on the others."""

from __future__ import annotations

import numpy as np
import pytest

from cases import load_scene
from cases.envelope import envelope
from cases.probe import sample_section
from fdsolver.result import Solution
from tests.benchmarks.checkerboard import least_stress_across, spread_of_envelope
from tests.benchmarks.published_runs import HEALTHY, pulled, solved

UNIFORM = {"mesh.bias": 0.0}
LONG_CELLS = {"mesh.cell_ratio": 3.0}  # three times as long along the pull
# A start as high as the sheet is thick: between lower ones and the checkerboard stand the wrinkles.
HIGH_START = {"start.perturbation": 1e-3}
# Where there are no wrinkles a checkerboard grows so slowly that a relaxation may end before it shows.
PATIENT = {**HIGH_START, "solver.tolerance": 1e-10}


def height(solution: Solution) -> np.ndarray:
    """Heights across the middle, mm."""
    return sample_section(solution.grid, solution.r, load_scene("stretch").sections["midsection"]).z


@pytest.mark.parametrize(
    ("load", "keys", "nodes"),
    [
        (pulled(10.0), {}, 6000),
        (pulled(10.0), {}, 12000),
        (pulled(10.0), {}, 24000),
        (pulled(10.0), UNIFORM, 6000),
        (pulled(5.0), {}, 12000),
        (pulled(20.0), UNIFORM, 12000),
    ],
    ids=["10", "10-fine", "10-finest", "10-uniform", "5", "20-uniform"],
)
def test_on_healthy_meshes_it_gives_the_same_wrinkles(verify, load, keys, nodes):
    """The published scheme from the conservative scheme's wrinkles: where it comes to rest on a healthy mesh"""
    name = f"published-stretch-{load['edges.top.move_mm'][1]:g}-{nodes}" + ("-uniform" if keys else "")
    verify.note("scene, movement of the upper edge (mm), nodes", name.removeprefix("published-"))
    known, folder = solved(verify, f"{name}-koiter", "stretch", "koiter", nodes, {**load, **keys})
    verify.equal("conservative scheme", known.status.value, "converged", "there is to be a partner")
    start = {"start.from": str(folder), "start.perturbation": 0.0}
    crest = float(np.abs(known.r[..., 2]).max())
    for variant in HEALTHY:
        ours = {**load, **keys, **start, "solver.published": variant}
        found, _ = solved(verify, f"{name}-{variant}", "stretch", "koiter-published", nodes, ours)
        verify.equal(variant, found.status.value, "converged", "the mesh is a healthy one")
        verify.below(
            f"{variant}: difference of the largest height",
            abs(float(np.abs(found.r[..., 2]).max()) / crest - 1.0),
            limit=5e-3,
            reason="both are of second order, and differ by the metric without strain of (65) besides",
        )
        verify.below(
            f"{variant}: difference of the bending energy",
            abs(found.energy_N_mm["bending"] / known.energy_N_mm["bending"] - 1.0),
            limit=1e-2,
            reason="it goes with the square of the height",
        )
        verify.note(
            f"{variant}: CPU seconds of a force over the conservative one's",
            _of_a_force(found) / _of_a_force(known),
        )


def _of_a_force(solution: Solution) -> float:
    return solution.cpu_seconds / solution.force_evaluations


def test_cold_starts_have_the_same_envelope(verify):
    """Published and conservative scheme from random starts at 10 %: the same wrinkles but for their phase"""
    load, nodes = pulled(10.0), 12000
    known, _ = solved(verify, "published-cold-koiter", "stretch", "koiter", nodes, load)
    crest = float(envelope(height(known)).max())
    for variant in HEALTHY:
        keys = {**load, "solver.published": variant}
        found, _ = solved(verify, f"published-cold-{variant}", "stretch", "koiter-published", nodes, keys)
        verify.equal(variant, found.status.value, "converged", "the mesh is a healthy one")
        verify.below(
            f"{variant}: difference of the envelope's height",
            abs(float(envelope(height(found)).max()) / crest - 1.0),
            limit=5e-3,
            reason="as on the same phase: the envelope depends on it by some thousandths",
        )
        verify.note(
            f"{variant}: CPU seconds over the conservative one's", found.cpu_seconds / known.cpu_seconds
        )


@pytest.mark.parametrize("nodes", [1500, 6000, 24000])
def test_as_printed_its_ghost_rows_grow_without_bound(verify, nodes):
    """The published scheme as printed, 10 %: the ghost update (74) blows up on every mesh, and the run says so"""
    keys = {**pulled(10.0), "solver.published": "printed"}
    verify.note("nodes", nodes)
    found, _ = solved(verify, f"published-printed-{nodes}", "stretch", "koiter-published", nodes, keys)
    verify.equal("status", found.status.value, "diverged", "short waves of the ghosts grow for nu > 0")
    named = "ghost rows of the edges" in found.message and "(74)" in found.message
    verify.equal(
        "the message names the ghost rows and (74)", str(named), "True", "a failure is to say its cause"
    )
    verify.note("steps until it is given up", found.steps)


@pytest.mark.parametrize(
    ("name", "percent", "keys", "nodes"),
    [
        ("long cells, 10 %", 10.0, LONG_CELLS, 6000),
        ("square cells, 20 %", 20.0, {**UNIFORM, **HIGH_START}, 8000),
    ],
    ids=["long-cells-10", "square-cells-20"],
)
def test_without_hourglass_control_it_converges_to_a_checkerboard(verify, name, percent, keys, nodes):
    """The published scheme without hourglass stiffness: states of pure checkerboard, converged and named"""
    load = {**pulled(percent), **keys}
    verify.note("case", f"{name}, {nodes} nodes")
    label = f"published-checkerboard-{name.replace(' %', '').replace(', ', '-').replace(' ', '-')}"
    found, _ = solved(
        verify,
        f"{label}-filtered",
        "stretch",
        "koiter-published",
        nodes,
        {**load, "solver.published": "filtered"},
    )
    verify.below("residual", found.residual, 1e-8, "it is an equilibrium of the scheme: only the shape tells")
    verify.equal("status", found.status.value, "hourglass", "a checkerboard is no deformation of the sheet")
    share = found.hourglass["out_of_plane"]
    verify.above(
        "share of the checkerboard", 0.0 if share is None else share, 1.0, "more of it than of the sheet"
    )
    named = "the published scheme does not see it" in found.message
    verify.equal("the message says why", str(named), "True", "a failure is to say its cause")
    known, _ = solved(verify, f"{label}-koiter", "stretch", "koiter", nodes, load)
    cured, _ = solved(
        verify,
        f"{label}-stabilised",
        "stretch",
        "koiter-published",
        nodes,
        {**load, "solver.published": "stabilised"},
    )
    for who, state in (("conservative", known), ("with hourglass stiffness", cured)):
        verify.equal(f"{who}: status", state.status.value, "converged", "the same mesh, load and start")
        verify.below(
            f"{who}: share of the checkerboard",
            float(state.hourglass["out_of_plane"] or 0.0),
            0.1,
            "it is seen there",
        )
    verify.note("rms height of the checkerboard over that of the wrinkles", _rms(found) / _rms(known))
    verify.note("rms height with hourglass stiffness over the conservative one", _rms(cured) / _rms(known))


@pytest.mark.parametrize(
    ("percent", "thickness", "nodes"),
    [(20.0, 0.14, 6000), (20.0, 0.14, 15000), (20.0, 0.2, 15000), (30.0, 0.14, 15000)],
)
def test_sheets_too_thick_to_wrinkle_are_left_to_the_checkerboard(verify, percent, thickness, nodes):
    """The published scheme on strips that stay flat: a checkerboard grows where the strip is compressed at all"""
    load = {**pulled(percent), **PATIENT, "sheet.thickness_mm": thickness}
    name = f"published-flat-{percent:g}-{thickness:g}-{nodes}"
    verify.note("pull (%), thickness (mm), nodes", name.removeprefix("published-flat-"))
    known, _ = solved(verify, f"{name}-koiter", "stretch", "koiter", nodes, load)
    verify.equal("conservative scheme", known.status.value, "converged", "there is to be a partner")
    verify.equal(
        "conservative scheme: stable", str(known.stability["stable"]), "True", "it is to be the truth"
    )
    flat = "the sheet is too thick to wrinkle, or not compressed"
    verify.below("conservative scheme: largest height", _crest(known), 1e-2 * thickness, flat, "mm")
    stress = least_stress_across(known)
    verify.note("least stress across the pull, mean over the width", stress, "MPa")
    found, cured = (
        solved(verify, f"{name}-{v}", "stretch", "koiter-published", nodes, {**load, "solver.published": v})[
            0
        ]
        for v in HEALTHY
    )
    due = "hourglass" if stress < 0.0 else "converged"
    verify.equal("filtered", found.status.value, due, "compression feeds it and no tension holds it")
    if due == "hourglass":
        verify.below(
            "filtered: spread of the checkerboard's envelope across the strip",
            spread_of_envelope(found),
            0.1,
            "only an envelope that is uniform across escapes the tension; but for the edges",
        )
    verify.equal("stabilised", cured.status.value, "converged", "hourglass stiffness holds a checkerboard")
    verify.below("stabilised: largest height", _crest(cured), 1e-2 * thickness, "flat as the partner", "mm")


def _crest(solution: Solution) -> float:
    return float(np.abs(solution.r[..., 2]).max())


def _rms(solution: Solution) -> float:
    return float(np.sqrt(np.mean(solution.r[..., 2] ** 2)))
