"""What a report is made of, before it is a page or a PDF: sections of text, figures and tables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase


@dataclass(frozen=True)
class Drawing:
    """A figure: `draw` puts axes on an empty figure (or subfigure) of the given size.

    name : unique, for file names and anchors.  title : "Fig. 7" and the like.
    height_in : height in inches at the full text width (TEXT_WIDTH_IN).
    vector : keep as vector graphics in the page (maps with many zones are better as pixels).
    """

    name: str
    title: str
    caption: str
    alt: str
    draw: Callable[[FigureBase], None]
    height_in: float
    vector: bool = True


@dataclass(frozen=True)
class Table:
    """A table of text cells; the unit stands in the column's head.  `wide` columns may wrap.

    folded : too long to be read through: closed on the page until a reader opens it, and left out of the PDF.
    """

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    wide: tuple[int, ...] = ()
    folded: bool = False


@dataclass(frozen=True)
class Text:
    """A paragraph, or a list of items."""

    text: str = ""
    items: tuple[str, ...] = ()


Block = Drawing | Table | Text


@dataclass(frozen=True)
class Section:
    """A section of the report."""

    anchor: str
    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Report:
    """The whole report; the first section is the summary."""

    title: str
    subtitle: str
    sections: Sequence[Section]
    footer: Sequence[str]


TEXT_WIDTH_IN = 6.9
