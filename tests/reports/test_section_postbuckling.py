"""The section on post-buckled states: both methods with their bars, the lifted annulus, what the solves take."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from reports import element_cost
from reports.bands import Banded
from reports.content import Drawing, Section, Table, Text
from reports.drawing import make_figure
from reports.plan import report_runs
from reports.plan_postbuckling import PART, QUICK_PULLS
from reports.postbuckling_tables import agreement_table, agreement_words
from reports.postbuckling_values import QUANTITIES, Both, level_values, strip_of, verified_runs
from reports.run import ReportRun
from reports.section_postbuckling import build
from reports.stored import Stored
from tests.reports.synthetic_postbuckling import (
    BENDING,
    HEIGHT_MM,
    MESH_ERROR,
    made_up_quantities,
    write_synthetic_postbuckling,
)

COST = """method,solver,vertices,unknowns,assemble_s,factorise_s,factor_entries,whole_s,value,peak_MB
buckling,superlu,350,3000,0.2,0.1,500000,1.0,0.25,200
buckling,pardiso,350,3000,0.2,0.1,300000,1.0,0.25,200
buckling,superlu,700,6000,0.5,0.3,1500000,3.0,0.25,400
buckling,pardiso,700,6000,0.5,0.1,700000,2.0,0.25,300
postbuckling,superlu,1300,4000,0.1,0.2,900000,8.0,0.0002,500
postbuckling,pardiso,1300,4000,0.1,0.1,500000,4.0,0.0002,250
postbuckling,superlu,42000,126000,1.0,9.0,90000000,,,4000
"""


@pytest.fixture
def section(results, tmp_path) -> Section:
    (tmp_path / element_cost.FILE).write_text(COST, encoding="utf-8")
    return build(results, tmp_path)


def table_of(section: Section, column: str) -> Table:
    return next(b for b in section.blocks if isinstance(b, Table) and column in b.columns)


def words(section: Section) -> str:
    return " ".join(" ".join((b.text, *b.items)) for b in section.blocks if isinstance(b, Text))


def drawing(section: Section, name: str) -> Drawing:
    return next(b for b in section.blocks if isinstance(b, Drawing) and b.name == name)


def test_figures_stand_before_tables(section):
    kinds = [type(block) for block in section.blocks if not isinstance(block, Text)]
    assert kinds[:3] == [Drawing, Drawing, Drawing] and kinds.index(Table) > 2


def test_table_has_both_methods_with_their_errors_at_every_pull(results, section):
    table = table_of(section, "over both bars (–)")
    ten = {row[1]: row for row in table.rows if row[0] == "10"}
    run = next(s for s in results.values() if s.run.name == "stretch-elements-10")
    expected = made_up_quantities(run.value("nodes"), True)
    value, error = ten["crest height"][3].split(" ± ")
    assert float(value) == pytest.approx(expected["sections.midsection.envelope_mm"], rel=1e-4)
    assert float(error) == pytest.approx(2 * MESH_ERROR / run.value("nodes") ** 2 * float(value), rel=0.05)
    assert float(ten["bending energy"][4].split(" ")[0]) == pytest.approx(BENDING, rel=1e-3)
    assert {float(row[0]) for row in table.rows} == set(QUICK_PULLS)


def test_difference_is_measured_in_the_bars_of_both():
    crest = QUANTITIES[0]
    one = Both(crest, Banded(1.0, 1.0, 0.1, 0.1), Banded(1.3, 1.25, 0.4, 0.05))
    assert one.apart == pytest.approx(-0.25 / 0.5)
    assert math.isnan(Both(crest, Banded(0.0, 0.0, 0.0, 0.0), Banded(0.0, 0.0, 0.0, 0.0)).apart)
    far = Both(crest, Banded(2.0, 2.0, 0.1, 0.1), Banded(1.3, 1.25, 0.4, 0.05))
    said = agreement_words(np.array([5.0]), [[one, far]])
    assert "1 of 2 quantities agree" in said.text and "difference is 1.5 of that sum" in said.text
    assert said.items[0].startswith("crest height at 5 %: finite elements 2.0000 ± 0.10")
    assert "nothing can be compared" in agreement_words(np.array([]), []).text


def test_a_pull_without_wrinkles_is_one_row():
    nothing, noise = Banded(0.0, 0.0, 0.0, 0.0), Banded(5e-8, 5e-8, 1e-8, 1e-8)
    flat = [Both(quantity, nothing, noise) for quantity in QUANTITIES]
    table = agreement_table(np.array([24.0]), [flat])
    assert table.rows == (("24", "no wrinkles by either method", *["–"] * 5),)
    low = [replace(one, differences=Banded(0.01, 0.01, 0.02, 0.02)) for one in flat]
    assert len(agreement_table(np.array([24.0]), [low]).rows) == len(QUANTITIES)


def test_a_verified_mesh_takes_the_place_of_a_coarser_one(results, tmp_path):
    run = next(r for r in report_runs() if r.name == "stretch-elements-5")
    write_synthetic_postbuckling(tmp_path / "stretch-5-postbuckling-2000", run, 2000)
    (tmp_path / "stretch-5-notes").mkdir()
    verified = verified_runs(tmp_path)
    assert [s.run.name for s in verified] == ["stretch-5-postbuckling-2000"]
    strip = strip_of(results.values(), verified)
    assert strip.elements[5.0].run.name == "stretch-5-postbuckling-2000"
    assert strip.elements[10.0].run.name == "stretch-elements-10"
    nodes, values = level_values(strip.meshes[5.0], QUANTITIES[0].key)
    assert values == pytest.approx(HEIGHT_MM * (1.0 + MESH_ERROR / nodes**2), rel=1e-12)


def test_meshes_approach_the_limit_in_the_figure(section):
    fig = make_figure(drawing(section, "postbuckling-convergence"))
    for ax in fig.axes:
        line = next(line for line in ax.lines if line.get_marker() == "s")
        nodes, apart = line.get_data()
        assert len(nodes) == 3 and (np.diff(apart) < 0.0).all()
        # 100 % times the made-up error, until the limit of three meshes is no better than it
        assert apart[0] == pytest.approx(100.0 * MESH_ERROR / nodes[0] ** 2, rel=0.05)


def test_measures_are_drawn_with_bars_and_the_flat_strip_has_no_wavelength(section):
    fig = make_figure(drawing(section, "postbuckling-measures"))
    panels = {ax.get_title(loc="left"): ax for ax in fig.axes}
    for title in ("(a) crest height", "(c) bending energy"):
        assert panels[title].containers
    wavelength = panels["(b) wavelength"].containers[0].lines[0].get_ydata()
    assert np.isnan(wavelength[-1]) and np.isfinite(wavelength[:-1]).all()


def test_costs_are_compared_on_the_largest_mesh_of_both_solvers(section):
    text = words(section)
    assert (
        "4\u2009000 unknowns: factorisation 2.0 times, whole solve 2.0 times, peak memory 2.0 times" in text
    )
    assert "6\u2009000 unknowns: factorisation 3.0 times" in text
    table = table_of(section, "factorisation (s)")
    assert len(table.rows) == 7 and table.rows[-1][7] == "–"
    fig = make_figure(drawing(section, "finite-element-cost"))
    assert [len(ax.lines) for ax in fig.axes] == [3, 4, 4]


def test_what_was_not_measured_is_said(results, tmp_path):
    assert "were not measured beside this report" in words(build(results, tmp_path))


def test_without_any_result_every_run_is_named(tmp_path):
    runs = [run for run in report_runs() if run.part == PART]
    text = words(build({run.name: Stored(run, tmp_path / run.name) for run in runs}, tmp_path))
    assert "nothing can be compared" in text and all(run.name in text for run in runs)


def test_a_run_that_failed_has_no_value(results, tmp_path):
    run: ReportRun = next(r for r in report_runs() if r.name == "stretch-elements-10")
    failed = {**results, run.name: Stored(replace(run, name="gone"), tmp_path / "gone")}
    rows = table_of(build(failed, tmp_path), "over both bars (–)").rows
    assert {row[3] for row in rows if row[0] == "10"} == {"–"}
