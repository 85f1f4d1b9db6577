"""Planar equilibria: the exact out-of-plane tangent, and classical buckling loads from its lowest eigenvalue."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from fdsolver import meshes, pencil, planar, stability
from fdsolver.edges import EdgeCondition
from fdsolver.effects import Force, build_force
from fdsolver.grid import Grid
from fdsolver.level import Level
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.planar import is_tense, lowest_out_of_plane
from fdsolver.problem import Problem
from fdsolver.relax import Settings, begin
from fdsolver.result import Status
from fdsolver.tangent import tangent as sparse_tangent
from tests.dense import tangent
from tests.sample_meshes import small_meshes

MESHES = small_meshes()
THICK = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=0.5)
SIDE = 20.0
WAVE = np.pi / SIDE  # of the half sine over the side


def rim(grid: Grid) -> np.ndarray:
    """(ni, nj) bool: nodes on any edge."""
    nodes = np.zeros((grid.ni, grid.nj), dtype=bool)
    for edge in grid.edges.values():
        nodes[tuple(edge.T)] = True
    return nodes


def uniform(grid: Grid, stretch_x: float, stretch_y: float) -> np.ndarray:
    """The sheet stretched uniformly in its plane, (3, ni, nj) scaled."""
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    return np.stack([stretch_x * x, stretch_y * y, 0.0 * x])


def held(grid: Grid, support: str, sheet: Sheet) -> Force:
    return build_force(grid, sheet, KOITER, dict.fromkeys(grid.edges, support))


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", [KOITER, MEMBRANE], ids=lambda model: model.name)
def test_sparse_tangent_is_the_out_of_plane_block_of_the_dense_one(model, name: str) -> None:
    """Open and closed meshes whose rows are no multiple of the groups' distance: nothing is mixed up."""
    grid = MESHES[name]
    force = build_force(grid, THICK, model, {})
    r = uniform(grid, 1.05, 0.97) + 0.01 * uniform(grid, 0.0, 1.0)[[1, 0, 2]]
    found = sparse_tangent(force, r, (2,), planar.STEP)
    expected = tangent(force, r)[2 * grid.nodes :, 2 * grid.nodes :]
    # the dense differences err by the square of their step over the cells', 1e-9
    np.testing.assert_allclose(
        found.matrix().toarray(), expected, rtol=0.0, atol=1e-7 * np.abs(expected).max()
    )
    # both signs, 5 x 5 groups, and up to 4 rows left over of a closed direction
    assert found.evaluations <= 2 * 81


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("stretch", [(1.02, 1.0), (0.99, 0.98), (1.05, 0.9)])
def test_value_and_mode_are_those_of_the_dense_eigenproblem(name: str, stretch: tuple[float, float]) -> None:
    grid = MESHES[name]
    fixed = rim(grid)
    force = held(grid, "pinned", THICK)
    r = uniform(grid, *stretch)
    found = lowest_out_of_plane(force, r, ~fixed, seed=0)
    assert found is not None
    value, mode, _ = found
    loose = np.flatnonzero(~fixed)
    stiffness, metric = (
        sparse_tangent(force, state, (2,), planar.STEP).matrix().toarray()[np.ix_(loose, loose)]
        for state in (r, planar._all_tense(force, r))
    )
    assert np.linalg.eigvalsh(metric).min() > 0.0
    values = eigh(stiffness, metric, eigvals_only=True)
    assert value == pytest.approx(values[0], rel=10 * pencil.ACCURACY, abs=1e-6)
    assert mode.max() == 1.0 or mode.min() == -1.0
    assert not mode[fixed].any()
    shape = mode.ravel()[loose]
    assert shape @ stiffness @ shape / (shape @ metric @ shape) == pytest.approx(value, rel=1e-6, abs=1e-6)


