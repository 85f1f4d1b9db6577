"""Half, quarter and sector meshes: the force and energy of the whole sheet's symmetric states, at part of the cost."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.linalg import eigh

from fdsolver import meshes
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid, GridError
from fdsolver.mass import SAFETY, invert, nodal_masses
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.multilevel import solve
from fdsolver.problem import Problem
from fdsolver.reduced import ReducedLevel
from fdsolver.reduction import reduction
from fdsolver.relax import Settings, begin
from fdsolver.result import Status
from fdsolver.stability import search
from fdsolver.symmetry import Symmetry, refuse_unsymmetric
from tensionfield.relaxed import TENSION_FIELD
from tests.dense import frequencies, mass_matrix, tangent

SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=5.0)  # thick: bending forces like the membrane's
FREE = EdgeCondition()
PULL = {
    "left": EdgeCondition("clamped", (-1.0, 0.0, 0.0)),
    "right": EdgeCondition("clamped", (3.0, 0.0, 0.0)),  # pulled by 4, and the sheet moved by 1
    "top": FREE,
    "bottom": FREE,
}
TWIST = {"inner": EdgeCondition("clamped", (0.0, 0.0, 40.0), 30.0), "outer": EdgeCondition("pinned")}
MODELS = {
    "koiter": KOITER,
    "e3": dataclasses.replace(KOITER, strain_gradient=False),
    "tension field": TENSION_FIELD,
    "plane": dataclasses.replace(MEMBRANE, out_of_plane=False),
    "plane plate": dataclasses.replace(KOITER, out_of_plane=False),
}
MIRRORED = [
    Symmetry(reduce, parity) for reduce in ("half-x", "half-y", "quarter") for parity in ("even", "odd")
]


def rectangle(nodes: int) -> Grid:
    return meshes.rectangle(20.0, 12.0, nodes, bias=1.0)


def hole(nodes: int) -> Grid:
    return meshes.rectangle_with_hole(125.0, 50.0, 15.0, nodes)


def annulus(nodes: int) -> Grid:
    return meshes.annulus(60.0, 250.0, nodes, sectors=3)


CASES = [
    *((rectangle, PULL, symmetry) for symmetry in MIRRORED),
    *((hole, {**PULL, "hole": FREE}, symmetry) for symmetry in MIRRORED),
    *((annulus, TWIST, Symmetry("sector", sectors=sectors)) for sectors in (3, 6, 0)),
]


def level_of(make, edges, symmetry: Symmetry, model: Model, nodes: int = 150) -> ReducedLevel:
    grid = make(nodes)
    problem = Problem(SHEET, edges, grid, make, perturbation=0.0, symmetry=symmetry)
    return ReducedLevel(problem, model, grid, 1)


def symmetric_state(level: ReducedLevel) -> np.ndarray:
    """The start with random displacements that keep the symmetry, on the part."""
    start = level.start()
    noise = 0.02 * np.random.default_rng(1).standard_normal(start.shape)
    return level.scaled(level.unscaled(start + noise))


@pytest.mark.parametrize("model", MODELS)
def test_force_and_energy_are_those_of_the_whole_sheet(model: str) -> None:
    for make, edges, symmetry in CASES:
        level = level_of(make, edges, symmetry, MODELS[model])
        r = symmetric_state(level)
        whole_r = level.whole.scaled(level.unscaled(r))
        f, whole_f = np.full_like(r, np.nan), np.full_like(whole_r, np.nan)
        energy, whole_energy = level.force(r, f), level.whole.force(whole_r, whole_f)
        # on a mirror line the part has its share of the force, and none where the line holds
        expected = np.stack([level.cut.restrict(component) for component in whole_f]) * level.cut.node_share
        name = f"{make.__name__} {symmetry}"
        np.testing.assert_allclose(f, expected, rtol=0, atol=1e-13 * np.abs(whole_f).max(), err_msg=name)
        np.testing.assert_allclose(
            level.cut.copies * energy, whole_energy, rtol=1e-12, atol=1e-13 * whole_energy.sum(), err_msg=name
        )


def test_a_part_is_its_share_of_the_mesh_and_a_few_ghost_lines() -> None:
    whole = rectangle(10_000)
    cut = reduction(whole, Symmetry("quarter"))
    assert cut.part.ni == whole.ni // 2 + 2
    assert cut.part.nj == whole.nj // 2 + 2
    assert cut.part.nodes < 0.27 * whole.nodes
    ring = meshes.annulus(62.5, 250.0, 10_000)
    assert reduction(ring, Symmetry("sector")).part.ni == 3


@pytest.mark.parametrize("model", ["koiter", "e3"])
def test_no_frequency_exceeds_the_bound(model: str) -> None:
    for make, edges, symmetry in CASES:
        level = level_of(make, edges, symmetry, MODELS[model], nodes=110)
        r = symmetric_state(level)
        mass = nodal_masses(level.force, r, r, level.force.relaxed)
        largest = frequencies(level.force, r, mass, level.cut.node_share > 0.0)[-1]
        assert largest <= 4.0 / SAFETY * (1.0 + 1e-5), (make, symmetry)  # rounding of the differences


@pytest.mark.parametrize(
    ("make", "edges", "symmetry", "model"),
    [
        (rectangle, PULL, Symmetry("quarter"), TENSION_FIELD),
        (annulus, TWIST, Symmetry("sector", sectors=0), TENSION_FIELD),
    ],
    ids=["quarter", "axisymmetric"],
)
def test_a_reduced_run_ends_where_the_whole_run_ends(make, edges, symmetry, model) -> None:
    """Same equilibrium, energy and reactions of the whole sheet, and shown on the whole sheet."""
    grid = make(500)
    whole, part = (
        solve(
            Problem(SHEET, edges, grid, make, perturbation=0.0, symmetry=kept),
            model,
            Settings(tolerance=1e-10, levels=1),
        )
        for kept in (None, symmetry)
    )
    assert whole.status is part.status is Status.CONVERGED
    # the residual of the whole sheet, to which the part's solution is unfolded
    assert part.residual < 2e-10
    # a residual of 1e-10 per cell, times as many cells as lie across the sheet
    np.testing.assert_allclose(part.r, whole.r, rtol=0, atol=1e-7 * grid.length_mm)
    assert part.energy_N_mm["total"] == pytest.approx(whole.energy_N_mm["total"], rel=1e-9)
    for name, reaction in whole.reactions.items():
        size = max(np.abs(other.force_N).max() for other in whole.reactions.values())
        np.testing.assert_allclose(part.reactions[name].force_N, reaction.force_N, rtol=0, atol=1e-6 * size)


@pytest.mark.parametrize(
    ("symmetry", "edges", "shape", "why"),
    [
        (
            Symmetry("half-x"),
            {**PULL, "right": EdgeCondition("pinned", (1.0, 0.0, 0.0))},
            "rectangle",
            "left and",
        ),
        (
            Symmetry("half-x"),
            {**PULL, "right": EdgeCondition("clamped", (1.0, 0.5, 0.0))},
            "rectangle",
            "about x",
        ),
        (
            Symmetry("half-y"),
            {**PULL, "left": EdgeCondition("clamped", (0.0, 1.0, 0.0))},
            "rectangle",
            "right is",
        ),
        (
            Symmetry("half-y", "odd"),
            {**PULL, "left": EdgeCondition("clamped", (0, 0, 1.0))},
            "rectangle",
            "odd",
        ),
        (
            Symmetry("half-x"),
            {**PULL, "right": EdgeCondition("clamped", (1.0, 0, 0), 5.0)},
            "rectangle",
            "about x",
        ),
        (Symmetry("sector"), {**TWIST, "inner": EdgeCondition("pinned", (1.0, 0, 0))}, "annulus", "sideways"),
        (Symmetry("sector"), PULL, "rectangle", "for an annulus"),
    ],
)
def test_loads_without_the_symmetry_are_refused(symmetry, edges, shape: str, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        refuse_unsymmetric(symmetry, edges, shape, 20.0)


def test_symmetric_loads_are_taken() -> None:
    refused = []
    for make, edges, symmetry in CASES:
        grid = make(500)
        try:
            refuse_unsymmetric(symmetry, edges, grid.shape, grid.length_mm)
        except ValueError as why:
            refused.append(f"{symmetry}: {why}")
    assert not refused and len(CASES) > 5


def test_sectors_must_divide_the_rows() -> None:
    with pytest.raises(GridError, match="7 sectors do not divide the"):
        reduction(meshes.annulus(60.0, 250.0, 1000), Symmetry("sector", sectors=7))


@pytest.mark.parametrize("symmetry", MIRRORED, ids=str)
def test_the_search_for_instability_knows_what_a_mirror_line_holds(symmetry: Symmetry) -> None:
    """The lowest value of the Lanczos search is that of the dense tangent, whatever component the line holds."""
    level = level_of(rectangle, PULL, symmetry, KOITER, nodes=110)
    r = level.start()
    state = begin(r)
    state.mass = nodal_masses(level.force, r, r, level.force.relaxed)
    invert(state.mass.reshape(6, -1), ~level.fixed.reshape(-1), state.inverse_mass.reshape(6, -1))
    level.force.hold(state.inverse_mass)
    found = search(level.force, state)
    free = (state.inverse_mass[:3] > 0.0).ravel()
    pair = [matrix[np.ix_(free, free)] for matrix in (tangent(level.force, r), mass_matrix(state.mass))]
    lowest = float(eigh(*pair, eigvals_only=True)[0])
    # a Ritz value is never below the lowest eigenvalue but for the rounding of differences; the search goes on until it
    # settles, not until it is exact
    assert lowest * (1.0 - 1e-4) <= found.lowest <= 1.3 * lowest


def test_the_finisher_refuses_a_part_of_a_sheet() -> None:
    grid = rectangle(150)
    problem = Problem(SHEET, PULL, grid, rectangle, perturbation=0.0, symmetry=Symmetry("quarter"))
    with pytest.raises(ValueError, match="the finisher solves whole meshes only"):
        solve(problem, KOITER, Settings(finish="on"))
