"""Lines of text and tables for the PDF: measured, broken and set by the font's own widths."""

from __future__ import annotations

from functools import cache
from typing import Any

from reports.code_words import plain

MEASURED_PT = 100.0  # at text sizes the font's hints would round every letter to whole pixels
FAMILIES = ("STIXGeneral", "DejaVu Sans")  # the second for what the first lacks, such as small figures


@cache
def _font(bold: bool) -> Any:
    from matplotlib.font_manager import FontProperties, findfont, get_font

    weight = "bold" if bold else "normal"
    return get_font([findfont(FontProperties(family=family, weight=weight)) for family in FAMILIES])


@cache
def width_in(text: str, size_pt: float, bold: bool = False) -> float:
    """Width of a line of text in inches."""
    font = _font(bold)
    font.set_size(MEASURED_PT, 72)
    font.set_text(text, 0.0)
    return float(font.get_width_height()[0]) / 64.0 / 72.0 * size_pt / MEASURED_PT


def wrap(text: str, size_pt: float, limit_in: float, bold: bool = False) -> list[str]:
    """Break text, unmarked, into lines no wider than `limit_in`; a word wider than that is broken too."""
    lines: list[str] = []
    current = ""
    for word in plain(text).split(" "):
        for piece in _pieces(word, size_pt, limit_in, bold):
            longer = f"{current} {piece}" if current else piece
            if current and width_in(longer, size_pt, bold) > limit_in:
                lines.append(current)
                current = piece
            else:
                current = longer
    return [*lines, current] if current or not lines else lines


def _pieces(word: str, size_pt: float, limit_in: float, bold: bool) -> list[str]:
    pieces = []
    while len(word) > 1 and width_in(word, size_pt, bold) > limit_in:
        fits = max(1, int(len(word) * limit_in / width_in(word, size_pt, bold)) - 1)
        pieces.append(word[:fits])
        word = word[fits:]
    return [*pieces, word]


def column_widths(
    columns: tuple[str, ...], rows: tuple[tuple[str, ...], ...], size_pt: float, total_in: float
) -> list[float]:
    """Widths of a table's columns, inches, sum `total_in` at most: the widest gives way."""
    gap = 0.09
    wanted = []
    for k, head in enumerate(columns):
        word = max((width_in(w, size_pt, True) for w in head.split()), default=0.0)
        body = max((width_in(row[k], size_pt) for row in rows), default=0.0)
        wanted.append(max(word, body) + gap)
    while sum(wanted) > total_in:
        widest = max(wanted)
        others = [w for w in wanted if w < widest]
        count = len(wanted) - len(others)
        floor = max(others, default=0.0)
        share = (total_in - sum(others)) / count
        wanted = [max(share, floor) if w == widest else w for w in wanted]
        if share > floor or not others:
            break
    spare = (total_in - sum(wanted)) / len(wanted)
    return [w + min(max(spare, 0.0), 0.25) for w in wanted]