def test_a_stable_sheet_is_known_by_its_factor_and_an_unstable_one_takes_the_larger_shift(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    grid = MESHES["biased"]
    force = held(grid, "pinned", THICK)
    for stretch, small in (((0.9995, 1.0), True), ((0.98, 1.0), False)):
        found = {}
        for shifts in ((planar.SHIFTS[0],), (planar.SHIFTS[1],)):
            monkeypatch.setattr(planar, "SHIFTS", shifts)
            found[shifts[0]] = lowest_out_of_plane(force, uniform(grid, *stretch), ~rim(grid), 0)
            monkeypatch.undo()
        one, other = (found[shift] for shift in planar.SHIFTS)
        assert other is not None
        assert (one is not None) == small == (other[0] > 0.0)
        if one is not None:
            assert one[0] == pytest.approx(other[0], abs=5.0 * pencil.ACCURACY)
            np.testing.assert_allclose(one[1], other[1], atol=0.02)


@pytest.mark.parametrize(("bias", "nodes"), [(0.0, 1600), (1.0, 2500)])
@pytest.mark.parametrize("poisson", [-0.3, 0.0, 0.31, 0.5])
def test_square_plate_buckles_at_the_classical_strain(poisson: float, bias: float, nodes: int) -> None:
    """All edges simply supported and moved in uniformly along x: D (2 k^2)^2 = -(S_11 + S_22) h k^2."""
    sheet = Sheet(young_MPa=3500.0, poisson=poisson, thickness_mm=1.5)
    grid = meshes.rectangle(SIDE, SIDE, nodes, bias=bias)
    # S_11 + S_22 = Y E_11 / (1 - nu), D = Y h^3 / (12 (1 - nu^2)): Green's strain at the load
    critical = -4.0 * sheet.thickness_mm**2 * WAVE**2 / (12.0 * (1.0 + poisson))
    found = buckling_load(grid, sheet, "pinned", critical)
    print(f"simply supported, nu {poisson}, bias {bias}: buckles at {found:.4f} of the classical strain")
    assert found == pytest.approx(
        1.0, abs=0.003
    )  # the half wave has 39 or 49 cells: (pi / 39)^2 / 4 = 0.16 %


def test_clamped_square_plate_buckles_at_the_classical_strain() -> None:
    """All edges clamped, pressed along x alone (nu = 0): the load is 10.07 pi^2 D / a^2 (Levy 1942)."""
    sheet = Sheet(young_MPa=3500.0, poisson=0.0, thickness_mm=0.5)
    grid = meshes.rectangle(SIDE, SIDE, 2500)
    critical = -10.07 * WAVE**2 * sheet.thickness_mm**2 / 12.0
    found = buckling_load(grid, sheet, "clamped", critical)
    print(f"clamped: buckles at {found:.4f} of the classical strain")
    # the buckle is narrower than the plate; half of it has some 25 cells: (pi / 25)^2 / 4 = 0.4 %
    assert found == pytest.approx(1.0, abs=0.01)


def buckling_load(grid: Grid, sheet: Sheet, support: str, critical: float) -> float:
    """Load, over the critical strain, at which the lowest eigenvalue goes through zero."""
    force = held(grid, support, sheet)
    loads, lowest = np.array([0.9, 0.99, 1.01, 1.1]), []
    for load in loads:
        r = uniform(grid, np.sqrt(1.0 + 2.0 * load * critical), 1.0)
        found = lowest_out_of_plane(force, r, ~rim(grid), seed=0)
        assert found is not None
        lowest.append(found[0])
    return float(np.interp(0.0, -np.array(lowest), loads))


@pytest.mark.parametrize("thickness_mm", [0.02, 0.5])
def test_the_value_does_not_depend_on_mesh_or_thickness(thickness_mm: float) -> None:
    """Waves many cells long, sheets a thousand times longer than thick: the value falls from 1 to 0 at the load."""
    sheet = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=thickness_mm)
    critical = -4.0 * sheet.thickness_mm**2 * WAVE**2 / (12.0 * 1.31)
    values = []
    for nodes in (900, 10_000):
        grid = meshes.rectangle(SIDE, SIDE, nodes)
        force = held(grid, "pinned", sheet)
        for load in (0.5, 1.5):
            found = lowest_out_of_plane(
                force, uniform(grid, np.sqrt(1.0 + 2.0 * load * critical), 1.0), ~rim(grid), 0
            )
            assert found is not None
            values.append(found[0])
    # bending over bending with the added tension, TENSION times the load; on it another half wave may be lower
    assert values[0] == pytest.approx(values[2], abs=5e-3)
    assert values[1] == pytest.approx(values[3], abs=5e-3)
    assert values[0] > 0.2
    assert values[1] < -0.1


def test_sheet_in_tension_is_as_stable_as_can_be() -> None:
    grid = MESHES["hole"]
    found = lowest_out_of_plane(held(grid, "pinned", THICK), uniform(grid, 1.1, 1.05), ~rim(grid), 0)
    assert found is not None
    assert found[0] == pytest.approx(1.0, abs=1e-6)  # less the little that keeps B definite


