"""The section on planted mistakes and faults counts what it shows, and says what was not run."""

from __future__ import annotations

import json

import matplotlib.pyplot as plt
from matplotlib.colors import to_hex

from reports.content import Drawing, Table, Text
from reports.figures_campaigns import BAD, GOOD
from reports.section_campaigns import build

MUTANTS = [
    {
        "name": "wrong <sign>",
        "file": "fdsolver/membrane.py",
        "caught": True,
        "by": "tests/fdsolver/test_force.py::test_force_is_the_gradient[koiter-0.0]",
        "seconds": 57.7,
    },
    {"name": "full kick", "file": "fdsolver/step.py", "caught": False, "by": "", "seconds": 60.0},
]
FAULTS = [
    {"fault": "killed", "what": "run hole", "moments": 18, "outcome": "survived", "detail": "resumed"},
    {"fault": "killed", "what": "report", "moments": 7, "outcome": "survived", "detail": "resumed"},
    {"fault": "not finite", "what": "mass", "moments": 12, "outcome": "failed", "detail": "went on"},
]


def parts(folder):
    blocks = build(folder).blocks
    return [b.text for b in blocks if isinstance(b, Text)], [b for b in blocks if isinstance(b, Table)]


def write(folder, **content):
    for name, rows in content.items():
        (folder / f"{name}.json").write_text(json.dumps(rows), encoding="utf-8")


def test_counts_and_tables_of_both(tmp_path):
    write(tmp_path, mutants=MUTANTS, faults=FAULTS)
    (mutants, faults), (planted, made) = parts(tmp_path)
    assert "1 of 2 were caught. Not caught: full kick. 118 s" in mutants
    assert planted.rows[0][2:4] == ("yes", "test_force: force is the gradient")
    assert planted.rows[1][2:4] == ("NO", "–")
    assert "37 in all (killed: 25, not finite: 12): 2 of 3 kinds were survived" in faults
    assert "Not survived: not finite, mass." in faults
    assert [row[3] for row in made.rows] == ["survived", "survived", "FAILED"]


def drawn(drawing):
    """The colours of a map's squares, its labels and all other texts of its axes."""
    figure = plt.figure()
    drawing.draw(figure)
    (axes,) = figure.axes
    found = (
        [to_hex(patch.get_facecolor()).upper() for patch in axes.patches],
        [label.get_text() for label in axes.get_yticklabels()],
        [text.get_text() for text in axes.texts],
        [text.get_text() for text in axes.get_legend().get_texts()],
    )
    plt.close(figure)
    return found


def test_maps_show_every_row_in_the_colour_of_its_end(tmp_path):
    write(tmp_path, mutants=MUTANTS, faults=FAULTS)
    mutants, faults = (block for block in build(tmp_path).blocks if isinstance(block, Drawing))
    assert drawn(mutants) == (
        [GOOD, BAD],
        ["fdsolver/membrane.py", "fdsolver/step.py"],
        ["", ""],
        ["caught by a test", "not caught"],
    )
    assert drawn(faults) == (
        [GOOD, GOOD, BAD],
        ["killed", "not finite"],
        ["18", "7", "12"],
        ["survived", "not survived"],
    )
    write(tmp_path, mutants=MUTANTS[:1])
    assert drawn(next(b for b in build(tmp_path).blocks if isinstance(b, Drawing)))[3] == ["caught by a test"]


def test_success_is_said_as_such(tmp_path):
    write(tmp_path, mutants=MUTANTS[:1], faults=FAULTS[:2])
    (mutants, faults), _ = parts(tmp_path)
    assert "1 of 1 were caught. None passed." in mutants
    assert "2 of 2 kinds" in faults and "None failed." in faults


def test_what_was_not_run_is_said(tmp_path):
    (tmp_path / "faults.json").write_text('[{"fault": ', encoding="utf-8")  # still being written
    texts, found = parts(tmp_path)
    assert not found
    assert all("beside this report: `python -m tests." in text for text in texts) and len(texts) == 2
