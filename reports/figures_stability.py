"""The least thickness at which flat strips are stable, against strain and aspect ratio, with error bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from reports.stored import Columns

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

MARKERS = "os^Dv<>p"
LEAST_STABLE = "least stable thickness (mm)"
BARS = {"markersize": 3.0, "linewidth": 1.0, "elinewidth": 0.7, "capsize": 1.5}


def stability_map(fig: FigureBase, over: Columns, thickness_mm: float) -> None:
    """Curves against the strain, one for each aspect ratio; their largest values against the aspect ratio."""
    from matplotlib import colormaps

    left, right = fig.subplots(1, 2, width_ratios=[1.5, 1.0])
    aspects = np.unique(over["aspect"])
    highest = []
    for k, aspect in enumerate(aspects):
        mine = over["aspect"] == aspect
        strain, value, error = (100.0 * over["strain"][mine], *_values(over, mine))
        colour = colormaps["viridis"](0.9 * k / max(len(aspects) - 1, 1))
        left.errorbar(
            strain, value, error, color=colour, marker=MARKERS[k % len(MARKERS)], label=f"{aspect:g}", **BARS
        )
        highest.append((value.max(), error[value.argmax()]))
    right.errorbar(aspects, *np.transpose(highest), color="black", marker="o", **BARS)
    for ax, letter in ((left, "a"), (right, "b")):
        _thickness(ax, thickness_mm)
        ax.set(ylabel=LEAST_STABLE, title=f"({letter})")
        ax.set_ylim(bottom=0.0)
    left.set_ylim(top=1.3 * left.get_ylim()[1])  # room for the legend
    left.set_xlabel("strain (%)")
    left.legend(title="height over width", ncols=2)
    right.set_xlabel("height over width (–)")


def _values(over: Columns, mine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return over["neutral_thickness_mm"][mine], over["error_mm"][mine]


def _thickness(ax: Axes, thickness_mm: float) -> None:
    if math.isfinite(thickness_mm):
        ax.axhline(thickness_mm, color="#777777", linewidth=0.8, linestyle=(0, (4, 3)))
