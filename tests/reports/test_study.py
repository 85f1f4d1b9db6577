"""The section on parameter studies, from made-up tables."""

from __future__ import annotations

import itertools
import json

import numpy as np
import pandas as pd
import pytest

from reports import section_study
from reports.content import Drawing, Table, Text
from reports.drawing import make_figure


@pytest.fixture
def folder(tmp_path):
    thick = [
        {
            "method": "koiter",
            "status": "converged" if h > 0.05 else "time_limit",
            "sheet.thickness_mm": h,
            "edges.top.move_mm": json.dumps([0, pull, 0]),
            "sections.midsection.wavelength_mm": 20.0 * np.sqrt(h),
            "sections.midsection.amplitude_mm": h * pull / 10.0,
        }
        for h, pull in itertools.product((0.05, 0.1, 0.2), (12.7, 25.4))
    ]
    band = [
        {
            "method": method,
            "status": "converged",
            "edges.inner.rotate_deg": twist,
            "edges.inner.move_mm": json.dumps([0, 0, lift]),
            "paths.radius.wrinkled_from_mm": 70.0 if twist else np.nan,
            "paths.radius.wrinkled_to_mm": 100.0 + twist if twist else np.nan,
        }
        for method, twist, lift in itertools.product(("exact", "tension-field"), (0, 30, 90), (0.0, 62.5))
    ]
    for name, rows in (("thickness-and-pull", thick), ("twist-and-lift", band)):
        (tmp_path / f"{name}-study").mkdir()
        pd.DataFrame(rows).to_csv(tmp_path / f"{name}-study" / "study.csv", index=False)
    return tmp_path


def test_both_studies_are_drawn_with_the_ends_of_their_runs(folder):
    blocks = section_study.build(section_study.read_studies(folder)).blocks
    assert [type(block) for block in blocks] == [Drawing, Table, Drawing, Table]
    assert ("koiter", "time_limit", "2") in blocks[1].rows


def test_the_thickness_figure_has_one_line_per_pull_without_unfinished_runs(folder):
    figure = make_figure(section_study.build(section_study.read_studies(folder)).blocks[0])
    wavelength, amplitude = figure.get_axes()
    for ax in (wavelength, amplitude):
        lines = [line for line in ax.lines if line.get_label().startswith("koiter")]
        assert [list(line.get_xdata()) for line in lines] == [[0.1, 0.2], [0.1, 0.2]]
    assert len({line.get_color() for line in amplitude.lines}) == 2, "a colour per pull"
    grey = next(line for line in wavelength.lines if line.get_color() == "#BBBBBB")
    assert np.allclose(grey.get_ydata(), 20.0 * np.sqrt(grey.get_xdata()), rtol=1e-12)  # through its own law


def test_the_band_figure_has_one_panel_per_lift(folder):
    figure = make_figure(section_study.build(section_study.read_studies(folder)).blocks[2])
    axes = figure.get_axes()
    assert [ax.get_title("left") for ax in axes] == ["lift 0 mm", "lift 62.5 mm"]
    upper = axes[0].lines[1]
    assert list(upper.get_xdata()) == [30, 90] and list(upper.get_ydata()) == [130.0, 190.0]


def test_without_tables_the_section_says_how_to_make_them(tmp_path):
    blocks = section_study.build(section_study.read_studies(tmp_path)).blocks
    assert all(isinstance(block, Text) and "wrinkle study" in block.text for block in blocks)
