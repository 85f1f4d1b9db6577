"""Error estimates: on sequences whose limit is known, and on the runs of a sheet whose solution is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cases import load_scene, run
from cases.errors import SAFETY_TWO_MESHES, SHARE, discretisation_error, errors_of
from cases.quantities import quantities
from cases.results import read_document
from fdsolver.meshes import rectangle
from fdsolver.result import Reaction
from tests.cases.made import SHEET, made_solution

ZONES = [400, 1600, 6400]


@pytest.fixture(scope="module", name="nested")
def _nested(tmp_path_factory):
    """A lifted annulus on three nested meshes, and the folder of its result."""
    out = tmp_path_factory.mktemp("runs") / "annulus"
    scene = load_scene("annulus-lift", {"solver.levels": 3})
    return run(scene, "tension-field", nodes=6500, out=out), scene, out


def sequence(order, limit=2.0, size=0.3):
    return [limit + size * (400 / zones) ** (order / 2) for zones in ZONES]


@pytest.mark.parametrize("order", [0.8, 1.0, 1.5, 2.0])
def test_a_power_law_is_estimated_with_the_stated_safety(order):
    values = sequence(order)
    error, observed, how = discretisation_error(ZONES, values)
    # 1e-9: three values of 16 digits, differences of 1e-2
    assert observed == pytest.approx(order, rel=1e-9)
    assert error == pytest.approx(1.25 * abs(values[-1] - 2.0), rel=1e-9)
    assert "order observed" in how


def test_an_order_above_the_scheme_is_not_believed():
    values = sequence(4.0)
    error, observed, _ = discretisation_error(ZONES, values, formal=2.0)
    assert observed == pytest.approx(4.0, rel=1e-9)
    # order 2 on meshes of ratio 2: a third of the last change, times the safety factor
    assert error == pytest.approx(1.25 * abs(values[-1] - values[-2]) / 3.0, rel=1e-9)


@pytest.mark.parametrize("values", [[1.0, 1.2, 1.1], [1.0, 1.1, 1.3], [1.0, 1.1, 1.19]])
def test_a_sequence_that_is_not_asymptotic_is_refused(values):
    error, order, how = discretisation_error(ZONES, values)
    assert error is None and order is None
    assert how.startswith("refused: the values")


def test_two_meshes_earn_the_larger_safety_factor():
    values = sequence(2.0)[1:]
    error, order, how = discretisation_error(ZONES[1:], values)
    assert order is None and "assumed" in how
    assert error == pytest.approx(SAFETY_TWO_MESHES * abs(values[-1] - 2.0), rel=1e-9)


def test_differences_below_the_iteration_error_are_no_order():
    error, order, how = discretisation_error(ZONES, [1.0, 1.0 + 2e-9, 1.0 - 1e-9], noise=1e-8)
    assert (error, order) == (1e-8, None)
    assert how == "the meshes agree to the iteration error"


def test_one_mesh_is_refused_with_the_reason():
    assert discretisation_error(ZONES[:1], [1.0]) == (None, None, "refused: there is one mesh alone")
    scene = load_scene("strip-tension")
    solution = run(scene, "membrane", nodes=500)
    estimates = errors_of(solution, scene)
    assert estimates and all(e.discretisation is None and "one mesh alone" in e.how for e in estimates)


def test_meshes_of_another_thickness_are_not_compared(nested):
    solution, scene, _ = nested
    thicker = replace(solution.sheet, thickness_mm=4.0 * solution.sheet.thickness_mm)
    coarser = (replace(solution.coarser[0], sheet=thicker), *solution.coarser[1:])
    estimates = errors_of(replace(solution, coarser=coarser), scene)
    assert all(e.discretisation is None and "thicker sheet" in e.how for e in estimates)


def test_every_result_carries_its_errors(nested):
    solution, scene, out = nested
    stored = {entry["quantity"]: entry for entry in read_document(out)["errors"]}
    assert {
        "energy_N_mm.total",
        "reactions.inner.force_N.z",
        "stretch.major_max",
        "out_of_plane_mm.rms",
    } <= set(stored)
    assert set(next(iter(stored.values()))) == {
        "quantity",
        "value",
        "discretisation",
        "iteration",
        "order",
        "how",
        "limit",
    }
    assert stored["energy_N_mm.total"]["value"] == solution.energy_N_mm["total"]
    # the iteration error is the smaller part, or the tolerance were the wrong one
    for entry in stored.values():
        assert entry["iteration"] <= SHARE * entry["discretisation"] or entry["discretisation"] < 1e-12


def test_the_true_error_is_inside_the_estimate(nested):
    solution, scene, _ = nested
    exact = run(scene, "exact", nodes=6500)
    estimates = {estimate.quantity: estimate for estimate in errors_of(solution, scene)}
    for name, truth in {
        "energy_N_mm.total": exact.energy_N_mm["total"],
        "reactions.inner.force_N.z": exact.reactions["inner"].force_N[2],
        "reactions.outer.force_N.z": exact.reactions["outer"].force_N[2],
    }.items():
        estimate = estimates[name]
        error = abs(estimate.value - truth)
        assert estimate.order == pytest.approx(2.0, abs=0.3), name  # the scheme is of second order
        # within a factor of 5, as a bound that is useful; below, the true error were outside
        assert error <= estimate.total <= 5.0 * error, name
        # of second order on meshes of which each is twice as fine: what is left is of fourth, or from the order
        assert abs(estimate.limit - truth) < 0.25 * error, name


@pytest.mark.parametrize("tolerance", [1e-5, 1e-7])
def test_the_iteration_error_tells_what_further_iterations_change(tolerance):
    scene = load_scene("annulus-lift")
    loose = errors_of(run(scene, "tension-field", nodes=900, tolerance=tolerance), scene)
    tight = quantities(run(scene, "tension-field", nodes=900, tolerance=1e-12), scene)
    named = {estimate.quantity: estimate for estimate in loose}
    for name in (
        "energy_N_mm.total",
        "reactions.inner.force_N.z",
        "stretch.major_max",
        "out_of_plane_mm.rms",
    ):
        change = abs(named[name].value - tight[name])
        assert 0.0 < change <= named[name].iteration, name
    # and it is no wild exaggeration: loads are of first order in the displacements, the safety factor is 3
    force = named["reactions.inner.force_N.z"]
    assert force.iteration <= 10.0 * abs(force.value - tight[force.quantity])


def test_a_run_at_rest_from_its_start_is_as_wrong_as_its_residual_allows():
    scene = load_scene("strip-tension", {"solver.levels": 2})
    solution, exact = run(scene, "koiter", nodes=6400), run(scene, "exact", nodes=6400)
    assert solution.steps == 0
    named = {estimate.quantity: estimate for estimate in errors_of(solution, scene)}
    force = named["reactions.right.force_N.x"]
    error = abs(force.value - exact.reactions["right"].force_N[0])
    # the pull is a sum over the edge of forces that are wrong by the residual; 1e-6 would be no estimate any more
    assert 0.0 < error <= force.total <= 1e-6 * force.value


def test_what_balances_to_zero_is_no_quantity():
    grid = rectangle(100.0, 50.0, 500)
    solution = made_solution(grid, height=lambda x, y: 0.0 * x)
    stiffness = SHEET.young_MPa * SHEET.thickness_mm * grid.length_mm
    left = Reaction(np.array([-1.0, 1e-8, 0.0]) * stiffness * 1e-3, np.zeros(3))
    balanced = Reaction(np.full(3, 1e-12) * stiffness, np.zeros(3))
    scene = load_scene("strip-tension")
    names = quantities(replace(solution, reactions={"left": left}), scene)
    assert "reactions.left.force_N.x" in names and "reactions.left.force_N.y" not in names
    assert not any(
        name.startswith("reactions")
        for name in quantities(replace(solution, reactions={"left": balanced}), scene)
    )
    assert "out_of_plane_mm.max_abs" not in names, "a plane sheet has no height"


def test_the_height_of_the_highest_node_is_refused_where_it_moves():
    def wave(x, y):
        return np.sin(0.11 * x + 0.3)

    def falling(x, y):  # heights whose sequence looks like one of first order in the nodes
        return (1.0 + 2000.0 / x.size) * wave(x, y)

    grids = [rectangle(100.0, 50.0, nodes) for nodes in (500, 2000, 8000)]
    apart = [made_solution(grid, falling) for grid in grids]
    found = errors_of(
        replace(apart[-1], coarser=tuple(apart[:-1])), load_scene("strip-tension", {"paths": {}})
    )
    refused = next(e for e in found if e.quantity == "out_of_plane_mm.max_abs")
    assert refused.how == "refused: no node stands on the crest, on any of the meshes"
    states = [made_solution(grid, wave) for grid in grids]
    scene = load_scene("strip-tension", {"paths": {}})
    estimates = {e.quantity: e for e in errors_of(replace(states[-1], coarser=tuple(states[:-1])), scene)}
    assert estimates["out_of_plane_mm.max_abs"].discretisation is None
    # meshes that have the same highest node agree, and are wrong together
    together = [made_solution(rectangle(100.0, 50.0, 500), wave)] * 3
    agreed = errors_of(replace(together[-1], coarser=tuple(together[:-1])), scene)
    assert next(e for e in agreed if e.quantity == "out_of_plane_mm.max_abs").total is None
    # the rms height is an integral: over the width by its antiderivative
    square = 0.5 - (np.sin(2.0 * (5.5 + 0.3)) - np.sin(2.0 * (-5.5 + 0.3))) / (4.0 * 0.11 * 100.0)
    rms = estimates["out_of_plane_mm.rms"]
    assert abs(rms.value - np.sqrt(square)) <= rms.total


def test_the_height_of_a_placed_edge_is_exact(nested):
    solution, scene, _ = nested
    lifted = next(e for e in errors_of(solution, scene) if e.quantity == "out_of_plane_mm.max_abs")
    assert (lifted.value, lifted.discretisation) == (125.0, 0.0)
