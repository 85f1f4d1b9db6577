"""Effects left out: what `auto` chose, what the audit said of it, and what full runs say; plans against outcomes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from reports import effects_tables as tables
from reports import figures_effects as figures
from reports.content import Block, Drawing, Section, Text
from reports.measured import read_document
from reports.stored import Stored
from reports.style import number

Row = Mapping[str, Any]
MISSING = "{} was not run beside this report: `pytest -m benchmark` does it."


def read_effects(folder: Path) -> dict[str, list[Row]]:
    """What the verification runs left in `effects/*.json` of their folder, by file name; damaged files are left out."""
    found = {}
    for path in sorted((folder / "effects").glob("*.json")):
        if isinstance(rows := read_document(path), list):
            found[path.stem] = rows
    return found


def read_kinematics(folder: Path) -> dict[str, list[tuple[float, float, float]]]:
    """Kinematics -> (pull in %, largest height in mm, force in N) of the strips of the verification runs."""
    curves: dict[str, list[tuple[float, float, float]]] = {}
    for path in folder.glob("effects-*/result.json"):
        found = re.fullmatch(r"effects-(finite|moderate)-(\d+)", path.parent.name)
        document = read_document(path) or {}
        if found is not None and document.get("status") == "converged":
            height = float(document["out_of_plane_mm"]["max_abs"])
            point = (float(found[2]), height, float(document["reactions"]["top"]["force_N"][1]))
            curves.setdefault(found[1], []).append(point)
    return {name: sorted(curves[name]) for name in ("finite", "moderate") if name in curves}


def build(results: Mapping[str, Stored], folder: Path) -> Section:
    """The section. results : of the report's runs. folder : of the verification runs."""
    found = read_effects(folder)
    blocks = [
        *_verdicts(found.get("table", []), found.get("random", [])),
        *_quarters([row for name, rows in found.items() if name.startswith("quarter") for row in rows]),
        *([tables.cost(found["cost"])] if found.get("cost") else []),
        *_plans(found.get("plan", [])),
        *_kinematics(read_kinematics(folder)),
        *_restricted(found.get("restricted", [])),
        *_audits(results),
    ]
    return Section("effects", "Effects left out", blocks)


def _verdicts(table: Sequence[Row], random: Sequence[Row]) -> list[Block]:
    if not table and not random:
        return [Text(MISSING.format("The comparison of what was left out with full runs"))]
    blocks: list[Block] = [
        Drawing(
            "effects-verdicts",
            "Verdicts",
            "The largest relative difference between a run with effects left out and full runs of the same scene, by"
            " the audit's verdict: no blue dot may lie right of the dashed line. Differences below 1e-9 are drawn"
            " there; long names are numbered as in their table. Energies and their parts are taken relative to the"
            " total energy, forces and moments to the largest, stretches to the largest strain, heights to the"
            " thickness if that is more; of wrinkled sheets beyond the range of full runs from two seeds, and heights"
            " by their root mean square, the largest being the phase's.",
            "Dots of justified runs left of a line at 0.1 per cent, those of unjustified ones on both sides.",
            partial(figures.verdicts, table=table, random=random),
            0.8 + 0.19 * max(len(table), len(random)),
        ),
        Text(_counts("ten problems", table) + " " + _counts(f"{len(random)} random scenes", random)),
    ]
    if table:
        blocks += [tables.chosen(table), tables.by_quantity(table)]
    return [*blocks, tables.random(random)] if random else blocks


def _counts(what: str, rows: Sequence[Row]) -> str:
    """How often the audit said what, and how often it was wrong."""
    if not rows:
        return MISSING.format(f"The audit of {what}")
    said = {verdict: sum(row["verdict"] == verdict for row in rows) for verdict in figures.VERDICT_COLOURS}
    held = [row for row in rows if row["verdict"] == "justified" and row["comparable"]]
    wrong = [str(row["what"]) for row in rows if row["wrong"]]
    largest = max((row["largest"]["difference"] for row in held), default=0.0)
    words = ", ".join(f"{count} {verdict}" for verdict, count in said.items())
    mistakes = f"Wrongly justified: {'; '.join(wrong)}." if wrong else "None was wrongly justified"
    tail = "" if wrong else f": the largest difference of a justified one is {number(largest, 2)}."
    return f"{what.capitalize()}: {words}. {mistakes}{tail}"


