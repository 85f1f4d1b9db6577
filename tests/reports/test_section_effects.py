"""The section on effects left out shows what the verification runs found, and says what was not run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from reports.content import Drawing, Table, Text
from reports.drawing import make_figure
from reports.run import ReportRun
from reports.section_effects import build, read_kinematics
from reports.stored import Stored

LEFT_OUT = {"on": False, "why": "nothing wrinkles", "size": 2e-5, "justified": "justified"}
KEPT = {"on": True, "why": "the model of koiter", "size": None, "justified": None}


def row(what: str, verdict: str, difference: float, **more: Any) -> dict[str, Any]:
    bending = KEPT if verdict == "nothing left out" else {**LEFT_OUT, "justified": verdict}
    return {
        "what": what,
        "method": "tension-field",
        "nodes": 12_345,
        "effects": {"bending": bending},
        "verdict": verdict,
        "wrong": verdict == "justified" and difference > 1e-3,
        "comparable": True,
        "cpu_seconds": 0.5,
        "cpu_seconds_full": 2.0,
        "less_work": 6.0,
        "largest": {"quantity": "reactions.inner.force_N.z", "difference": difference},
        "differences": {"reactions.inner.force_N.z": difference, "energy_N_mm.total": 1e-7},
        **more,
    }


TABLE = [row("stretch", "nothing left out", 0.0), row("annulus-lift", "justified", 4e-5)]
RANDOM = [
    row("rectangle, pulled by 3 %, h/L = 1e-3", "justified", 3e-5),
    row("annulus, turned by 2 degrees, h/L = 1e-5", "not justified", 0.9),
]
PLAN = {
    "what": "stretch",
    "method": "koiter",
    "nodes": 20_000,
    "status": "converged",
    "plan_cpu_seconds": 1.5,
    "steps": [4550, 3760],
    "cpu_seconds": [4.1, 3.9],
    "memory_MB": [333.0, 369.0],
    "nodes_per_wrinkle": [15.8, None],
}
RESTRICTED = {
    "what": "stretch",
    "nodes": 6027,
    "tense": 0.59,
    "most_saved": 0.47,
    "steps": 2.1,
    "bending": -0.033,
    "largest": {"quantity": "sections.midsection.rms_mm", "difference": 7.4e-3},
}


def write(folder: Path, **content: Any) -> None:
    (folder / "effects").mkdir(exist_ok=True)
    for name, rows in content.items():
        (folder / "effects" / f"{name}.json").write_text(json.dumps(rows), encoding="utf-8")


def texts(folder: Path) -> str:
    blocks = [block for block in build({}, folder).blocks if isinstance(block, Text)]
    return " ".join(" ".join((block.text, *block.items)) for block in blocks)


def table_of(folder: Path, caption: str, results: dict[str, Stored] | None = None) -> Table:
    found = [b for b in build(results or {}, folder).blocks if isinstance(b, Table) and caption in b.caption]
    assert len(found) == 1
    return found[0]


def test_verdicts_are_counted_and_the_largest_difference_named(tmp_path: Path) -> None:
    write(tmp_path, table=TABLE, random=RANDOM)
    words = texts(tmp_path)
    assert "Of 2 ten problems" not in words
    assert "Ten problems: 1 justified, 0 not justified, 1 nothing left out" in words
    assert "the largest difference of a justified one is 4.0e-5" in words
    chosen = table_of(tmp_path, "Ten problems by").rows[1]
    assert chosen[3:5] == ("bending (2.0e-5)", "justified")
    assert chosen[7:] == ("4.0", "6.0")
    kinds = table_of(tmp_path, "of each kind")
    assert dict(zip(kinds.columns, kinds.rows[1], strict=True))["forces"] == "4.0e-5"


def test_a_wrong_verdict_is_shown_as_such(tmp_path: Path) -> None:
    write(tmp_path, random=[row("a ring", "justified", 2e-2), *RANDOM])
    assert "Wrongly justified: a ring." in texts(tmp_path)
    assert table_of(tmp_path, "Random scenes").rows[0][-1] == "WRONG"


def test_runs_that_did_not_come_to_rest_prove_nothing(tmp_path: Path) -> None:
    write(tmp_path, random=[row("a ring", "justified", 2e-2, comparable=False, wrong=False)])
    assert "no full run at rest" in table_of(tmp_path, "Random scenes").rows[0][3]
    assert "the largest difference of a justified one is 0." in texts(tmp_path)


def test_plans_kinematics_and_the_dropped_restriction(tmp_path: Path) -> None:
    write(tmp_path, plan=[PLAN], restricted=[RESTRICTED])
    assert table_of(tmp_path, "Plans and outcomes").rows[0][5:] == (
        "4550 / 3760",
        "4.10 / 3.90",
        "333 / 369",
        "15.8 / –",
    )
    assert "59 % of the zones are tense" in texts(tmp_path)
    assert "midsection rms by 0.74 %" in texts(tmp_path)
    for name, height in (("finite", 0.0), ("moderate", 1.0)):
        folder = tmp_path / f"effects-{name}-30"
        folder.mkdir()
        document = {
            "status": "converged",
            "out_of_plane_mm": {"max_abs": height},
            "reactions": {"top": {"force_N": [0.0, 4.8, 0.0]}},
        }
        (folder / "result.json").write_text(json.dumps(document), encoding="utf-8")
    assert read_kinematics(tmp_path)["moderate"] == [(30.0, 1.0, 4.8)]
    assert "30 %: 0 against 1.0 mm" in texts(tmp_path)


def test_the_cost_of_what_is_left(tmp_path: Path) -> None:
    write(tmp_path, cost=[{"what": "membrane", "operations": 106, "bytes": 208.0, "nanoseconds": 8.21}])
    assert table_of(tmp_path, "costs nothing").rows == (("membrane", "106", "208", "8.2"),)


def test_what_was_not_run_is_said(tmp_path: Path) -> None:
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "table.json").write_text('[{"what": ', encoding="utf-8")  # still being written
    assert texts(tmp_path).count("was not run beside this report") == 4


def test_the_audits_words_on_every_run(tmp_path: Path) -> None:
    results = {}
    for name, effects in (("lift", {"bending": LEFT_OUT, "kinematics": KEPT}), ("plate", {"bending": KEPT})):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "result.json").write_text(json.dumps({"status": "converged", "effects": effects}))
        results[name] = Stored(ReportRun(name, "annulus-lift", "tension-field", 1, 1), folder)
    audits = table_of(tmp_path, "What the audit said", results)
    assert audits.rows == (("lift", "bending", "justified", "2.0e-5", "nothing wrinkles"),)


@pytest.mark.parametrize("many", [False, True])
def test_every_figure_can_be_drawn(tmp_path: Path, many: bool) -> None:
    write(tmp_path, table=TABLE, plan=[PLAN], **({"random": RANDOM * 10} if many else {}))
    drawings = [block for block in build({}, tmp_path).blocks if isinstance(block, Drawing)]
    assert len(drawings) == 2
    for drawing in drawings:
        figure = make_figure(drawing)
        assert figure.axes, "a figure that breaks is replaced by a sentence and has no axes"
