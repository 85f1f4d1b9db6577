"""The report's summary, verification table, open questions, omissions and footer."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from reports.content import Block, Section, Table, Text
from reports.plan import LADDER, SCENES
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import shortfalls

MANY = 8  # names in a row that a reader still reads


def summary(results: Mapping[str, Stored], full: bool) -> Section:
    """What was run, how it ended, how long it took."""
    runs = list(results.values())
    seconds = sum(s.value("seconds") for s in runs if not math.isnan(s.value("seconds")))
    good = sum(s.converged for s in runs)
    worst = [s for s in runs if shortfalls(s)]
    text = (
        f"{'Full' if full else 'Quick'} report: {len(runs)} runs of {len({s.run.scene for s in runs})} "
        f"scenes, {good} of them converged; {number(seconds, 3)} s of solving."
    )
    blocks: list[Block] = [Text(text), _scene_table(runs)]
    if worst:
        blocks.append(Text("Runs that fell short, in their own words:", _grouped(worst)))
    else:
        blocks.append(Text("Every run converged."))
    return Section("summary", "Summary", blocks)


def _grouped(runs: Sequence[Stored]) -> tuple[str, ...]:
    """The shortfalls of some runs, equal ones together."""
    names: dict[str, list[str]] = {}
    for run in runs:
        names.setdefault(" ".join(shortfalls(run)), []).append(run.run.name)
    return tuple(f"{_some(group)}. {reason}" for reason, group in names.items())


def _some(names: Sequence[str]) -> str:
    """Names in a row; of very many the first and the number of the others."""
    if len(names) <= MANY:
        return ", ".join(names)
    return f"{', '.join(names[: MANY - 1])} and {len(names) - MANY + 1} others"


def _scene_table(runs: Sequence[Stored]) -> Table:
    rows = []
    for scene in (*SCENES, *LADDER):
        mine = [s for s in runs if s.run.scene == scene]
        if not mine:
            continue
        title = next((str(s.scene["title"]) for s in mine if "title" in s.scene), scene)
        failed = sorted({s.status.replace("_", " ") for s in mine if not s.converged})
        residuals = [s.value("residual") for s in mine if not math.isnan(s.value("residual"))]
        rows.append(
            (
                scene,
                title,
                ", ".join(dict.fromkeys(s.method for s in mine)),
                whole(max((n for s in mine if not math.isnan(n := s.value("nodes"))), default=math.nan)),
                f"{sum(s.converged for s in mine)} of {len(mine)}",
                ", ".join(failed) or "converged",
                number(max(residuals, default=math.nan), 2),
                number(sum(t for s in mine if not math.isnan(t := s.value("seconds"))), 3),
            )
        )
    columns = (
        "scene",
        "title",
        "methods",
        "most nodes",
        "converged",
        "worst status",
        "largest residual (–)",
        "time (s)",
    )
    return Table("Scenes and methods of this report.", columns, tuple(rows), wide=(1, 2))


def read_benchmarks(path: Path) -> list[Mapping[str, object]]:
    """Entries of `benchmarks.json`, [] if there is no such file."""
    if not path.is_file():
        return []
    content = json.loads(path.read_text(encoding="utf-8"))
    return list(content["runs"] if isinstance(content, dict) else content)


def verification(entries: Sequence[Mapping[str, object]]) -> Section:
    """Verification runs with every quantity, its requirement and the reason of the limit."""
    if not entries:
        text = "No verification runs were found. They are made by the project's benchmark tests."
        return Section("verification", "Verification runs", [Text(text)])
    passed = sum(entry.get("status") == "passed" for entry in entries)
    text = f"{passed} of {len(entries)} verification runs passed."
    blocks: list[Block] = [Text(text), _each_verification(entries)]
    rows = []
    for entry in entries:
        name = str(entry.get("title") or entry.get("name", ""))
        quantities = entry.get("quantities")
        for k, quantity in enumerate(quantities if isinstance(quantities, list) else []):
            holds = {True: "yes", False: "NO"}.get(quantity.get("holds"), "–")
            rows.append(
                (
                    name if k == 0 else "",
                    str(quantity.get("quantity", "")),
                    f"{_plain(quantity.get('value'))} {quantity.get('unit', '')}".strip(),
                    str(quantity.get("requirement", "")) or "–",
                    holds,
                    str(quantity.get("reason", "")) or "–",
                )
            )
    columns = ("verification", "quantity", "value", "required", "holds", "reason of the limit")
    caption = "Every quantity of the verification runs, with its limit."
    blocks.append(Table(caption, columns, tuple(rows), wide=(0, 1, 5), folded=True))
    failed = tuple(
        f"{e.get('name')}: {e.get('status')}. {e.get('message', '')}"
        for e in entries
        if e.get("status") != "passed"
    )
    return Section(
        "verification", "Verification runs", [*blocks, *([Text("Not passed:", failed)] if failed else [])]
    )


def _each_verification(entries: Sequence[Mapping[str, object]]) -> Table:
    rows = []
    for entry in entries:
        quantities = entry.get("quantities")
        stored = quantities if isinstance(quantities, list) else []
        judged = [quantity["holds"] for quantity in stored if quantity.get("holds") is not None]
        rows.append(
            (
                str(entry.get("title") or entry.get("name", "")),
                str(entry.get("status", "")),
                f"{sum(judged)} of {len(judged)}",
                _plain(entry.get("seconds")),
                _plain(entry.get("cpu_seconds")),
                str(entry.get("finished", "")).partition("T")[0],
            )
        )
    columns = ("verification", "status", "limits held", "time (s)", "CPU (s)", "finished")
    caption = "Verification runs, compilation included; processes that a run starts count in its time alone."
    return Table(caption, columns, tuple(rows), wide=(0,))


def _plain(value: object) -> str:
    return (
        number(float(value), 4)
        if isinstance(value, int | float)
        else str(value if value is not None else "–")
    )


def open_questions() -> Section:
    """What the paper does not say, and what was done about it."""
    return Section("questions", "What the paper leaves open", [Text("", _QUESTIONS)])


def omissions(results: Mapping[str, Stored]) -> Section:
    """What this report does not show."""
    return Section("omissions", "Omissions", [Text("Not in this report:", _OMISSIONS)])


def footer(results: Mapping[str, Stored]) -> list[str]:
    """Versions and machine of the runs, as stored with them; more than one line if they differ."""
    lines: dict[str, int] = {}
    for stored in results.values():
        if "versions" not in stored.result:
            continue
        parts = [_flat(stored.result.get(key)) for key in ("machine", "versions", "code")]
        line = "; ".join(part for part in parts if part)
        lines[line] = lines.get(line, 0) + 1
    return [f"{line} ({count} runs)" for line, count in lines.items()]


def _flat(value: object) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_flat(item)}" for key, item in value.items() if item not in ("", None))
    return "" if value is None else str(value)


_QUESTIONS = (
    "The thickness of the annulus is not stated. The answer of tension-field theory does not depend on "
    "it; the plate's wrinkles do, so the plate was run at the scene's thickness and at a larger one whose "
    "wrinkles the mesh resolves.",
    "The edge of the sheared sheet moves by 0.5 mm in the text and by 0.05 mm in a caption; no "
    "pre-stretch is stated, though others who model the same experiment use 0.05 mm. All were run.",
    "The figures of the sheet with a hole use half of its length as the unit of distance, and their "
    "stretch axis fits a pull of 5 % better than 10 % on one path, and 10 % on the other: both pulls were "
    "run, and distances are given both ways.",
)
_OMISSIONS = (
    "buckling of the annulus, whose load is not in its plane;",
    "the number of wrinkles as a firm number: it follows the mesh long after the energy has settled, and "
    "is given only as measured on each run, with the nodes per wrinkle beside it.",
)