def test_flat_unstressed_sheet_on_one_support_turns_freely() -> None:
    """A plate pinned along one edge can turn about it: the lowest value is zero, neither stable nor not."""
    grid = MESHES["uniform"]
    free = np.ones((grid.ni, grid.nj), dtype=bool)
    free[tuple(grid.edges["left"].T)] = False
    found = lowest_out_of_plane(
        build_force(grid, THICK, KOITER, {"left": "pinned"}), uniform(grid, 1.0, 1.0), free, 0
    )
    assert found is not None
    assert abs(found[0]) < 1e-3
    x = grid.u[..., 0] - grid.u[0, 0, 0]
    np.testing.assert_allclose(found[1], x / x.max(), atol=1e-3)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize(("across", "tense"), [(1.0 - 1e-9, False), (1.0, True), (1.02, True)])
def test_a_sheet_is_tense_where_no_stress_is_below_zero(name: str, across: float, tense: bool) -> None:
    """Pulled along x, the stress across is (E2 + nu E1) Y / (1 - nu^2): zero at E2 = -nu E1."""
    grid = MESHES[name]
    force = held(grid, "pinned", THICK)
    pull = 1.05
    free = np.sqrt(1.0 - THICK.poisson * (pull**2 - 1.0))
    r = uniform(grid, pull, free * across * (1.0 + 1e-15))
    assert is_tense(force, r) is tense
    assert is_tense(build_force(grid, THICK, replace(KOITER, out_of_plane=False), {}), r[:2]) is tense
    found = lowest_out_of_plane(force, r, ~rim(grid), 0)
    assert found is not None
    if tense:
        assert found[0] == pytest.approx(1.0, abs=1e-3)  # B has a strain of 1e-9 more


@pytest.mark.parametrize("model", [KOITER, replace(KOITER, out_of_plane=False)], ids=["space", "plane"])
def test_a_strip_that_is_pulled_is_stable_without_any_eigenvalue(
    model: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object) -> None:
        raise AssertionError("nothing is to be solved")

    monkeypatch.setattr(stability, "lowest_out_of_plane", never)
    grid = meshes.rectangle(SIDE, 0.4 * SIDE, 400)
    pull = {"left": (0.0, 0.0, 0.0), "right": (0.02 * SIDE, 0.0, 0.0)}
    edges = {name: EdgeCondition("pinned", move_mm=move) for name, move in pull.items()}
    sheet = replace(THICK, poisson=0.0)
    level = Level(Problem(sheet, edges, grid, lambda n: grid, perturbation=0.0), model, grid, threads=1)
    status, verdict = stability.relax_to_stable(level, begin(level.start()), Settings(tolerance=1e-9))
    assert status is Status.CONVERGED
    assert verdict == {"stable": True, "how": stability.HELD_FLAT, "lowest": 1.0}


def test_a_sheet_under_moderate_rotations_is_left_to_the_eigenvalue() -> None:
    """Where Green's strain has no compression left at a large pull, the linear one has."""
    grid = MESHES["uniform"]
    force = build_force(grid, THICK, replace(KOITER, moderate=True), dict.fromkeys(grid.edges, "pinned"))
    assert not is_tense(force, uniform(grid, 1.1, 1.1))


def test_meshes_too_large_and_without_free_nodes_are_left_to_others(monkeypatch: pytest.MonkeyPatch) -> None:
    grid = MESHES["uniform"]
    force, r = held(grid, "pinned", THICK), uniform(grid, 1.0, 1.0)
    assert lowest_out_of_plane(force, r, np.zeros((grid.ni, grid.nj), dtype=bool), 0) is None
    monkeypatch.setattr(planar, "MOST_NODES", 50)
    assert lowest_out_of_plane(force, r, ~rim(grid), 0) is None


def test_the_start_is_repeatable() -> None:
    grid = MESHES["biased"]
    force, r = held(grid, "pinned", THICK), uniform(grid, 0.98, 1.0)
    first, second, other = (lowest_out_of_plane(force, r, ~rim(grid), seed) for seed in (1, 1, 2))
    assert first is not None and second is not None and other is not None
    np.testing.assert_array_equal(first[1], second[1])
    assert other[0] == pytest.approx(first[0], rel=10 * pencil.ACCURACY)
