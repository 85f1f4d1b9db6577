"""`--accuracy`: what it asks for, how the next mesh is chosen, and that the result is as good as it says."""

from __future__ import annotations

import pytest

from cases import load_scene, run
from cases.__main__ import main
from cases.accuracy import FIRST_NODES, Reached, judge, next_nodes, read_accuracy, run_to_accuracy
from cases.problems import SceneError
from cases.results import read_document


def entry(quantity, value, discretisation, iteration=0.0, order=2.0):
    return {
        "quantity": quantity,
        "value": value,
        "discretisation": discretisation,
        "iteration": iteration,
        "order": order,
    }


@pytest.mark.parametrize(("text", "value"), [("1%", 0.01), ("0.01", 0.01), (" 50 %", 0.5), ("0.0001%", 1e-6)])
def test_an_accuracy_is_a_share_or_a_percentage(text, value):
    assert read_accuracy(text) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("text", ["", "0", "1", "51%", "nan", "-1%", "small"])
def test_other_accuracies_are_refused(text):
    with pytest.raises(SceneError, match="must be a relative error from 0.0001% to 50%"):
        read_accuracy(text)


def test_the_worst_promised_quantity_counts():
    reached = judge(
        [
            entry("energy_N_mm.total", 100.0, 1.0),
            entry("stretch.major_max", 2.0, 0.1, order=1.1),
            entry("energy_N_mm.bending", 1.0, 0.9),
            entry("sections.midsection.wavelength_mm", 1.0, None),
        ]
    )
    assert reached == Reached(0.05, "stretch.major_max", 1.1, False, ())


def test_a_small_force_is_held_against_the_largest():
    errors = [entry("reactions.top.force_N.y", 50.0, 0.5), entry("reactions.top.force_N.x", 0.1, 0.2)]
    assert judge(errors).worst == pytest.approx(0.01, rel=1e-15)


def test_a_refused_quantity_and_a_large_iteration_error_are_told():
    reached = judge(
        [entry("energy_N_mm.total", 1.0, 0.01, iteration=0.01), entry("out_of_plane_mm.rms", 1.0, None)]
    )
    assert reached.tighten and reached.refused == ("out_of_plane_mm.rms",)


def test_the_next_mesh_follows_the_order():
    # a hundredth of the error takes a tenth of the width, a hundred times the nodes: more than one step allows
    assert next_nodes(1000, 0.08, Reached(0.4, "q", 2.0, False, ())) == round(1000 * 0.4 / 0.064)
    assert next_nodes(1000, 0.001, Reached(0.1, "q", 2.0, False, ())) == 16_000
    assert next_nodes(1000, 0.1, Reached(0.11, "q", 2.0, False, ())) == 2000
    assert next_nodes(1000, 0.1, Reached(None, "", None, False, ("q",))) == 4000
    assert next_nodes(900_000, 0.001, Reached(0.1, "q", 1.0, False, ())) == 1_000_000


@pytest.mark.parametrize("accuracy", [0.01, 0.003])
def test_the_result_is_as_good_as_it_was_asked_to_be(accuracy, tmp_path):
    scene = load_scene("annulus-lift")
    solution = run_to_accuracy(scene, "tension-field", accuracy, out=tmp_path / "run")
    assert not any("accuracy" in warning for warning in solution.warnings)
    exact = run(
        scene, "exact", nodes=200_000
    )  # its stretches are those of zone centres: near enough to the rim
    pull = exact.reactions["inner"].force_N[2]
    assert abs(solution.energy_N_mm["total"] / exact.energy_N_mm["total"] - 1.0) < accuracy
    assert abs(solution.reactions["inner"].force_N[2] / pull - 1.0) < accuracy
    assert abs(solution.zone.stretch_major.max() / exact.zone.stretch_major.max() - 1.0) < accuracy
    # asking again finds the result, whatever mesh it was reached on
    stamp = (tmp_path / "run" / "result.json").stat().st_mtime_ns
    run_to_accuracy(scene, "tension-field", accuracy, out=tmp_path / "run")
    assert (tmp_path / "run" / "result.json").stat().st_mtime_ns == stamp
    assert judge(read_document(tmp_path / "run")["errors"]).worst <= accuracy


def test_an_accuracy_that_is_not_reached_is_said(tmp_path):
    scene = load_scene("annulus-lift", {"solver.max_steps": 10})
    solution = run_to_accuracy(scene, "tension-field", 0.01)
    assert solution.grid.nodes < FIRST_NODES and solution.status.value == "step_limit"
    assert any(warning.startswith("The accuracy of 1 % was not shown") for warning in solution.warnings)


def test_meshes_of_other_thicknesses_are_refused_before_anything_is_solved(tmp_path, capsys):
    words = ["run", "hole", "--method", "koiter", "--accuracy", "5%", "--out", str(tmp_path / "hole")]
    assert main(words) == 2
    said = capsys.readouterr().err
    assert "solver.thicken = true: leaves --accuracy nothing to go by" in said
    words[1:4] = ["annulus-twist", "--method", "koiter"]
    assert main([*words, "--set", "solver.thinning=[2.0]"]) == 2
    said = capsys.readouterr().err
    assert "solver.thinning" in said and "give --nodes, or --set solver.thinning=[]" in said
    assert not (tmp_path / "hole").exists()
