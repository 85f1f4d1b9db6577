"""Measures of the sheared sheet on a sequence of meshes and from several random starts, with what is to be believed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from reports.figures_shear import SHADES, Load, pre_stretch
from reports.style import whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

LINES = ("-", (0, (3, 1.5)))  # of the smaller and the larger displacement
BESIDE = (1.18, 1.3, 1.42, 1.56)  # places of the ranges, over the nodes of the finest mesh


@dataclass(frozen=True)
class Series:
    """One measure of one load. meshes : (m, 2) nodes and values. starts : (k, 2), of further seeds.

    low, high : lowest and highest value to believe.
    """

    load: Load
    meshes: np.ndarray
    starts: np.ndarray
    low: float
    high: float


def bands(fig: FigureBase, panels: Sequence[tuple[str, Sequence[Series]]]) -> None:
    """One panel for each measure, every load over its value on its finest mesh."""
    axes = fig.subplots(2, 3).ravel()
    moves = sorted({series.load[0] for _, group in panels for series in group})
    for k, (ax, (name, group)) in enumerate(zip(axes, panels, strict=False)):
        for place, series in zip(BESIDE, group, strict=False):
            _draw(ax, series, LINES[moves.index(series.load[0]) % len(LINES)], place)
        ax.axhline(1.0, color="#BBBBBB", linewidth=0.6, zorder=0)
        ax.set_xscale("log")
        ax.set_title(f"({'abcdef'[k]}) {name}")
        nodes = sorted({n for series in group for n in series.meshes[:, 0]})
        ax.set_xticks(nodes, [whole(n) for n in nodes])
        ax.minorticks_off()
        ax.set_xlabel("nodes (–)")
        ax.set_ylabel("over the finest mesh (–)")
    handles, labels = axes[0].get_legend_handles_labels()
    if handles:
        fig.legend(handles, labels, loc="outside lower center", ncols=4)


def _draw(ax: Axes, series: Series, line: object, place: float) -> None:
    """Meshes as a line, further seeds as open marks, the range to believe as a bar to the right."""
    nodes, values = series.meshes.T
    unit = values[-1] if values[-1] else 1.0
    move, rise = series.load
    shade = SHADES[1 if rise else 0]
    label = f"{move:g} mm, {pre_stretch(rise)}"
    ax.plot(
        nodes, values / unit, "o", linestyle=line, color=shade, linewidth=1.0, markersize=3.0, label=label
    )
    if len(series.starts):
        starts = series.starts[:, 1] / unit
        ax.plot(series.starts[:, 0], starts, "D", color=shade, markerfacecolor="none", markersize=4.0)
    middle, half = 0.5 * (series.low + series.high) / unit, 0.5 * (series.high - series.low) / abs(unit)
    ax.errorbar(place * nodes[-1], middle, half, color=shade, capsize=2.0, linewidth=1.2, linestyle="none")
