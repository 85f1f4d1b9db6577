from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from reports.convergence import observed_order, order_data
from reports.run import ReportRun
from reports.section_annulus import build, main_runs
from reports.stored import Stored, refusal_path
from reports.style import number, whole
from reports.tables import difference_table, percent, relative_error, remarks, run_table, shortfalls
from tests.reports.conftest import HOSTILE, REFUSED, STALLED
from tests.reports.synthetic import write_synthetic


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (1.2345e-5, 3, "1.23e-5"),
        (-0.00123456, 3, "−0.00123"),
        (1234.5678, 5, "1234.6"),
        (9.8765e12, 2, "9.9e12"),
        (0.0, 3, "0"),
        (math.nan, 3, "–"),
        (math.inf, 3, "inf"),
        (999.96, 3, "1000"),
    ],
)
def test_number(value, digits, text):
    assert number(value, digits) == text


def test_whole_has_thin_spaces():
    assert whole(20100.0) == "20\u2009100"
    assert whole(math.nan) == "–"


def test_percent():
    assert percent(101.0, 100.0) == "+1.0"
    assert percent(-99.0, -100.0) == "+1.0"  # towards larger, whatever the sign
    assert percent(1.0, 0.0) == "–"
    assert percent(math.nan, 1.0) == "–"


def test_relative_error_is_over_the_rows_between_the_radii():
    radius = np.array([60.0, 100.0, 200.0, 249.0])
    exact = {"R_mm": radius, "stretch_major": np.array([9.0, 3.0, 4.0, 9.0])}
    path = {"R_mm": radius, "stretch_major": np.array([0.0, 3.0, 4.5, 0.0])}
    assert relative_error(path, exact, "stretch_major", 64.0, 248.0) == pytest.approx(0.5 / 5.0, rel=1e-14)
    assert math.isnan(relative_error(path, exact, "stretch_major", 1.0, 2.0))
    assert math.isnan(relative_error({}, exact, "stretch_major", 64.0, 248.0))


def test_order_table_finds_second_order(results):
    plain = [s for s in results.values() if s.run.scene == "annulus" and not s.run.overrides]
    spacing, errors = order_data(plain)
    error = errors["largest stretch, L2"]
    assert (np.diff(spacing) < 0).all()
    # the made-up height errs by 1 / nodes, that is by the square of the spacing; nodes and zones differ a little
    assert observed_order(spacing, error, 1) == pytest.approx(2.0, abs=0.1)
    assert math.isnan(observed_order(spacing, error, 0))


def test_run_table_names_status_residual_and_resolution(results):
    rows = {row[2]: row for row in run_table([results[STALLED], results[REFUSED]], "").rows}
    assert rows["stalled"][3] == "3.0e-4"
    assert rows["stalled"][8] == "0.0012 / –"
    assert rows["refused"][1:5] == ("–", "refused", "–", "–")


def test_remarks_gather_equal_warnings_and_give_reasons(results):
    found = remarks([results["annulus-koiter-20000"], results[STALLED], results[REFUSED]])
    warning = [item for item in found.items if "a made-up warning" in item]
    assert len(warning) == 1
    assert "thickness_mm = 0.1" in warning[0]
    assert any(HOSTILE in item for item in found.items)
    assert remarks([results["hole-tension-field"]]) is None


def test_run_that_ended_on_a_coarser_mesh_falls_short(tmp_path):
    run = ReportRun("x", "strip-tension", "koiter", 400, 400)
    write_synthetic(tmp_path / "x", run, 400, planned=20000)
    assert shortfalls(Stored(run, tmp_path / "x")) == [
        "It ended on a coarser mesh than the 20\u2009000 nodes planned."
    ]


def test_main_runs_prefer_the_mesh_of_the_paper_and_a_plate_that_converged(results):
    plain = [s for s in results.values() if s.run.scene == "annulus"]
    runs = main_runs(plain)
    assert runs["koiter"].run.name == "annulus-koiter-20000"  # the resolved one stalled
    counts = [s.value("nodes") for s in plain if s.method == "exact"]
    assert runs["exact"].value("nodes") == max(counts)  # all are below 20 000


def test_difference_table_leaves_out_what_was_refused(results):
    hole = {
        s.method: s for s in results.values() if s.run.scene == "hole" and not (s.run.overrides or s.run.part)
    }
    table = difference_table(hole, "tension-field", ("along_x", "along_y"), "")
    assert [row[:2] for row in table.rows] == [("koiter", "along x"), ("koiter", "along y")]
    assert difference_table({}, "exact", ("radius",), "") is None


def test_difference_table_leaves_out_slack_rows():
    s = np.array([0.0, 1.0, 2.0])
    base = {"s_mm": s, "stretch_major": np.array([9.0, 3.0, 4.0]), "stretch_minor": np.ones(3)}
    base["state"] = np.array([0, 1, 2])
    ours = base | {"stretch_major": np.array([0.0, 3.0, 4.5])}
    runs = {"exact": SimpleNamespace(path=lambda _: base), "koiter": SimpleNamespace(path=lambda _: ours)}
    assert difference_table(runs, "exact", ("p",), "").rows == (("koiter", "p", "0.10", "0.50", "0", "0"),)


def test_section_stands_with_no_result_at_all(results, tmp_path):
    from reports.build import read_results

    runs = [s.run for s in results.values() if s.run.scene == "annulus"]
    section = build(read_results(runs, tmp_path))
    assert section.blocks


def test_refusal_is_read_from_beside_the_folder(results):
    stored = results[REFUSED]
    assert refusal_path(stored.folder).is_file()
    assert (stored.status, stored.drawable, stored.converged) == ("refused", False, False)
    assert math.isnan(stored.value("energy_N_mm", "total"))
