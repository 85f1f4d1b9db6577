"""Figures of effects left out: verdicts against full runs, plans against outcomes, and two kinematics of one strip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

Row = Mapping[str, Any]
PROMISED = 1e-3  # largest relative difference of a reported quantity that "justified" allows
SMALLEST = 1e-9  # differences below are drawn here
VERDICT_COLOURS = {"justified": "#0072B2", "not justified": "#D55E00", "nothing left out": "#BBBBBB"}
VERDICT_MARKERS = {"justified": "o", "not justified": "D", "nothing left out": "."}
FORETOLD = {"steps": "#0072B2", "cpu_seconds": "#D55E00", "memory_MB": "#009E73"}
FORETOLD_WORDS = {"steps": "steps", "cpu_seconds": "CPU seconds", "memory_MB": "memory"}
KINEMATICS = {
    "finite": ("#0072B2", "o-", "finite strain"),
    "moderate": ("#D55E00", "D--", "moderate rotations"),
}


def verdicts(figure: FigureBase, table: Sequence[Row], random: Sequence[Row]) -> None:
    """The largest difference from a full run, run by run, coloured by the audit's verdict."""
    panels = [(rows, title) for rows, title in ((table, "ten problems"), (random, "random scenes")) if rows]
    axes = figure.subplots(1, len(panels), squeeze=False)[0]
    for k, (ax, (rows, title)) in enumerate(zip(axes, panels, strict=True)):
        _verdicts(ax, rows)
        ax.set_title(title)
        if k == 0:
            ax.set_xlabel("largest difference of a reported quantity (–)")
            handles, labels = ax.get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside upper right", ncols=4)


def _verdicts(ax: Axes, rows: Sequence[Row]) -> None:
    ax.set_xscale("log")
    ax.set_xlim(0.5 * SMALLEST, 3.0)
    ax.axvline(PROMISED, color="#555555", linewidth=0.8, linestyle=(0, (4, 2)), label="promised: 0.1 %")
    for verdict, colour in VERDICT_COLOURS.items():
        mine = [(k, row) for k, row in enumerate(rows) if row["verdict"] == verdict and row["comparable"]]
        ax.plot(
            [max(row["largest"]["difference"], SMALLEST) for _, row in mine],
            [k for k, _ in mine],
            VERDICT_MARKERS[verdict],
            color=colour,
            label=verdict,
        )
    lost = [k for k, row in enumerate(rows) if not row["comparable"]]
    ax.plot([1.5] * len(lost), lost, "x", color="#555555", label="a run did not come to rest")
    ax.set_yticks(range(len(rows)), [_short(row["what"], k) for k, row in enumerate(rows)], fontsize=6.5)
    ax.invert_yaxis()
    ax.grid(axis="y", color="#EEEEEE", linewidth=0.6)
    ax.set_axisbelow(True)


def _short(what: str, k: int) -> str:
    """A name that fits beside the axis: long ones are numbered as in their table."""
    return what if len(what) <= 20 else str(k + 1)


def foretold(figure: FigureBase, rows: Sequence[Row]) -> None:
    """What was foretold over what was found, run by run."""
    ax = figure.subplots()
    ax.set_xscale("log")
    ax.axvspan(0.5, 2.0, color="#F2F2F2", zorder=0)
    ax.axvline(1.0, color="#555555", linewidth=0.6)
    for k, (key, colour) in enumerate(FORETOLD.items()):
        known = [(place, row[key]) for place, row in enumerate(rows) if min(row[key]) > 0.0]
        ax.plot(
            [pair[0] / pair[1] for _, pair in known],
            [place + 0.2 * (k - 1) for place, _ in known],
            "oDs"[k],
            color=colour,
            label=FORETOLD_WORDS[key],
        )
    ax.set_xlim(0.2, 5.0)
    ax.set_xticks([0.25, 0.5, 1.0, 2.0, 4.0], ["1/4", "1/2", "1", "2", "4"])
    ax.minorticks_off()
    ax.set_yticks(range(len(rows)), [str(row["what"]).partition(", h/L")[0] for row in rows], fontsize=6.5)
    ax.invert_yaxis()
    ax.set_xlabel("foretold over found (–)")
    ax.legend(loc="lower right")


def kinematics(figure: FigureBase, curves: Mapping[str, Sequence[tuple[float, float, float]]]) -> None:
    """Largest height and force of a pulled strip. curves : kinematics -> (pull in %, height in mm, force in N)."""
    axes = figure.subplots(1, 2)
    for name, points in curves.items():
        colour, style, label = KINEMATICS[name]
        pull = [point[0] for point in points]
        for ax, k in zip(axes, (1, 2), strict=True):
            ax.plot(pull, [point[k] for point in points], style, color=colour, label=label)
    for ax, label in zip(axes, ("largest height (mm)", "force (N)"), strict=True):
        ax.set_xlabel("pull (%)")
        ax.set_ylabel(label)
        ax.set_ylim(bottom=0.0)
    axes[0].legend(loc="upper left")
