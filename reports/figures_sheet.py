"""Figures of the rectangles and of the verification ladder."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reports.figures_annulus import Runs, curve, draw_lit
from reports.figures_hole import draw_heights, draw_relief, draw_states
from reports.stored import Stored
from reports.style import STRETCH_MAJOR, STRETCH_MINOR, colour, line, method_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

ORDER = ("membrane", "tension-field", "koiter", "exact")


def stretched(fig: FigureBase, runs: Runs) -> None:
    """The pulled strip: relief and height of the plate, states of the relaxed membrane, profile across it."""
    left, right = _split(fig)
    draw_relief(left[0], runs.get("koiter"), "(a) plate, in relief")
    draw_heights(fig, left[1], runs.get("koiter"), "(b) plate, height")
    draw_states(left[2], runs.get("tension-field"), "(c) relaxed membrane")
    for ax in left[1:]:
        ax.set_ylabel("")
    _profile(right[0], runs)
    _stretch_along(right[1], runs, "stretch_minor", STRETCH_MINOR, "(e) second stretch across the middle")


def _split(fig: FigureBase) -> tuple[list[Axes], list[Axes]]:
    grid = fig.add_gridspec(2, 4, width_ratios=[1.0, 1.0, 1.0, 1.5])
    return [fig.add_subplot(grid[:, k]) for k in range(3)], [fig.add_subplot(grid[k, 3]) for k in range(2)]


def _profile(ax: Axes, runs: Runs) -> None:
    for method in ("membrane", "koiter"):
        stored = runs.get(method)
        section = stored.section("midsection") if stored is not None else {}
        if section:
            curve(ax, section["x_mm"], section["z_mm"], method)
    ax.set_xlabel("$X$ (mm)")
    ax.set_ylabel("height $z$ (mm)")
    ax.set_title("(d) height across the middle")
    if ax.lines:
        ax.legend(fontsize=7)


def _stretch_along(ax: Axes, runs: Runs, field: str, label: str, title: str) -> None:
    """A stretch along the scene's own path, by every method: against the radius where there is one."""
    x_label = "distance along the path (mm)"
    for method in ORDER:
        stored = runs.get(method)
        path = _first_path(stored)
        if not path or field not in path:
            continue
        x = path.get("R_mm", path.get("s_mm"))
        x_label = "$R$ (mm)" if "R_mm" in path else x_label
        curve(ax, np.asarray(x), path[field], method)
    ax.set_xlabel(x_label)
    ax.set_ylabel(label)
    ax.set_title(title)


def _first_path(stored: Stored | None) -> dict[str, np.ndarray]:
    for name in ("radius", "midsection", "along_x"):
        if stored is not None and (path := stored.path(name)):
            return dict(path)
    return {}


def ladder(fig: FigureBase, runs: Runs) -> None:
    """One scene of the ladder: the sheet, then both stretches along its path by every method."""
    axes = fig.subplots(1, 3)
    shown = next((runs[m] for m in ("tension-field", "koiter", "membrane") if runs.get(m) is not None), None)
    flat = shown is not None and shown.drawable and np.ptp(shown.fields["r"][..., 2]) < 1e-3
    if flat:
        draw_states(axes[0], shown, "(a) relaxed membrane, state")
    else:
        draw_lit(axes[0], shown, "(a) relaxed membrane, state", coloured=True)
    _stretch_along(axes[1], runs, "stretch_major", STRETCH_MAJOR, "(b) largest stretch")
    _stretch_along(axes[2], runs, "stretch_minor", STRETCH_MINOR, "(c) second stretch")
    for ax in axes[1:]:
        _widen(ax)
    _key(axes[1], runs)


def _widen(ax: Axes) -> None:
    """Keep a constant from filling its axis with rounding."""
    low, high = ax.get_ylim()
    if high - low < 1e-5:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 5e-6, middle + 5e-6)


def _key(ax: Axes, runs: Runs) -> None:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=colour(m), linestyle=line(m), label=method_name(m))
        for m in ORDER
        if _first_path(runs.get(m))
    ]
    if handles:
        ax.legend(handles=handles, fontsize=6.5, loc="best")
