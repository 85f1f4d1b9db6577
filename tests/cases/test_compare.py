"""Comparisons: differences with their units, slack masked, refusals kept, one folder per method."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cases import compare, load_result, load_scene
from cases.compare import Comparison, method_row, path_difference
from cases.methods import METHODS, MethodError, Task
from cases.results import Probes, probe
from fdsolver import meshes
from fdsolver.result import Reaction, Solution, Status
from tests.cases.made import Fake, made_solution

S = np.linspace(0.0, 10.0, 501)


def path(stretch: np.ndarray, state: np.ndarray | int = 2, s: np.ndarray = S) -> dict[str, np.ndarray]:
    return {"s_mm": s, "stretch_major": stretch, "state": np.broadcast_to(state, s.shape)}


def test_the_difference_along_a_path() -> None:
    """a = 2 + 0.1 s / 10 against b = 2: L2 is 0.1 / sqrt(3) / 2, the largest 0.1."""
    l2, largest = path_difference(path(2.0 + 0.01 * S), path(np.full_like(S, 2.0)), "stretch_major")
    # Trapezoids on 500 steps: relative error 1 / (2 * 500^2).
    assert l2 == pytest.approx(0.1 / np.sqrt(3.0) / 2.0, rel=1e-4)
    assert largest == pytest.approx(0.1, rel=1e-12)


def test_the_difference_does_not_depend_on_how_rows_are_spaced() -> None:
    crowded = 10.0 * np.linspace(0.0, 1.0, 2001) ** 2
    l2, _ = path_difference(
        path(2.0 + 0.01 * crowded, s=crowded), path(np.full_like(crowded, 2.0), s=crowded), "stretch_major"
    )
    assert l2 == pytest.approx(0.1 / np.sqrt(3.0) / 2.0, rel=1e-3)


@pytest.mark.parametrize("slack", ["ours", "theirs"])
def test_slack_places_do_not_enter(slack: str) -> None:
    """Beyond s = 5 one of the two is slack, and its stretch is nonsense there."""
    state = np.where(S > 5.0, 0, 2)
    ours = np.where(S > 5.0, 77.0, 2.001)
    theirs = np.full_like(S, 2.0)
    if slack == "ours":
        l2, largest = path_difference(path(ours, state), path(theirs), "stretch_major")
    else:
        l2, largest = path_difference(path(ours), path(theirs, state), "stretch_major")
    assert l2 == pytest.approx(0.0005, rel=1e-9)
    assert largest == pytest.approx(0.001, rel=1e-9)


def test_slack_all_along_has_no_difference() -> None:
    stretch = np.full_like(S, 2.0)
    assert path_difference(path(stretch, 0), path(stretch), "stretch_major") == (None, None)


def test_rows_at_other_places_are_interpolated_and_slack_neighbours_masked() -> None:
    fine = np.linspace(0.0, 10.0, 1001)
    state = np.where(fine > 5.0, 0, 2)
    ours = path(np.where(fine > 5.0, 77.0, 2.0 + 0.01 * fine), state, s=fine)
    _, largest = path_difference(ours, path(2.0 + 0.01 * S), "stretch_major")
    assert largest == pytest.approx(0.0, abs=1e-12)


def test_radius_paths_are_compared_over_the_radius() -> None:
    radius = np.linspace(60.0, 250.0, 40)
    ours = {"R_mm": radius, "stretch_major": 1.1 + 0.0 * radius, "state": np.full(40, 2)}
    theirs = {"R_mm": radius, "stretch_major": 1.0 + 0.0 * radius, "state": np.full(40, 2)}
    l2, largest = path_difference(ours, theirs, "stretch_major")
    assert (l2, largest) == (pytest.approx(0.1), pytest.approx(0.1))


@pytest.fixture(scope="module", name="annulus")
def _annulus(tmp_path_factory: pytest.TempPathFactory) -> tuple[Comparison, Path]:
    out = tmp_path_factory.mktemp("runs") / "annulus"
    found = compare(load_scene("annulus"), ["tension-field", "exact", "buckling"], nodes=2000, out=out)
    return found, out


def _difference(table: pd.DataFrame, quantity: str) -> float:
    (value,) = table.loc[table["quantity"] == quantity, "difference"]
    return float(value)


def test_the_annulus_against_its_closed_form(annulus: tuple) -> None:
    found, _ = annulus
    assert found.reference == "exact"
    assert list(found.table["method"]) == ["tension-field", "exact"]
    assert set(found.differences["method"]) == {"tension-field"}
    # Second order with 1.3e-5 at 5000 nodes gives 3.3e-5 here; doubled.
    assert 0.0 < _difference(found.differences, "radius stretch_major, relative L2") < 7e-5
    torque = found.solutions["exact"].reactions["inner"].moment_N_mm[2]
    assert 0.0 < abs(_difference(found.differences, "inner moment z")) < 1e-3 * torque
    units = dict(zip(found.differences["quantity"], found.differences["unit"], strict=True))
    assert units["inner force z"] == "N"
    assert units["outer moment z"] == "N mm"
    assert units["total energy"] == "N mm"
    assert units["radius stretch_minor, largest"] == "1"


def test_values_and_their_difference_agree(annulus: tuple) -> None:
    found, _ = annulus
    rows = found.differences.dropna(subset=["value", "reference_value"])
    assert len(rows) == 2 * 6 + 3
    assert np.array_equal(rows["value"] - rows["reference_value"], rows["difference"])
    (row,) = rows[rows["quantity"] == "outer force z"].to_dict("records")
    assert row["value"] == found.solutions["tension-field"].reactions["outer"].force_N[2]
    assert row["reference_value"] == found.solutions["exact"].reactions["outer"].force_N[2]


def test_a_refused_method_is_listed_and_does_not_stop_the_others(annulus: tuple) -> None:
    found, _ = annulus
    assert set(found.refused) == {"buckling"}
    assert "moves along z" in found.refused["buckling"]


def test_the_folder_has_a_result_per_method_and_both_tables(annulus: tuple) -> None:
    found, out = annulus
    assert {path.name for path in out.iterdir()} == {"tension-field", "exact", "compare.csv", "compare.json"}
    for name, solution in found.solutions.items():
        assert load_result(out / name).r.tobytes() == solution.r.tobytes()
    with open(out / "compare.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(found.differences.columns)
    assert [float(row["difference"]) for row in rows] == found.differences["difference"].tolist()
    assert [row["quantity"] for row in rows] == found.differences["quantity"].tolist()
    document = json.loads((out / "compare.json").read_text())
    assert document["reference"] == "exact"
    assert [row["method"] for row in document["methods"]] == ["tension-field", "exact"]
    assert document["methods"][1]["hourglass_in_plane"] is None
    assert len(document["differences"]) == len(found.differences)
    assert document["refused"] == dict(found.refused)


def test_a_second_comparison_solves_nothing_again(annulus: tuple, faked: Fake) -> None:
    def never(_: Task) -> Solution:
        raise AssertionError("this must not be solved again")

    found, out = annulus
    for name in ("tension-field", "exact"):
        faked(never, name)
    again = compare(load_scene("annulus"), ["tension-field", "exact"], nodes=2000, out=out)
    pd.testing.assert_frame_equal(again.differences, found.differences)
    # seconds are those of the stored runs
    pd.testing.assert_frame_equal(again.table, found.table)


def test_an_interrupted_method_ends_the_comparison(faked: Fake, tmp_path: Path) -> None:
    solution = made_solution(meshes.rectangle(100.0, 50.0, 400))
    faked(lambda task: replace(solution, status=Status.INTERRUPTED))
    with pytest.raises(KeyboardInterrupt):
        compare(load_scene("strip-tension"), ["exact", "tension-field"], nodes=400, out=tmp_path / "out")
    assert load_result(tmp_path / "out" / "exact").method == "exact"


def test_no_method_at_all_is_refused() -> None:
    with pytest.raises(MethodError, match="at least one method"):
        compare(load_scene("annulus"), [])
    sentence = "The method buckling cannot solve this: an edge of the scene annulus moves along z"
    with pytest.raises(MethodError, match=re.escape(sentence)):
        compare(load_scene("annulus"), ["buckling"])


def test_without_names_all_methods_of_the_scene_are_run(faked: Fake) -> None:
    for name in METHODS:
        solution = replace(made_solution(meshes.rectangle(100.0, 50.0, 400)), method=name)
        faked(lambda task, solution=solution: solution, name)
    # strips this thin would have very many wrinkles, if they had any: postbuckling must be asked for
    assert set(compare(load_scene("strip-tension"), nodes=400).solutions) == set(METHODS) - {"postbuckling"}
    assert set(compare(load_scene("stretch"), nodes=400).solutions) == set(METHODS) - {"exact"}


def test_the_reference_is_the_closed_form_then_the_tension_field_then_the_plate(faked: Fake) -> None:
    for name in METHODS:
        solution = replace(made_solution(meshes.rectangle(100.0, 50.0, 400)), method=name)
        faked(lambda task, solution=solution: solution, name)
    scene = load_scene("strip-tension")
    for names, reference in (
        (["membrane", "koiter", "tension-field", "exact"], "exact"),
        (["membrane", "koiter", "tension-field"], "tension-field"),
        (["membrane", "koiter"], "koiter"),
        (["membrane"], "membrane"),
    ):
        found = compare(scene, names, nodes=400)
        assert found.reference == reference
        assert set(found.differences["method"]) == set(names) - {reference}


def test_a_row_has_shares_measures_and_cost() -> None:
    grid = meshes.rectangle(100.0, 50.0, 2000)
    solution = made_solution(grid, lambda x, y: 0.5 * np.sin(2.0 * np.pi * x / 25.0))
    state = np.full(grid.zone_area.shape, 2, dtype=np.int8)
    sixth = state.shape[1] // 6
    state[:, :sixth] = 1
    state[:, sixth : 3 * sixth] = 0
    solution = replace(solution, zone=replace(solution.zone, state=state))
    shares = (1.0 - 3.0 * sixth / state.shape[1], sixth / state.shape[1], 2.0 * sixth / state.shape[1])
    row = method_row(solution, probe(solution, load_scene("strip-tension")))
    assert (row["tense_share"], row["wrinkled_share"], row["slack_share"]) == pytest.approx(shares)
    assert row["midsection_amplitude_mm"] == pytest.approx(0.5, rel=1e-2)
    assert row["midsection_wavelength_mm"] == pytest.approx(25.0, rel=1e-2)
    assert row["midsection_half_waves"] == 8
    assert (row["energy_N_mm"], row["bending_energy_N_mm"]) == (3.0, 1.0)
    assert (row["steps"], row["residual"], row["hourglass_out_of_plane"]) == (20, 3e-7, 1e-4)


def test_a_method_whose_positions_are_not_finite_is_compared_as_far_as_possible(faked: Fake) -> None:
    def broken(_: Task) -> Solution:
        solution = made_solution(meshes.rectangle(100.0, 50.0, 400))
        nothing = Reaction(np.full(3, np.nan), np.full(3, np.nan))
        return replace(
            solution,
            method="tension-field",
            status=Status.NOT_FINITE,
            r=np.full_like(solution.r, np.nan),
            reactions={"left": nothing},
        )

    faked(broken)
    found = compare(load_scene("strip-tension"), ["exact", "tension-field"], nodes=400)
    assert list(found.table["status"]) == ["converged", "not_finite"]
    assert not found.differences["quantity"].str.contains("stretch").any()
    assert np.isnan(_difference(found.differences, "left force x"))


def test_probes_without_a_path_in_common_give_no_row() -> None:
    solution = made_solution(meshes.rectangle(100.0, 50.0, 400))
    assert "midsection_amplitude_mm" not in method_row(solution, Probes({}, {}, None))
