"""How the error estimates compare with the true errors, quantity by quantity."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.style import colour

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

SHOWN = (5.0, 95.0)  # per cent of the runs that a bar spans
LEAST, MOST = 1e-2, 1e3  # of the axis; what lies beyond is drawn at its end


def ratios(figure: FigureBase, quantities: Mapping[str, Mapping[str, Any]]) -> None:
    """Estimated over true error: the middle and the span of nine tenths of the runs, one row per quantity."""
    ax = figure.subplots()
    names = [name for name, one in quantities.items() if one["ratios"]]
    for row, name in enumerate(reversed(names)):
        known = np.clip(quantities[name]["ratios"], LEAST, MOST)
        low, high = np.percentile(known, SHOWN)
        ax.hlines(row, low, high, color=colour("koiter"), linewidth=2.5)
        ax.plot(np.median(known), row, "o", color=colour("exact"), markersize=4)
    ax.set_yticks(range(len(names)), names[::-1])
    ax.set_xscale("log")
    ax.set_xlim(LEAST, MOST)
    ax.axvspan(LEAST, 1.0, color="#F4E0D8", linewidth=0)
    ax.axvline(5.0, color="#999999", linewidth=0.8, linestyle="--")
    ax.set_xlabel("estimated error over true error (–)")
    ax.text(0.9, len(names) - 0.4, "too small", ha="right", fontsize=7)
    ax.text(5.5, len(names) - 0.4, "five times too large", ha="left", fontsize=7)
