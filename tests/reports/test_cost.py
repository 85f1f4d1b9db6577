"""The section on what accuracy costs, from a made-up cost.json."""

from __future__ import annotations

import json

import pytest

from reports import section_cost
from reports.content import Drawing, Table, Text
from reports.drawing import make_figure

ENERGY, RMS = "energy_N_mm.total", "sections.midsection.rms_mm"


def row(method, nodes, seconds, error, option="", status="converged"):
    costs = {"cpu_seconds": seconds, "cpu_seconds_least": 0.9 * seconds, "cpu_seconds_largest": 1.2 * seconds}
    errors = {f"error.{ENERGY}": error, f"error.{RMS}": 3.0 * error} if status == "converged" else {}
    return {
        "method": method,
        "option": option,
        "status": status,
        "message": "because",
        "nodes_asked": nodes,
        "nodes": nodes,
        "folder": f"{method}-{option}-{nodes}",
        "seconds": seconds,
        "force_evaluations": None,
        "seconds_compile": 3.0,
        "peak_memory_MB": 100.0,
        **costs,
        **errors,
    }


@pytest.fixture
def folder(tmp_path):
    rows = [row("koiter", 1000, 1.0, 0.1), row("koiter", 4000, 4.0, 0.02), row("membrane", 4000, 2.0, 0.05)]
    rows += [
        row("koiter", 4000, 9.0, 0.02, option="mass uniform"),
        row("koiter", 16_000, 120.0, 0, status="time_limit"),
    ]
    front = [rows[0]["folder"], rows[1]["folder"]]
    fronts = {ENERGY: front, RMS: front, "lonely": front[:1]}
    document = {
        "scene": "stretch",
        "sentences": [
            f"10 % in {RMS} of the Koiter plate: so.",
            "10 % in nothing of the Koiter plate: no.",
        ],
        "references": [{"model": "Koiter plate", "quantity": RMS, "how": "two methods"}],
        "pareto": {name: {"Koiter plate": list(some)} for name, some in fronts.items()},
        "omitted": {"exact": "there is none"},
        "rows": rows,
        "machine": {"processor": "a processor", "cores": 2},
    }
    place = tmp_path / "stretch-cost"
    place.mkdir()
    (place / "cost.json").write_text(json.dumps(document), encoding="utf-8")
    return tmp_path


def test_a_scene_has_its_sentences_figure_table_failures_and_omissions(folder):
    blocks = section_cost.build(section_cost.read_costs(folder)).blocks
    said, drawing, table, failed, left = blocks
    assert isinstance(said, Text)
    assert said.items == ("10 % in the rms height on midsection of the Koiter plate: so.",)
    assert isinstance(table, Table) and [cells[1] for cells in table.rows] == ["1\u2009000", "4\u2009000"]
    assert isinstance(failed, Text) and failed.items == ("koiter, 16000 nodes: time limit. because",)
    assert isinstance(left, Text) and left.items == ("exact: there is none",)
    assert isinstance(drawing, Drawing) and "two methods" in drawing.caption


def test_what_every_scene_leaves_out_is_said_once(folder):
    document = section_cost.read_costs(folder)["stretch"]
    other = {**document, "omitted": {**document["omitted"], "buckling": "no load"}}
    blocks = section_cost.build({"stretch": document, "hole": other}).blocks
    said = [block.items for block in blocks if isinstance(block, Text) and "Left out" in block.text]
    assert said == [(), ("buckling: no load",), ("exact: there is none",)]


def test_the_figure_draws_every_run_failed_ones_too(folder):
    drawing = section_cost.build(section_cost.read_costs(folder)).blocks[1]
    figure = make_figure(drawing)
    for ax in figure.get_axes():
        crosses = [one for one in ax.lines if one.get_marker() == "x"]
        assert [list(one.get_xdata()) for one in crosses] == [[120.0]]
        drawn = [x for one in ax.lines if one.get_marker() in ("o", ".") for x in one.get_xdata()]
        assert sorted(drawn) == [1.0, 2.0, 4.0, 9.0]
    assert [ax.get_title("left") for ax in figure.get_axes()] == ["rms height on midsection", "energy"]


def test_without_measurements_the_section_says_how_to_make_them(tmp_path):
    (text,) = section_cost.build(section_cost.read_costs(tmp_path)).blocks
    assert isinstance(text, Text) and "wrinkle cost SCENE" in text.text
