from __future__ import annotations

import re

import matplotlib
import numpy as np
import pytest

from reports.content import Drawing
from reports.drawing import draw_on, make_figure
from reports.figures_hole import relief_factor
from reports.figures_runs import running_steps
from reports.plan import report_runs
from reports.style import METHOD_COLOURS, method_name
from tests.reports.conftest import REFUSED

# a scale ends with its unit in parentheses; the dash is that of a number without one
UNIT = re.compile(r"\((mm|MPa|N|N[ \xa0]mm|%|degrees|–|mm\$\^2\$)\)$")
DRAWN = 15  # figures of the full set of scenes, at least


def drawings(report) -> list[Drawing]:
    return [block for section in report.sections for block in section.blocks if isinstance(block, Drawing)]


def all_axes(fig) -> list:
    found = list(fig.get_axes())
    for ax in found:
        found += [child for child in ax.child_axes if child not in found]
    return found


def scales_of(ax):
    """The scales of an axis that show numbers, with their labels."""
    for scale in (ax.xaxis, ax.yaxis):
        shown = [
            tick for tick in scale.get_major_ticks() if tick.label1.get_visible() or tick.label2.get_visible()
        ]
        if shown and len(scale.get_ticklocs()) and scale.get_visible():
            yield scale.get_label().get_text()


@pytest.fixture(scope="module")
def figures(report):
    return {drawing.name: make_figure(drawing) for drawing in drawings(report)}


def test_every_scale_has_a_label_with_a_unit(figures):
    assert len(figures) >= DRAWN
    scales = [
        (name, label)
        for name, fig in figures.items()
        for ax in all_axes(fig)
        if ax.axison
        for label in scales_of(ax)
    ]
    assert len(scales) >= 4 * DRAWN
    bare = [(name, label) for name, label in scales if not UNIT.search(label)]
    assert not bare


def test_no_figure_was_given_up(figures):
    for name, fig in figures.items():
        assert fig.axes, name
        assert not any("could not be drawn" in text.get_text() for text in fig.texts), name


def test_broken_drawing_says_so_in_its_place(capsys):
    def breaks(fig):
        fig.subplots()
        raise ValueError("odd result")

    fig = matplotlib.figure.Figure()
    draw_on(fig, Drawing("x", "Fig. X", "", "", breaks, 1.0))
    assert [text.get_text() for text in fig.texts] == [
        "This figure could not be drawn from the stored results."
    ]
    assert not fig.axes
    assert "odd result" in capsys.readouterr().err


def test_failed_run_is_named_where_its_picture_would_be(figures):
    maps = figures["fig8-maps"]
    words = [text.get_text().replace("\n", " ") for ax in maps.axes for text in ax.texts]
    assert any(word.startswith("refused: No mesh for") for word in words), REFUSED
    keys = [
        text.get_text()
        for ax in figures["fig8-paths"].axes
        if ax.get_legend()
        for text in ax.get_legend().get_texts()
    ]
    assert f"{method_name('membrane')}: refused" in keys


def test_curves_of_a_method_have_its_colour(figures):
    top = figures["fig10-curves"].axes[0]
    colours = {line.get_color() for line in top.lines}
    assert colours == {METHOD_COLOURS[m] for m in ("exact", "tension-field", "membrane", "koiter")}


def test_stretch_curve_is_that_of_the_file(figures, results):
    path = results["annulus-koiter-20000"].path("radius")
    line = next(
        line for line in figures["fig10-curves"].axes[0].lines if line.get_color() == METHOD_COLOURS["koiter"]
    )
    np.testing.assert_array_equal(line.get_xdata(), path["R_mm"])
    np.testing.assert_array_equal(line.get_ydata(), path["stretch_major"])


def test_hole_is_measured_from_its_edge_and_from_its_centre(figures):
    ax = figures["fig8-paths"].axes[1]
    (top,) = ax.child_axes
    to_half_lengths = top._functions[0]
    # the hole's radius is 15 mm, half the sheet's length 62.5 mm
    assert to_half_lengths(0.0) == pytest.approx(15.0 / 62.5, rel=1e-12)
    assert to_half_lengths(47.5) == pytest.approx(1.0, rel=1e-12)


def test_relief_makes_shallow_wrinkles_steeper_only(results):
    assert relief_factor(results["hole-tension-field"]) == 1.0  # flat: nothing to exaggerate
    assert relief_factor(results["hole-koiter"]) > 1.5


def test_steps_grow_over_levels_that_count_from_zero():
    step, level = np.array([0, 10, 20, 0, 10, 0, 5]), np.array([0, 0, 0, 1, 1, 2, 2])
    np.testing.assert_array_equal(running_steps(step, level), [0, 10, 20, 20, 30, 30, 35])
    np.testing.assert_array_equal(running_steps(np.arange(4), None), np.arange(4))


def test_names_of_drawings_and_runs_are_unique(report):
    names = [drawing.name for drawing in drawings(report)]
    assert len(names) == len(set(names))
    runs = [run.name for run in report_runs(True)]
    assert len(runs) == len(set(runs))
