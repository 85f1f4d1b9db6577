"""The report as a PDF of A4 pages, by matplotlib alone: vector figures, set text, ruled tables."""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fdsolver.checkpoint import write_atomically
from reports.content import TEXT_WIDTH_IN, Drawing, Report, Section, Table, Text
from reports.drawing import PIXELS_PER_INCH, draw_on
from reports.page import numeric_columns
from reports.pdf_text import column_widths, width_in, wrap
from reports.style import FIGURE_STYLE

if TYPE_CHECKING:
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

PAGE_IN = (8.27, 11.69)  # A4
LEFT = (PAGE_IN[0] - TEXT_WIDTH_IN) / 2
TOP, BOTTOM = 0.8, 0.7
BODY_PT, CAPTION_PT, TABLE_PT = 10.0, 9.0, 7.6
KEPT_ROWS, ROW_GAP = 12, 0.035  # shorter tables are not broken; inches between rows
LEADING = 1.28 / 72.0  # line height in inches per point


@dataclass
class Pages:
    """The page being filled: `y` inches are used from the top; `number` counts pages."""

    file: PdfPages
    title: str
    number: int = 0
    y: float = TOP
    figure: Figure | None = None
    drawings: list[tuple[Drawing, float]] = field(default_factory=list)

    def need(self, height_in: float) -> None:
        """Begin a new page unless so much is left on this one."""
        if self.figure is None or self.y + height_in > PAGE_IN[1] - BOTTOM:
            self.finish()
            self._begin()

    def _begin(self) -> None:
        from matplotlib.figure import Figure

        self.figure, self.y = Figure(figsize=PAGE_IN, layout="constrained"), TOP
        self.number += 1
        if self.number > 1:
            self.put(self.title, LEFT, 0.5, 8.0, color="#666666")
        self.put(str(self.number), PAGE_IN[0] / 2, PAGE_IN[1] - 0.45, 8.0, color="#666666", ha="center")

    def put(self, text: str, x: float, y: float, size: float, **style: Any) -> None:
        """Set one line with its top at (x, y) inches from the upper left corner."""
        assert self.figure is not None
        look: dict[str, Any] = {"va": "top", "ha": "left", "parse_math": False} | style
        self.figure.text(x / PAGE_IN[0], 1.0 - y / PAGE_IN[1], text, fontsize=size, **look)

    def rule(self, y: float, width_pt: float, left: float = LEFT, length: float = TEXT_WIDTH_IN) -> None:
        """Draw a horizontal rule y inches from the top."""
        from matplotlib.lines import Line2D

        assert self.figure is not None
        x = [left / PAGE_IN[0], (left + length) / PAGE_IN[0]]
        height = 1.0 - y / PAGE_IN[1]
        self.figure.add_artist(Line2D(x, [height, height], color="black", linewidth=width_pt))

    def finish(self) -> None:
        """Put the page's drawings in place and write it."""
        if self.figure is None:
            return
        self._place_drawings()
        self.file.savefig(self.figure, dpi=PIXELS_PER_INCH)
        self.figure, self.drawings = None, []

    def _place_drawings(self) -> None:
        """One row of a grid for every drawing and for every gap; a subfigure keeps to its row."""
        if not self.drawings or self.figure is None:
            return
        heights, y = [], 0.0
        for drawing, top in self.drawings:
            heights += [max(top - y, 1e-3), drawing.height_in]
            y = top + drawing.height_in
        grid = self.figure.add_gridspec(
            len(heights) + 1,
            3,
            height_ratios=[*heights, PAGE_IN[1] - y],
            width_ratios=[LEFT, TEXT_WIDTH_IN, LEFT],
        )
        for k, (drawing, _) in enumerate(self.drawings):
            draw_on(self.figure.add_subfigure(grid[2 * k + 1, 1]), drawing)


def write_pdf(report: Report, path: Path) -> None:
    """Write the report, whole or not at all. Raises StorageError."""
    import matplotlib
    from matplotlib.backends.backend_pdf import PdfPages

    whole = io.BytesIO()
    facts = {"Title": report.title, "Creator": "wrinklebench", "CreationDate": None}
    with matplotlib.rc_context(FIGURE_STYLE), PdfPages(whole, metadata=facts) as file:
        pages = Pages(file, report.title)
        _title(pages, report)
        for k, section in enumerate(report.sections):
            _section(pages, section, new_page=k == 1)
        _heading(pages, "Versions and machine", 12.0)
        for line in report.footer:
            _paragraph(pages, line, 8.0)
        pages.finish()
    write_atomically(path, lambda file: file.write(whole.getvalue()))


def _title(pages: Pages, report: Report) -> None:
    pages.need(3.0)
    pages.y = 1.2
    for line in wrap(report.title, 21.0, TEXT_WIDTH_IN):
        pages.put(line, LEFT, pages.y, 21.0)
        pages.y += 21.0 * LEADING
    pages.y += 0.1
    _paragraph(pages, report.subtitle, BODY_PT, style="italic", color="#444444")
    pages.y += 0.2


