"""The section on roads and scaling, from made-up rows."""

from __future__ import annotations

import json

from reports import section_growth
from reports.content import Drawing, Table, Text
from reports.drawing import make_figure


def row(nodes, seconds, status="converged"):
    return {
        "method": "koiter",
        "asked": nodes,
        "status": status,
        "nodes": nodes,
        "steps": 4 * nodes,
        "force_evaluations": 5 * nodes,
        "seconds": 2.0 * seconds,
        "cpu_seconds": seconds,
        "peak_memory_MB": nodes / 100.0,
    }


LEFT = {"method": "koiter", "asked": 240_000, "status": "left out", "cpu_seconds": 300.0}
FITS = {"steps_exponent": 0.5, "time_exponent": 1.5, "memory_exponent": 1.0}
NEXT = {"next_nodes": 600_000.0, "next_cpu_seconds": 7200.0, "next_memory_MB": 6000.0}
FOUND = {
    "road-relaxation": {"rows": [row(15_000, 2.0), row(60_000, 16.0), LEFT], "fits": FITS},
    "scaling-koiter": {"rows": [row(8000, 1.0), row(60_000, 9.0, "stalled"), LEFT], "fits": FITS | NEXT},
    "threads-koiter": {"rows": [row(8000, 1.5), row(8000, 1.0)]},
}


def test_tables_show_every_run_and_foresee_what_was_left_out(tmp_path):
    (tmp_path / section_growth.FILE).write_text(json.dumps(FOUND), encoding="utf-8")
    blocks = section_growth.build(section_growth.read_growth(tmp_path)).blocks
    roads, scaling, ahead, threads = (block for block in blocks if isinstance(block, Table))
    assert roads.rows[1][3:6] == ("240\u2009000", "300\u2009000", "16.0")
    assert roads.rows[2][2:6] == ("left out", "–", "–", "300 (foreseen)")
    assert [cells[2] for cells in scaling.rows] == ["converged", "stalled", "left out"]
    assert ahead.rows[0][1:] == ("1.50", "1.00", "600\u2009000", "2.0", "6.0")
    assert threads.rows[0][2:] == ("3.00", "2.00", "1.50")


def test_figures_join_converged_runs_and_cross_the_others():
    for block in section_growth.build(FOUND).blocks:
        if isinstance(block, Drawing):
            figure = make_figure(block)
            assert len(figure.axes) == 2
            crossed = [line for ax in figure.axes for line in ax.lines if line.get_marker() == "x"]
            joined = [line for ax in figure.axes for line in ax.lines if line.get_marker() == "o"]
            assert all(len(line.get_xdata()) for line in joined)
            expected = 1 if block.name == "growth-scaling" else 0
            assert sum(len(line.get_xdata()) for line in crossed) == 2 * expected


def test_without_measurements_the_section_says_how_to_make_them(tmp_path):
    (block,) = section_growth.build(section_growth.read_growth(tmp_path)).blocks
    assert isinstance(block, Text) and "pytest -m benchmark" in block.text
