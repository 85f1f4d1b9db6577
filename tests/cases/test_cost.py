"""What accuracy costs: which runs, against what, which of them are worth their time."""

from __future__ import annotations

import json
import math

import pandas as pd
import pytest

from cases.__main__ import main
from cases.cost_plan import CostRun, Extent, options_of, plan, repeat
from cases.cost_reference import Reference, quantities_of, references
from cases.cost_table import Measured, cheapest, fronts, lasting_error, pareto, sentences
from cases.scene import load_scene
from cases.study_points import Point

ENERGY = "energy_N_mm.total"


def measured(method, nodes, seconds, error, option="", status="converged"):
    point = Point(f"{method}-{option}-{nodes}", "annulus", {}, method, nodes, 0)
    errors = {} if error is None else {ENERGY: error}
    costs = dict.fromkeys(("cpu_seconds", "seconds"), (seconds, 0.9 * seconds, 1.1 * seconds))
    run = CostRun(point, f"{method}, {option}", option)
    return Measured(run, status, "", 3, costs, {"nodes": nodes}, {ENERGY: 1.0}, errors)


def test_every_method_runs_on_every_mesh_and_other_options_on_one():
    runs = plan("annulus", {}, extent=Extent((1000, 8000, 64_000)))
    usual = {(run.point.method, run.point.nodes) for run in runs if not run.option}
    assert {("koiter", 1000), ("koiter", 64_000), ("tension-field", 8000), ("exact", 8000)} <= usual
    other = [run for run in runs if run.option and run.point.method == "koiter"]
    assert {run.point.nodes for run in other} == {8000}
    assert {"damping kinetic", "mass uniform", "one mesh", "tolerance 1e-04"} <= {run.option for run in other}
    assert len({run.point.name for run in runs}) == len(runs)
    assert not any(run.option for run in runs if run.point.method == "exact")


def test_a_smaller_extent_has_fewer_elements_and_no_options():
    runs = plan("stretch", {}, ["koiter", "buckling"], Extent((1000, 8000), options=False, max_seconds=7.0))
    counts = {(run.point.method, run.point.nodes) for run in runs}
    assert counts == {("koiter", 1000), ("koiter", 8000), ("buckling", 400), ("buckling", 800)}
    assert {run.point.changes["solver.max_seconds"] for run in runs} == {7.0}


def test_options_leave_out_what_the_scene_has_already():
    scene = load_scene("annulus", {"solver.damping": "kinetic", "solver.tolerance": 1e-7})
    words = [option for option, _ in options_of("koiter", scene)]
    assert "damping adaptive" in words and "damping kinetic" not in words
    assert "tolerance 1e-06" in words and "tolerance 1e-07" not in words


def test_a_repeat_is_the_same_solve_in_another_folder():
    run = plan("annulus", {}, ["koiter"], Extent((1000,)))[0]
    again = repeat(run, 2)
    assert again.point.name != run.point.name
    assert (again.point.changes, again.point.nodes, again.series) == (
        run.point.changes,
        run.point.nodes,
        run.series,
    )


def second_order(limit, size, nodes=(1000, 4000, 16_000)):
    return [(count, {ENERGY: limit + size / count}) for count in nodes]


def test_a_closed_form_is_the_reference_where_there_is_one():
    found = references({"exact": [(1000, {ENERGY: 5.0})], "tension-field": second_order(5.0, 100.0)})
    assert [(r.model, r.value, r.how) for r in found] == [("relaxed membrane", 5.0, "closed form")]


def test_two_independent_methods_make_a_reference_with_their_distance():
    found = references({"koiter": second_order(5.0, 100.0), "postbuckling": second_order(5.1, 10.0)})
    # the value of the narrower band; what the other differs by is part of its uncertainty
    assert found[0].value == pytest.approx(5.1, rel=1e-12)
    assert 0.1 < found[0].uncertainty < 0.105
    assert found[0].how == "postbuckling, extrapolated, and koiter beside it"


def test_one_method_alone_is_extrapolated_and_labelled_so():
    found = references({"membrane": second_order(5.0, 100.0)})
    assert found[0].value == pytest.approx(5.0, rel=1e-12)
    assert found[0].how == "membrane, extrapolated from its finest meshes"


def test_the_published_scheme_is_no_reference():
    series = {"koiter-published": second_order(2.0, 0.1)}
    assert references(series) == []


def test_what_does_not_approach_a_limit_is_no_reference():
    assert (
        references({"koiter": [(1000, {ENERGY: 1.0}), (4000, {ENERGY: 2.0}), (16_000, {ENERGY: 1.5})]}) == []
    )


def test_quantities_are_read_from_a_result():
    document = {
        "energy_N_mm": {"total": 2.0, "bending": 0.0},
        "reactions": {"top": {"force_N": [1e-9, 3.0, 0.0], "moment_N_mm": [0.0, 0.0, 0.0]}},
        "buckling": {"critical": [{"factor": 0.5, "parity": "even"}]},
        "steps": 100,
        "warnings": [],
    }
    assert quantities_of({**document, "method": "buckling"}, 0.1) == {
        "energy_N_mm.total": 2.0,
        "reactions.top.force_N.y": 3.0,
        "buckling.critical.0.factor": 0.5,
    }


