"""The section that compares with other programs, from made-up runs."""

from __future__ import annotations

import json
import math

from reports import section_peers
from reports.content import Drawing, Table, Text
from reports.drawing import make_figure


def run(peer, unknowns, seconds, error=None):
    found = {"error": error, "versions": {peer: "1.0"}, "cpu_seconds": seconds} if error is not None else {}
    return {
        "peer": peer,
        "problem": "hole",
        "mesh": unknowns,
        "lines": 70,
        "status": "converged" if found else "failed",
        "message": "gave\nup ",
        "unknowns": unknowns,
        "process_cpu_seconds": 2.0 * seconds,
        "memory_MB": 100.0,
        **found,
    }


RUNS = [
    run("wrinklebench", 100, 1.0, 5e-3),
    run("wrinklebench", 400, 4.0, 5e-5),
    run("wrinklebench, limit", 400, 4.0, 5e-5),
    run("wrinklebench, quarter", 400, 0.5, 5e-5),
    run("ngsolve", 50, 2.0, 1e-5),  # right by chance: the next mesh is not
    run("ngsolve", 200, 8.0, 2e-4),
    run("ngsolve", 800, 30.0),
]
DOCUMENT = {
    "runs": RUNS,
    "references": [{"problem": "hole", "quantity": "energy_N_mm", "how": "a limit"}],
    "omitted": {"calculix": "not installed here"},
}


def test_times_count_from_where_the_error_stays_small():
    assert section_peers.time_to(RUNS, "wrinklebench", "hole", 1e-3) == 4.0
    assert section_peers.time_to(RUNS, "ngsolve", "hole", 1e-3) == 2.0
    assert math.isnan(section_peers.time_to(RUNS, "ngsolve", "hole", 1e-4))


def test_the_section_has_ratios_failures_and_what_was_left_out(tmp_path):
    (tmp_path / section_peers.FILE).write_text(json.dumps(DOCUMENT), encoding="utf-8")
    blocks = section_peers.build(section_peers.read_peers(tmp_path)).blocks
    equal, programs = (block for block in blocks if isinstance(block, Table))
    assert [cells[:2] + cells[-2:] for cells in equal.rows] == [
        ("hole", "1", "0.50", "0.25"),
        ("hole", "0.1", "2.0", "0.25"),
        ("hole", "0.01", "–", "–"),
    ]
    assert programs.rows[3][5] == "2 of 3"
    texts = [block for block in blocks if isinstance(block, Text)]
    assert texts[0].items == ("ngsolve, hole, mesh 800: gave up",)
    assert texts[1].items == ("calculix: not installed here",)


def test_the_figure_draws_failures_above_the_frame():
    drawing = next(block for block in section_peers.build(DOCUMENT).blocks if isinstance(block, Drawing))
    (ax,) = make_figure(drawing).axes
    crosses = [line for line in ax.lines if line.get_marker() == "x"]
    assert [float(line.get_xdata()[0]) for line in crosses] == [60.0]
    assert {line.get_label() for line in ax.lines if line.get_marker() in "os*p"} == {
        run["peer"] for run in RUNS
    }


def test_without_a_comparison_the_section_says_how_to_make_one(tmp_path):
    (block,) = section_peers.build(section_peers.read_peers(tmp_path)).blocks
    assert isinstance(block, Text) and "compare.py" in block.text