def _quarters(rows: Sequence[Row]) -> list[Block]:
    return [tables.quarters(rows)] if rows else []


def _plans(rows: Sequence[Row]) -> list[Block]:
    if not rows:
        return [Text(MISSING.format("The comparison of plans with outcomes"))]
    drawing = Drawing(
        "effects-plans",
        "Plans",
        "What `wrinkle plan` foretold over what a run in a process of its own took; grey: within a factor of two. The"
        " scenes that are described by their load are random ones that no constant of the plan was fitted to.",
        "Ratios of foretold to found steps, seconds and memory around one.",
        partial(figures.foretold, rows=[row for row in rows if row["status"] == "converged"]),
        0.7 + 0.25 * len(rows),
    )
    return [drawing, tables.plans(rows)]


def _kinematics(curves: Mapping[str, Sequence[tuple[float, float, float]]]) -> list[Block]:
    if len(curves) < 2:
        return [Text(MISSING.format("The strip under two kinematics"))]
    return [
        Drawing(
            "effects-kinematics",
            "Two kinematics",
            "The stretched sheet by finite strain and by moderate rotations (Föppl and von Kármán), from one start"
            " each: the wrinkles of moderate rotations go on growing where finite strain loses them. The force of"
            " moderate rotations is that of a linear bar; Green's strain stiffens it.",
            "Heights that rise and fall back to zero with finite strain, and go on rising with moderate rotations.",
            partial(figures.kinematics, curves=curves),
            2.6,
        ),
        Text(_parting(curves)),
    ]


def _parting(curves: Mapping[str, Sequence[tuple[float, float, float]]]) -> str:
    """Where the two kinematics part."""
    finite, moderate = ({pull: point for pull, *point in curves[name]} for name in ("finite", "moderate"))
    parts = [
        f"{pull:g} %: {number(finite[pull][0], 2)} against {number(moderate[pull][0], 2)} mm,"
        f" {number(finite[pull][1], 3)} against {number(moderate[pull][1], 3)} N"
        for pull in finite
        if pull in moderate
    ]
    return f"Height and force, finite strain against moderate rotations. {'; '.join(parts)}."


def _restricted(rows: Sequence[Row]) -> list[Block]:
    """Why bending is not restricted to the part of the sheet that can wrinkle."""
    if not rows:
        return [Text(MISSING.format("Bending in a part of the sheet"))]
    items = tuple(
        f"{row['what']}, {row['nodes']} nodes: {100.0 * row['tense']:.0f} % of the zones are tense in the tension"
        f" field, so at most {100.0 * row['most_saved']:.0f} % of the operations of a step could be saved. Without"
        f" bending there the bending energy changes by {100.0 * row['bending']:+.2g} % and"
        f" {tables.words(row['largest']['quantity'])} by {100.0 * row['largest']['difference']:.2g} % beyond the range"
        f" of two seeds; the run took {row['steps']:.2g} times the node-steps."
        for row in rows
    )
    text = (
        "Bending only where the tension field says that the sheet can wrinkle was tried and dropped. Where wrinkles"
        " reach into what the tension field calls tense the answer changes, and the stretch without bending stiffness"
        " beside them slows the relaxation down; where they do not, there is little to save."
    )
    return [Text(text, items)]


def _audits(results: Mapping[str, Stored]) -> list[Block]:
    """The audit's words on every run of this report that left something out."""
    audited = [stored for stored in results.values() if tables.judged(stored)]
    if not audited:
        return []
    others = sum(1 for stored in results.values() if stored.result.get("effects")) - len(audited)
    text = (
        f"The audit's words on the {len(audited)} runs of this report that left an effect out and were judged; the"
        f" other {others} runs left out nothing that their method has."
    )
    return [Text(text), tables.audits(audited)]
