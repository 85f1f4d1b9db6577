"""Work-precision figures: error against CPU time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from reports.style import colour, line, method_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

FAILED_AT = 1.02  # of the height of the axes: above the frame
SMALLEST = 1e-12  # errors below are rounding


def work_precision(
    figure: FigureBase,
    rows: Sequence[Mapping[str, Any]],
    titles: Mapping[str, str],
    fronts: Mapping[str, Mapping[str, Sequence[str]]],
) -> None:
    """One panel per quantity. rows : of cost.json. titles : quantity -> words.

    fronts : quantity -> model -> folders of the runs that none beats.
    """
    for k, (quantity, title) in enumerate(titles.items()):
        ax = figure.add_subplot(1, len(titles), k + 1)
        _panel(ax, rows, quantity, fronts[quantity].values())
        ax.set_title(title, pad=12)
        if k == 0:
            ax.set_ylabel("relative error (–)")
            ax.legend(loc="best")


def _panel(
    ax: Axes, rows: Sequence[Mapping[str, Any]], quantity: str, fronts: Iterable[Sequence[str]]
) -> None:
    key = f"error.{quantity}"
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("CPU time (s)")
    known = [row for row in rows if row["status"] == "converged" and key in row and row["method"] != "exact"]
    for front in fronts:
        best = [row for row in known if row["folder"] in front]
        best.sort(key=lambda row: row["cpu_seconds"])
        ax.plot(
            [row["cpu_seconds"] for row in best],
            [max(row[key], SMALLEST) for row in best],
            color="#CCCCCC",
            linewidth=3.5,
        )
    for method in dict.fromkeys(row["method"] for row in known):
        mine = [row for row in known if row["method"] == method]
        meshes = sorted((row for row in mine if not row["option"]), key=lambda row: row["nodes"])
        _points(ax, meshes, key, method, linestyle=line(method), marker="o", label=method_name(method))
        _points(
            ax, [row for row in mine if row["option"]], key, method, linestyle="none", marker=".", alpha=0.6
        )
    for row in rows:
        if row["status"] != "converged" and row["cpu_seconds"]:
            ax.plot(
                row["cpu_seconds"],
                FAILED_AT,
                marker="x",
                color=colour(row["method"]),
                transform=ax.get_xaxis_transform(),
                clip_on=False,
            )


def _points(ax: Axes, rows: Sequence[Mapping[str, Any]], key: str, method: str, **style: Any) -> None:
    """Medians with the spread of repeats."""
    if not rows:
        return
    x = [row["cpu_seconds"] for row in rows]
    spread = [
        [row["cpu_seconds"] - row["cpu_seconds_least"] for row in rows],
        [row["cpu_seconds_largest"] - row["cpu_seconds"] for row in rows],
    ]
    errors = [max(row[key], SMALLEST) for row in rows]
    ax.errorbar(x, errors, xerr=spread, color=colour(method), linewidth=1.2, elinewidth=0.7, **style)
