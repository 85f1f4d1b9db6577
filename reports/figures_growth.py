"""Time, memory and steps against the size of the mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from reports.style import colour, label_sparsely, line, method_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

ROAD_COLOURS = ("#777777", "#0072B2", "#D55E00")
Rows = Sequence[Mapping[str, Any]]


def scaling(figure: FigureBase, methods: Mapping[str, Rows]) -> None:
    """CPU time and memory against nodes, a line for each method."""
    panels = (("cpu_seconds", "CPU time (s)"), ("peak_memory_MB", "peak memory (MB)"))
    for k, (key, label) in enumerate(panels):
        ax = _axes(figure, k, label)
        for method, rows in methods.items():
            _line(ax, rows, key, color=colour(method), linestyle=line(method), label=method_name(method))
        if k == 0:
            ax.set_ylim(top=30.0 * ax.get_ylim()[1])  # room for the legend
            ax.legend(loc="upper left", fontsize=6.5)


def roads(figure: FigureBase, found: Mapping[str, Rows]) -> None:
    """Steps and CPU time against nodes, a line for each road."""
    for k, (key, label) in enumerate((("steps", "steps"), ("cpu_seconds", "CPU time (s)"))):
        ax = _axes(figure, k, label)
        for (road, rows), shade in zip(found.items(), ROAD_COLOURS, strict=False):
            _line(ax, rows, key, color=shade, label=road)
        label_sparsely(ax.xaxis)
        if k == 0:
            ax.set_ylim(top=3.0 * ax.get_ylim()[1])
            ax.legend(loc="upper left")
        label_sparsely(ax.yaxis)


def _axes(figure: FigureBase, k: int, label: str) -> Axes:
    ax = figure.add_subplot(1, 2, k + 1)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("nodes")
    ax.set_ylabel(label)
    return ax


def _line(ax: Axes, rows: Rows, key: str, **style: Any) -> None:
    """The converged runs joined; crosses for the others that have a value."""
    good = [row for row in rows if row["status"] == "converged"]
    ax.plot([row["nodes"] for row in good], [row[key] for row in good], marker="o", markersize=3.0, **style)
    bad = [
        row
        for row in rows
        if row["status"] not in ("converged", "left out") and row.get(key) and row.get("nodes")
    ]
    ax.plot([row["nodes"] for row in bad], [row[key] for row in bad], "x", color=style["color"])
