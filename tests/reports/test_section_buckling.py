"""The section on buckling: factors, modes, what loads far beyond them mean, and where the flat strip is stable."""

from __future__ import annotations

import json

import numpy as np
import pytest

from reports.buckling_tables import counterpart, factor_table, finest
from reports.content import Drawing, Section, Table, Text
from reports.drawing import make_figure
from reports.figures_buckling import halves, rim
from reports.plan import report_runs
from reports.plan_buckling import PART, buckling_runs
from reports.section_buckling import build
from reports.stability_window import ALONG_THE_LOAD, HOW, MAP
from reports.stored import Stored
from tests.reports.synthetic_buckling import COUNT, made_up_factors

ALONG = """strain,factor,unstable,neutral_thickness_mm
0.02,1.35,0,0.086
0.05,0.61,4,0.128
0.2,1.3,0,0.088
0.25,inf,0,0.0
"""
OVER = """aspect,strain,factor,unstable,neutral_thickness_mm,error_mm
1.0,0.02,80.9,0,0.011,0.004
1.0,0.05,inf,0,0.0,0.0
2.5,0.02,1.35,0,0.086,0.002
2.5,0.05,0.61,4,0.127,0.004
"""


def words(section: Section) -> str:
    return " ".join(" ".join((b.text, *b.items)) for b in section.blocks if isinstance(b, Text))


def tables(section: Section) -> list[Table]:
    return [block for block in section.blocks if isinstance(block, Table)]


@pytest.fixture
def section(results, tmp_path) -> Section:
    (tmp_path / ALONG_THE_LOAD).write_text(ALONG, encoding="utf-8")
    (tmp_path / MAP).write_text(OVER, encoding="utf-8")
    return build(results, tmp_path)


def buckled(results, scene: str) -> list[Stored]:
    return [s for s in results.values() if s.run.part == PART and s.run.scene == scene]


def test_every_scene_shows_its_ten_factors_of_the_finest_triangles(results, section):
    for scene, table in zip(("stretch", "shear", "hole"), tables(section), strict=False):
        best = finest(buckled(results, scene))
        assert best is not None and not best.run.overrides.get("solver.element")
        assert best.value("nodes") == max(
            s.value("nodes") for s in buckled(results, scene) if not s.run.overrides.get("solver.element")
        )
        expected = made_up_factors(scene, int(best.value("nodes")))
        assert len(table.rows) == COUNT
        assert [float(row[1]) for row in table.rows] == pytest.approx(expected, rel=1e-4)
        assert [row[5] for row in table.rows] == [str(k // 2 + 1) for k in range(COUNT)]
        if scene == "stretch":  # whose made-up waves are even and odd in X
            assert [row[4] for row in table.rows[:2]] == ["symmetric", "antisymmetric"]
        assert {row[6] for row in table.rows} == {"1.0"}  # the made-up error, %


def test_other_meshes_are_compared_mode_by_mode(results):
    runs = buckled(results, "stretch")
    best = finest(runs)
    others = [s for s in runs if s is not best]
    table = factor_table(best, others)
    for k, other in enumerate(others):
        ratio = (
            made_up_factors("stretch", int(other.value("nodes")))[0]
            / made_up_factors("stretch", int(best.value("nodes")))[0]
        )
        assert float(table.rows[0][7 + k].replace("−", "-")) == pytest.approx(100.0 * (ratio - 1.0), rel=0.02)


def test_counterpart_has_the_same_parity_whatever_the_order_within_a_pair():
    ours = [{"factor": 1.0, "parity": "symmetric"}, {"factor": 1.001, "parity": "antisymmetric"}]
    theirs = [{"factor": 2.0, "parity": "antisymmetric"}, {"factor": 3.0, "parity": "symmetric"}]
    assert counterpart(ours, 0, theirs) == 3.0
    assert counterpart(ours, 1, theirs) == 2.0
    assert np.isnan(counterpart([*ours, ours[0]], 2, theirs))


def test_a_load_of_thousands_of_times_the_critical_one_is_explained(results, section):
    text = words(section)
    times = 1.0 / made_up_factors("shear", int(finest(buckled(results, "shear")).value("nodes")))[0]
    assert f"the sheared sheet carries {round(times):,} times".replace(",", "\u2009") in text
    assert "pulled strip carries" not in text  # four times critical
    assert "half-waves, the plate at the scene's load" in text


def test_drawn_modes_fill_their_panels(section):
    drawn = {block.name: block for block in section.blocks if isinstance(block, Drawing)}
    fig = make_figure(drawn["buckling-modes-strip"])
    panels = [ax for ax in fig.axes if ax.get_title(loc="left")]
    assert len(panels) == 6
    for ax in panels:
        heights = ax.collections[0].get_array()
        assert np.max(heights) == pytest.approx(1.0)  # the sign is chosen so
        assert len(ax.collections) == 2  # colours and rim


def test_rim_is_every_side_of_one_cell_only():
    square = np.array([[0, 1, 2, 3]])
    two = np.array([[0, 1, 2], [0, 2, 3]])
    outline = {frozenset(side) for side in ((0, 1), (1, 2), (2, 3), (3, 0))}
    for cells in (square, two):
        assert {frozenset(side) for side in rim(cells).tolist()} == outline
    np.testing.assert_array_equal(halves(square), two)


def test_window_is_read_from_its_verification(results, tmp_path):
    quantities = {
        "appearance": 0.02759,
        "appearance, change from the next coarser mesh": 2e-5,
        "disappearance": 0.2061,
        "disappearance, change from the next coarser mesh": 5e-4,
    }
    entry = {
        "name": "test_buckling::test_window_of_the_pulled_strip",
        "quantities": [{"quantity": name, "value": value} for name, value in quantities.items()],
    }
    (tmp_path / "benchmarks.json").write_text(json.dumps({"runs": [entry]}), encoding="utf-8")
    assert "unstable from 2.759 ± 0.002 % to 20.61 ± 0.05 % of strain" in words(build(results, tmp_path))


def test_window_of_the_table_alone_is_a_pair_of_brackets(section):
    assert "between 2 and 5 %; between 5 and 20 %" in words(section)
    table = next(t for t in tables(section) if "unstable modes" in t.columns)
    assert [row[2] for row in table.rows] == ["0", "4", "0", "0"]
    assert table.rows[-1][1] == "–"  # nowhere compressed
    drawing = next(b for b in section.blocks if isinstance(b, Drawing) and b.name == "stability-map")
    assert "Largest bar above a quarter of the highest curve: 3.1 %" in drawing.caption
    left, right = make_figure(drawing).axes
    assert len(left.containers) == 2  # aspect ratios
    np.testing.assert_allclose(right.containers[0].lines[0].get_ydata(), [0.011, 0.127])


def test_what_was_not_verified_is_said(results, tmp_path):
    assert words(build(results, tmp_path)).count(HOW) == 2


def test_without_any_result_every_run_is_named(tmp_path):
    results = {run.name: Stored(run, tmp_path / run.name) for run in buckling_runs()}
    text = words(build(results, tmp_path))
    assert "No result folder was found" in text
    assert all(run.name in text for run in buckling_runs())


def test_the_quick_report_runs_few_vertices_and_the_full_one_more():
    quick = {run.name: run.nodes(False) for run in report_runs() if run.part == PART}
    full = {run.name: run.nodes(True) for run in report_runs(True) if run.part == PART}
    assert quick == {run.name: run.nodes_quick for run in buckling_runs()}
    assert all(full[name] > 2 * nodes for name, nodes in quick.items())