def _section(pages: Pages, section: Section, new_page: bool) -> None:
    if new_page:
        pages.need(PAGE_IN[1])
    first = section.blocks[0] if section.blocks else None
    room = first.height_in + 1.0 if isinstance(first, Drawing) else 1.5
    pages.need(min(room, 6.0))
    _heading(pages, section.title, 15.0)
    for block in section.blocks:
        if isinstance(block, Drawing):
            _drawing(pages, block)
        elif isinstance(block, Table) and block.folded:
            _paragraph(pages, f"{block.caption} Its {len(block.rows)} rows are on the web page.", BODY_PT)
        elif isinstance(block, Table):
            _table(pages, block)
        else:
            _text(pages, block)


def _heading(pages: Pages, text: str, size: float) -> None:
    pages.need(1.0)
    pages.y += 0.15 if pages.y > TOP else 0.0
    pages.put(text, LEFT, pages.y, size, weight="bold")
    pages.y += size * LEADING + 0.1


def _paragraph(pages: Pages, text: str, size: float, indent: float = 0.0, **style: Any) -> None:
    for line in wrap(text, size, TEXT_WIDTH_IN - indent):
        pages.need(size * LEADING)
        pages.put(line, LEFT + indent, pages.y, size, **style)
        pages.y += size * LEADING
    pages.y += 0.07


def _text(pages: Pages, block: Text) -> None:
    if block.text:
        _paragraph(pages, block.text, BODY_PT)
    for item in block.items:
        pages.need(BODY_PT * LEADING)
        pages.put("•", LEFT + 0.05, pages.y, BODY_PT)
        _paragraph(pages, item, BODY_PT, indent=0.2)


def _drawing(pages: Pages, block: Drawing) -> None:
    title_width = width_in(f"{block.title}.", CAPTION_PT, True) + 0.06
    # bold is wider: the whole caption is broken as if the line were shorter by the difference
    narrower = title_width - width_in(f"{block.title}. ", CAPTION_PT)
    caption = wrap(f"{block.title}. {block.caption}", CAPTION_PT, TEXT_WIDTH_IN - max(narrower, 0.0))
    pages.need(block.height_in + 0.3 + len(caption) * CAPTION_PT * LEADING)
    pages.y += 0.08
    pages.drawings.append((block, pages.y))
    pages.y += block.height_in + 0.06
    for k, line in enumerate(caption):
        if k == 0:  # the title in bold over its own place; the rest of the line after it
            pages.put(f"{block.title}.", LEFT, pages.y, CAPTION_PT, weight="bold")
            rest = line.removeprefix(f"{block.title}.").strip()
            pages.put(rest, LEFT + title_width, pages.y, CAPTION_PT)
        else:
            pages.put(line, LEFT, pages.y, CAPTION_PT)
        pages.y += CAPTION_PT * LEADING
    pages.y += 0.2


def _table(pages: Pages, block: Table) -> None:
    """A table with three rules; its head is repeated where it goes on on another page."""
    widths = column_widths(block.columns, block.rows, TABLE_PT, TEXT_WIDTH_IN)
    cells = [_wrapped(row, widths, False) for row in block.rows]
    right = numeric_columns(block)
    head = _wrapped(block.columns, widths, True)
    caption = wrap(block.caption, CAPTION_PT, TEXT_WIDTH_IN)
    line = TABLE_PT * LEADING
    together = cells if len(cells) <= KEPT_ROWS else cells[:4]
    rows = sum(_lines(row) * line + ROW_GAP for row in (head, *together))
    pages.need(len(caption) * CAPTION_PT * LEADING + rows + 0.35)
    pages.y += 0.06
    for text in caption:
        pages.put(text, LEFT, pages.y, CAPTION_PT)
        pages.y += CAPTION_PT * LEADING
    _head(pages, head, widths, right)
    for row in cells:
        if pages.y + _lines(row) * line + 0.1 > PAGE_IN[1] - BOTTOM:
            pages.rule(pages.y + 0.03, 0.9, length=sum(widths))
            pages.need(PAGE_IN[1])
            _head(pages, head, widths, right)
        _row(pages, row, widths, right)
    pages.rule(pages.y + 0.03, 0.9, length=sum(widths))
    pages.y += 0.25


def _wrapped(row: tuple[str, ...], widths: list[float], bold: bool) -> list[list[str]]:
    return [wrap(cell, TABLE_PT, width - 0.08, bold) for cell, width in zip(row, widths, strict=True)]


def _lines(row: list[list[str]]) -> int:
    return max(len(cell) for cell in row)


def _head(pages: Pages, head: list[list[str]], widths: list[float], right: list[bool]) -> None:
    pages.y += 0.04
    pages.rule(pages.y, 0.9, length=sum(widths))
    pages.y += 0.04
    lowered = [[""] * (_lines(head) - len(cell)) + cell for cell in head]
    _row(pages, lowered, widths, right, weight="bold")
    pages.rule(pages.y + 0.01, 0.5, length=sum(widths))
    pages.y += 0.05


def _row(pages: Pages, row: list[list[str]], widths: list[float], right: list[bool], **style: Any) -> None:
    x = LEFT
    for cell, width, flush_right in zip(row, widths, right, strict=True):
        for k, text in enumerate(cell):
            y = pages.y + k * TABLE_PT * LEADING
            if flush_right:
                pages.put(text, x + width - 0.13, y, TABLE_PT, ha="right", **style)
            else:
                pages.put(text, x, y, TABLE_PT, **style)
        x += width
    pages.y += _lines(row) * TABLE_PT * LEADING + ROW_GAP
