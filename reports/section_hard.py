"""Hard cases: how sheets, meshes, starts and steps at the edge of what can be solved came to an end."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.hard import AS_EXPECTED, REFUSED, UNNAMED, VERDICTS, WRONG
from reports.content import Block, Drawing, Section, Table, Text
from reports.style import number, whole

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

Case = Mapping[str, Any]
COLOURS = {AS_EXPECTED: "#33678F", REFUSED: "#F0B94D", WRONG: "#C23B22", UNNAMED: "#000000"}
NAMED = "a named refusal, as foretold"
NAMED_COLOUR = "#9DBAD0"
MAP_COLUMNS = 20


def build(rows: Sequence[Case]) -> Section:
    """The section; `rows` as `cases.hard_table.read_hard` gives them, none if they were not run."""
    title = "Hard cases"
    if not rows:
        text = (
            "The hard cases were not run beside this report: `wrinkle hard` or `pytest -m benchmark` does it."
        )
        return Section("hard", title, [Text(text)])
    blocks: list[Block] = [Text(_words(rows)), _map(rows), _table(rows)]
    return Section("hard", title, blocks)


def _words(rows: Sequence[Case]) -> str:
    found = Counter(row["verdict"] for row in rows)
    converged = sum(row["status"] == "converged" for row in rows)
    seconds = sum(row["seconds"] for row in rows)
    rising = sum(row["monotone"] is False for row in rows)
    return (
        f"{len(rows)} cases, each with its outcome and the reason for it stated beforehand: "
        + ", ".join(f"{found.get(verdict, 0)} {verdict}" for verdict in VERDICTS)
        + f". {converged} converged and were judged by their requirements; {number(seconds, 3)} s of solving in all."
        f" Strain plus kinetic energy rose at some look in {rising} of them: those that were kicked out of an unstable"
        " state, or whose unstable step was taken back."
    )


def _colour(row: Case) -> str:
    if row["verdict"] == AS_EXPECTED and row["status"] != "converged":
        return NAMED_COLOUR
    return COLOURS.get(row["verdict"], "#777777")


def _map(rows: Sequence[Case]) -> Drawing:
    families = list(dict.fromkeys(row["family"] for row in rows))
    lines = [(family, start) for family in families for start in range(0, _size(rows, family), MAP_COLUMNS)]

    def draw(fig: FigureBase) -> None:
        from matplotlib.patches import Rectangle

        ax = fig.add_subplot()
        for y, (family, start) in enumerate(lines):
            mine = [row for row in rows if row["family"] == family][start : start + MAP_COLUMNS]
            for x, row in enumerate(mine):
                ax.add_patch(Rectangle((x + 0.06, y + 0.08), 0.88, 0.84, facecolor=_colour(row), linewidth=0))
        ax.set(
            xlim=(0, MAP_COLUMNS), ylim=(len(lines), 0), xticks=[], xlabel="cases, in the order of the table"
        )
        ax.set_yticks(np.arange(len(lines)) + 0.5, [family if start == 0 else "" for family, start in lines])
        ax.tick_params(length=0)
        for side in ax.spines.values():
            side.set_visible(False)
        present = [verdict for verdict in VERDICTS if any(row["verdict"] == verdict for row in rows)]
        entries = [(COLOURS[verdict], verdict) for verdict in present]
        if any(_colour(row) == NAMED_COLOUR for row in rows):
            entries.insert(1, (NAMED_COLOUR, NAMED))
        handles = [Rectangle((0, 0), 1, 1, facecolor=colour) for colour, _ in entries]
        ax.legend(
            handles,
            [name for _, name in entries],
            loc="upper center",
            bbox_to_anchor=(0.5, -0.08),
            ncols=len(entries),
        )

    found = Counter(row["verdict"] for row in rows)
    alt = "; ".join(f"{count} {verdict}" for verdict, count in found.items())
    caption = "How every hard case ended, one square each, family by family. The table names them in the same order."
    return Drawing(
        "hard-map", "Hard cases", caption, f"Map of the hard cases: {alt}.", draw, 0.8 + 0.24 * len(lines)
    )


def _size(rows: Sequence[Case], family: str) -> int:
    return sum(row["family"] == family for row in rows)


def _table(rows: Sequence[Case]) -> Table:
    columns = (
        "case",
        "expected",
        "because",
        "ended",
        "verdict",
        "steps",
        "CPU s",
        "energy fell throughout",
        "checkerboard share",
    )
    cells = tuple(
        (
            row["title"],
            row["expected"].replace("_", " "),
            row["reason"],
            (row["status"] or row["message"]).replace("_", " "),
            row["verdict"],
            whole(row["steps"]),
            number(row["seconds"], 2),
            {True: "yes", False: "no", None: "–"}[row["monotone"]],
            number(math.nan if row["hourglass"] is None else row["hourglass"], 2),
        )
        for row in rows
    )
    return Table("Every hard case, its expected and its actual end.", columns, cells, wide=(0, 2))
