"""The section on hard cases shows every case, and says so when there are none."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle

from cases.hard import AS_EXPECTED, UNNAMED, WRONG
from reports.content import Drawing, Table, Text
from reports.section_hard import COLOURS, NAMED_COLOUR, build


def row(name: str, family: str, verdict: str, status: str = "converged") -> dict[str, Any]:
    return {
        "name": name,
        "family": family,
        "title": f"title of {name}",
        "expected": "converged",
        "reason": "closed form",
        "verdict": verdict,
        "status": status,
        "message": "no end within 600 s",
        "steps": 1200,
        "seconds": 0.5,
        "monotone": None,
        "hourglass": None,
        "warnings": 0,
        "requirements": [],
    }


ROWS = [
    *(row(f"m{k}", "mesh", AS_EXPECTED) for k in range(25)),
    row("s1", "start", WRONG),
    row("s2", "start", AS_EXPECTED, "stalled"),
    row("s3", "start", UNNAMED, ""),
]


def test_every_case_is_a_square_of_the_colour_of_its_verdict() -> None:
    drawing = next(block for block in build(ROWS).blocks if isinstance(block, Drawing))
    figure = plt.figure()
    drawing.draw(figure)
    squares = [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    colours = [to_hex(patch.get_facecolor()).upper() for patch in squares]
    plt.close(figure)
    expected = [COLOURS[AS_EXPECTED]] * 25 + [COLOURS[WRONG], NAMED_COLOUR, COLOURS[UNNAMED]]
    assert colours == [colour.upper() for colour in expected]
    assert squares[20].get_y() > squares[19].get_y()  # a family with more cases than a line goes on below


def test_the_table_names_every_case_and_what_an_unnamed_end_said() -> None:
    table = next(block for block in build(ROWS).blocks if isinstance(block, Table))
    assert len(table.rows) == len(ROWS)
    assert "no end within 600 s" in table.rows[-1]
    text = next(block for block in build(ROWS).blocks if isinstance(block, Text)).text
    assert "1 silent wrong answer" in text and "1 unnamed end" in text and "26 as expected" in text


@pytest.mark.parametrize("rows", [[], ()])
def test_cases_that_were_not_run_are_said_to_be_missing(rows: list) -> None:
    section = build(rows)
    assert len(section.blocks) == 1 and "wrinkle hard" in section.blocks[0].text  # type: ignore[union-attr]
