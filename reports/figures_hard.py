"""The map of the hard cases: one square each, family by family, ours above another code's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.hard import AS_EXPECTED, REFUSED, UNNAMED, VERDICTS, WRONG

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

Case = Mapping[str, Any]
GOOD, FORETOLD, GIVEN_UP, BAD, NOTHING = "#33678F", "#9DBAD0", "#F0B94D", "#C23B22", "#000000"
COLOURS = {AS_EXPECTED: GOOD, REFUSED: GIVEN_UP, WRONG: BAD, UNNAMED: NOTHING}
NAMED = "a named refusal, as foretold"
PEER_COLOURS = {
    "right": GOOD,
    "gave up by name": GIVEN_UP,
    "crashed or no end": NOTHING,
    "silent wrong answer": BAD,
}
NOT_ASKED = "#E4E4E4"
MAP_COLUMNS = 20
LINE_IN = 0.24  # inches a line of squares takes


def colour(row: Case) -> str:
    """Colour of a case by its verdict, and by whether a refusal was foretold."""
    if row["verdict"] == AS_EXPECTED and row["status"] != "converged":
        return FORETOLD
    return COLOURS.get(row["verdict"], "#777777")


def lines(rows: Sequence[Case]) -> list[tuple[str, Sequence[Case]]]:
    """The lines of the map: a family (empty on its further lines) and its cases on that line."""
    found: list[tuple[str, Sequence[Case]]] = []
    for family in dict.fromkeys(row["family"] for row in rows):
        mine = [row for row in rows if row["family"] == family]
        for start in range(0, len(mine), MAP_COLUMNS):
            found.append((family if start == 0 else "", mine[start : start + MAP_COLUMNS]))
    return found


def height_in(rows: Sequence[Case], peer: Mapping[str, Case]) -> float:
    """Height of the map in inches."""
    return 1.1 + LINE_IN * len(lines(rows)) * (1.6 if peer else 1.0)


def draw_map(fig: FigureBase, rows: Sequence[Case], peer: Mapping[str, Case]) -> None:
    """Draw every case as a square; below it, where a peer was asked, a lower one for how that ended."""
    from matplotlib.patches import Rectangle

    ax, drawn = fig.add_subplot(), lines(rows)
    share = 0.58 if peer else 0.84
    for y, (_, cases) in enumerate(drawn):
        for x, row in enumerate(cases):
            ax.add_patch(Rectangle((x + 0.06, y + 0.08), 0.88, share, facecolor=colour(row), linewidth=0))
            if peer:
                below = PEER_COLOURS.get(peer.get(row["name"], {}).get("outcome", ""), NOT_ASKED)
                ax.add_patch(Rectangle((x + 0.06, y + 0.7), 0.88, 0.22, facecolor=below, linewidth=0))
    ax.set(xlim=(0, MAP_COLUMNS), ylim=(len(drawn), 0), xticks=[], xlabel="cases, in the order of the table")
    ax.set_yticks(np.arange(len(drawn)) + 0.5, [family for family, _ in drawn])
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
    _legend(ax, rows, peer)


def _legend(ax: Axes, rows: Sequence[Case], peer: Mapping[str, Case]) -> None:
    """One entry per colour that is drawn."""
    from matplotlib.patches import Rectangle

    ended = {row["outcome"] for row in peer.values()}
    meanings: dict[str, list[str]] = {}
    for verdict in (v for v in VERDICTS if any(row["verdict"] == v for row in rows)):
        meanings.setdefault(COLOURS[verdict], []).append(verdict)
    if any(colour(row) == FORETOLD for row in rows):
        meanings[FORETOLD] = [NAMED]
    for outcome in (word for word in PEER_COLOURS if word in ended):
        meanings.setdefault(PEER_COLOURS[outcome], []).append(f"below: {outcome}")
    if peer and any(row["name"] not in peer for row in rows):
        meanings[NOT_ASKED] = ["below: not asked"]
    entries = [(shade, "; ".join(words)) for shade, words in meanings.items()]
    handles = [Rectangle((0, 0), 1, 1, facecolor=shade) for shade, _ in entries]
    names = [name for _, name in entries]
    ax.legend(handles, names, ncols=3, loc="upper center", bbox_to_anchor=(0.42, -0.1))