def test_heights_count_where_a_sheet_has_waves_and_a_method_that_resolves_them():
    wavy = {"midsection": {"amplitude_mm": 0.3, "rms_mm": 0.1, "wavelength_mm": 14.0}}
    document = {"sections": wavy, "out_of_plane_mm": {"max_abs": 0.3, "rms": 0.1}}
    names = [f"sections.midsection.{key}" for key in ("amplitude_mm", "rms_mm", "wavelength_mm")]
    assert set(quantities_of({**document, "method": "koiter"}, 0.1)) == {"out_of_plane_mm.rms", *names}
    assert set(quantities_of({**document, "method": "tension-field"}, 0.1)) == {"out_of_plane_mm.rms"}
    assert quantities_of({**document, "method": "koiter"}, 301.0) == {}, (
        "what is left of the start is no height"
    )


def test_every_model_has_a_front_of_its_own():
    plate, relaxed = measured("koiter", 1000, 9.0, 0.1), measured("tension-field", 1000, 1.0, 0.01)
    assert fronts([plate, relaxed], ENERGY) == {"Koiter plate": [plate], "relaxed membrane": [relaxed]}


def test_the_front_has_what_nothing_beats():
    rows = [
        measured("koiter", 1000, 1.0, 0.1),
        measured("koiter", 4000, 4.0, 0.03),
        measured("koiter", 16_000, 20.0, 0.02),
        measured("koiter", 2000, 2.0, 0.001, status="step_limit"),
        measured("koiter", 500, 0.1, None),
        measured("koiter", 4000, 5.0, 0.03, option="mass uniform"),
        measured("koiter", 4000, 2.5, 0.03, option="damping kinetic"),
    ]
    assert pareto(rows, ENERGY) == [rows[0], rows[6], rows[2]]
    barely = measured("koiter", 32_000, 40.0, 0.0185)
    assert pareto([*rows, barely], ENERGY) == [rows[0], rows[6], rows[2]], (
        "a tenth is not worth twice the time"
    )


def test_an_error_counts_as_long_as_it_lasts():
    crossing = [
        measured("koiter", n, t, e)
        for n, t, e in ((1000, 1.0, 0.001), (4000, 4.0, 0.05), (16_000, 20.0, 0.008))
    ]
    assert [lasting_error(crossing, one, ENERGY) for one in crossing] == [0.05, 0.05, 0.008]
    assert cheapest(crossing, "Koiter plate", ENERGY, 0.01) == crossing[2]
    # an option on one mesh alone is believed only as far as the method's own finer meshes bear it out
    lucky = measured("koiter", 1000, 0.5, 0.001, option="mass uniform")
    sound = measured("koiter", 16_000, 15.0, 0.009, option="mass uniform")
    rows = [*crossing, lucky, sound]
    assert lasting_error(rows, lucky, ENERGY) == 0.05
    assert cheapest(rows, "Koiter plate", ENERGY, 0.01) == sound
    assert cheapest(rows, "Koiter plate", ENERGY, 1e-4) is None


def test_a_sentence_names_the_way_its_mesh_and_its_time():
    rows = [measured("koiter", 36_000, 9.0, 0.008)]
    said = sentences(rows, [Reference("Koiter plate", ENERGY, 1.0, 1e-4, "closed form")])
    assert said == [
        "1 % in energy_N_mm.total of the Koiter plate: Koiter plate on 36 000 nodes, 9 s (8.1 to 9.9).",
    ]
    unsure = Reference("Koiter plate", ENERGY, 1.0, 0.02, "extrapolated")
    assert len(sentences(rows, [unsure])) == 1, (
        "a target that the reference itself does not reach says nothing"
    )


def test_a_scene_is_measured_kept_and_told(tmp_path, capsys):
    words = ["cost", "annulus-lift", "--methods", "exact,tension-field", "--nodes", "500,1000,2000"]
    words += ["--no-options", "--repeats", "1"]
    assert main([*words, "--out", str(tmp_path)]) == 0
    said = capsys.readouterr()
    assert "6 runs, 6 converged" in said.out and "[6/6]" in said.err
    table = pd.read_csv(tmp_path / "cost.csv").set_index(["method", "nodes_asked"])
    errors = [table.loc[("tension-field", nodes), f"error.{ENERGY}"] for nodes in (500, 1000, 2000)]
    # second order: twice the nodes, half the error; the meshes' proportions differ by a few per cent
    assert all(math.isclose(errors[k] / errors[k + 1], 2.0, rel_tol=0.2) for k in (0, 1))
    assert (table["cpu_seconds"] > 0.0).all()
    document = json.loads((tmp_path / "cost.json").read_text())
    assert {r["how"] for r in document["references"] if r["quantity"] == ENERGY} == {"closed form"}
    assert {"koiter", "other ways to iterate"} <= set(document["omitted"])
    assert set(table["repeats"]) == {1}
    assert any("% in energy_N_mm.total" in sentence for sentence in document["sentences"])
    # a second call solves nothing
    assert main([*words, "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().err == ""
