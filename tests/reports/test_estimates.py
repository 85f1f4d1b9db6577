"""The section on error estimates, from a made-up coverage."""

from __future__ import annotations

import json

import numpy as np

from reports import section_estimates
from reports.content import Drawing, Table, Text
from reports.drawing import make_figure

COVERAGE = {
    "runs": 12,
    "quantities": {
        "energy_N_mm.total": {
            "estimates": 10,
            "refused": 2,
            "inside": 6,
            "ratios": [0.5, 1.5, 2.0, 2.5, 3.0, 4.0, 1.0, 2000.0],
            "reasons": {"the values oscillate": 2},
        },
        "stretch.major_max": {"estimates": 3, "refused": 3, "inside": 0, "ratios": [], "reasons": {"x": 3}},
    },
}


def test_the_section_counts_what_lies_inside_and_what_is_refused(tmp_path):
    (tmp_path / section_estimates.FILE).write_text(json.dumps(COVERAGE), encoding="utf-8")
    blocks = section_estimates.build(section_estimates.read_coverage(tmp_path)).blocks
    said = next(block.text for block in blocks if isinstance(block, Text))
    assert "12 runs" in said and "75.0 % of 8 true errors" in said
    assert "38 % of the estimates are refused" in said and "2.25 times" in said
    table = next(block for block in blocks if isinstance(block, Table))
    assert table.rows[0] == ("energy_N_mm.total", "10", "2", "75.0", "2.25")
    assert table.rows[1][3:] == ("–", "–")
    reasons = next(block.items for block in blocks if isinstance(block, Text) and block.items)
    assert reasons[0] == "the values oscillate: energy_N_mm.total (2 times)"


def test_the_figure_has_a_row_for_each_quantity_with_ratios():
    blocks = section_estimates.build(COVERAGE).blocks
    figure = make_figure(next(block for block in blocks if isinstance(block, Drawing)))
    (ax,) = figure.axes
    assert [label.get_text() for label in ax.get_yticklabels()] == ["energy_N_mm.total"]
    dot = next(line for line in ax.lines if line.get_marker() == "o")
    assert np.allclose(dot.get_xdata(), 2.25)


def test_without_a_measurement_the_section_says_how_to_make_one(tmp_path):
    (block,) = section_estimates.build(section_estimates.read_coverage(tmp_path)).blocks
    assert isinstance(block, Text) and "pytest -m benchmark" in block.text
