"""Maps of the campaigns: every kind of fault with its number, every planted mistake by the file that it was put in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

Row = Mapping[str, Any]
GOOD, BAD = "#33678F", "#C23B22"
LINE_IN = 0.24  # inches a line of squares takes
Line = tuple[str, Sequence[tuple[bool, str]]]  # label; whether each square is good, and what stands in it


def fault_lines(rows: Sequence[Row]) -> list[Line]:
    """Kinds of faults, a square for each thing that they were done to, with the number of times."""
    kinds = dict.fromkeys(str(row["fault"]) for row in rows)
    return [
        (kind, [(row["outcome"] == "survived", str(row["moments"])) for row in rows if row["fault"] == kind])
        for kind in kinds
    ]


def mutant_lines(rows: Sequence[Row]) -> list[Line]:
    """Files, a square for each mistake planted in them."""
    files = dict.fromkeys(str(row["file"]) for row in rows)
    return [(file, [(row["caught"] is True, "") for row in rows if row["file"] == file]) for file in files]


def height_in(lines: Sequence[Line]) -> float:
    """Height of `draw_squares` in inches."""
    return 0.3 + LINE_IN * (len(lines) + 2)


def draw_squares(fig: FigureBase, lines: Sequence[Line], good: str, bad: str) -> None:
    """Draw lines of squares. good, bad : what the two colours mean."""
    from matplotlib.patches import Rectangle

    ax = fig.add_subplot()
    for y, (_, squares) in enumerate(lines):
        for x, (is_good, text) in enumerate(squares):
            place, shade = (x + 0.06, y + 0.08), GOOD if is_good else BAD
            ax.add_patch(Rectangle(place, 0.88, 0.84, facecolor=shade, linewidth=0))
            ax.text(x + 0.5, y + 0.52, text, ha="center", va="center", color="white", fontsize=7)
    ax.set(xlim=(0, max(12, *(len(squares) for _, squares in lines))), ylim=(len(lines), 0), xticks=[])
    ax.set_yticks(np.arange(len(lines)) + 0.5, [label for label, _ in lines])
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
    colours = [(GOOD, good)] + [(BAD, bad)] * any(not ok for _, squares in lines for ok, _ in squares)
    handles = [Rectangle((0, 0), 1, 1, facecolor=shade) for shade, _ in colours]
    ax.legend(handles, [name for _, name in colours], ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))
