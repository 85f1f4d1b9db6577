"""Drawings made into figures: on their own for the page, or on a part of a page of the PDF."""

from __future__ import annotations

import base64
import io
import sys
from typing import TYPE_CHECKING

from reports.content import TEXT_WIDTH_IN, Drawing
from reports.style import FIGURE_STYLE

if TYPE_CHECKING:
    from matplotlib.figure import Figure, FigureBase

PIXELS_PER_INCH = 220  # 1500 pixels across the text: sharp on a telephone's screen and in print


def draw_on(fig: FigureBase, drawing: Drawing) -> None:
    """Draw; a drawing that breaks on an odd result says so in its place, and the report goes on."""
    try:
        drawing.draw(fig)
    except Exception as error:
        print(f"{drawing.title} could not be drawn: {error!r}", file=sys.stderr)
        fig.clear()
        fig.text(
            0.5, 0.5, "This figure could not be drawn from the stored results.", ha="center", color="#8A1C1C"
        )


def make_figure(drawing: Drawing) -> Figure:
    """Return the drawing as a figure of its own, at the width of the text."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(FIGURE_STYLE):
        fig = Figure(figsize=(TEXT_WIDTH_IN, drawing.height_in), layout="constrained")
        draw_on(fig, drawing)
    return fig


def data_uri(drawing: Drawing) -> str:
    """Return the drawing as a data URI, SVG or PNG."""
    import matplotlib

    kind = "svg" if drawing.vector else "png"
    stream = io.BytesIO()
    with matplotlib.rc_context(FIGURE_STYLE):
        # no date: equal reports from equal results
        metadata = {"Date": None} if kind == "svg" else None
        make_figure(drawing).savefig(stream, format=kind, dpi=PIXELS_PER_INCH, metadata=metadata)
    mime = {"svg": "image/svg+xml", "png": "image/png"}[kind]
    return f"data:{mime};base64,{base64.b64encode(stream.getvalue()).decode('ascii')}"
