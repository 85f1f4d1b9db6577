"""The section on hard cases shows every case, and says so when there are none."""

from __future__ import annotations

import json
from typing import Any

import matplotlib.pyplot as plt
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle

from cases.hard import AS_EXPECTED, UNNAMED, WRONG
from reports.content import Drawing, Table, Text
from reports.figures_hard import COLOURS, FORETOLD, NOT_ASKED, PEER_COLOURS
from reports.section_hard import PEER_FILE, build, read_peer
from tests.benchmarks import hard_peer


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
    expected = [COLOURS[AS_EXPECTED]] * 25 + [COLOURS[WRONG], FORETOLD, COLOURS[UNNAMED]]
    assert colours == [colour.upper() for colour in expected]
    assert squares[20].get_y() > squares[19].get_y()  # a family with more cases than a line goes on below


def tables(peer: dict | None = None) -> list[Table]:
    return [block for block in build(ROWS, peer).blocks if isinstance(block, Table)]


def test_the_last_table_names_every_case_and_what_an_unnamed_end_said() -> None:
    table = tables()[-1]
    assert len(table.rows) == len(ROWS)
    assert "no end within 600 s" in table.rows[-1]


def test_families_are_counted_by_outcome() -> None:
    """Cases, converged as expected, refused as foretold, refused instead, wrong, unnamed."""
    assert tables()[0].rows == (
        ("mesh", "25", "25", "0", "0", "0", "0"),
        ("start", "3", "0", "1", "0", "1", "1"),
        ("all", "28", "25", "1", "0", "1", "1"),
    )


def test_a_reason_stands_once_for_all_cases_that_share_it() -> None:
    foretold = tables()[1]
    assert foretold.rows == (
        ("mesh", "25", "converged", "closed form"),
        ("start", "3", "converged", "closed form"),
    )


PEER = {
    "m0": {"outcome": hard_peer.RIGHT, "message": "", "versions": {"felupe": "1.2"}},
    "s1": {"outcome": hard_peer.WRONG, "message": "energy: 2, required 1", "versions": {}},
    "s3": {"outcome": hard_peer.CRASHED, "message": "no end", "versions": {}},
}


def test_the_peer_stands_beside_every_case_that_it_was_given() -> None:
    families, wrong, _, cases = tables(PEER)
    assert families.rows[-1][-4:] == ("1", "0", "1", "1")
    assert wrong.rows == (("title of s1", "energy: 2, required 1"),)
    assert [line[-1] for line in cases.rows[-3:]] == [hard_peer.WRONG, "–", hard_peer.CRASHED]
    text = [block.text for block in build(ROWS, PEER).blocks if isinstance(block, Text)][1]
    assert "3 of the cases (not asked: 24 of mesh, 1 of start) were given to FElupe 1.2" in text
    assert "1 right, 0 gave up by name, 1 crashed or no end, 1 silent" in text


def test_the_map_has_a_strip_for_the_peer_below_every_square() -> None:
    drawing = next(block for block in build(ROWS, PEER).blocks if isinstance(block, Drawing))
    figure = plt.figure()
    drawing.draw(figure)
    colours = [to_hex(patch.get_facecolor()).upper() for patch in figure.axes[0].patches]
    entries = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    plt.close(figure)
    assert colours[1] == PEER_COLOURS[hard_peer.RIGHT] and colours[3] == NOT_ASKED
    assert colours[2 * 25 + 1] == PEER_COLOURS[hard_peer.WRONG]
    assert entries == [
        "as expected; below: right",
        "silent wrong answer; below: silent wrong answer",
        "unnamed end; below: crashed or no end",
        "a named refusal, as foretold",
        "below: not asked",
    ]


def test_the_words_of_the_peer_are_those_of_the_campaign(tmp_path) -> None:
    assert set(PEER_COLOURS) == set(hard_peer.OUTCOMES)
    assert hard_peer.FILE == PEER_FILE
    assert read_peer(tmp_path) == {}
    (tmp_path / PEER_FILE).write_text(json.dumps({"rows": [{"name": "m0", "outcome": "right"}]}))
    assert read_peer(tmp_path)["m0"]["outcome"] == "right"


def test_the_first_words_count_the_verdicts() -> None:
    text = next(block for block in build(ROWS).blocks if isinstance(block, Text)).text
    assert "1 silent wrong answer" in text and "1 unnamed end" in text and "26 as expected" in text


@pytest.mark.parametrize("rows", [[], ()])
def test_cases_that_were_not_run_are_said_to_be_missing(rows: list) -> None:
    section = build(rows)
    assert len(section.blocks) == 1 and "wrinkle hard" in section.blocks[0].text  # type: ignore[union-attr]
