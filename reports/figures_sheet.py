"""Figures of the rectangles and of the verification ladder."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reports.curves import Runs, curve, key, widen
from reports.figures_annulus import draw_lit
from reports.figures_hole import draw_heights, draw_relief
from reports.maps import draw_states, state_handles
from reports.stored import Columns, Stored
from reports.style import STRETCH_MAJOR, STRETCH_MINOR

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

ORDER = ("membrane", "tension-field", "koiter", "exact")
SEEN_FLAT_MM = 1e-3  # sheets that rise less are drawn as plans


def stretched(fig: FigureBase, runs: Runs) -> None:
    """The pulled strip: relief and height of the plate, states of the relaxed membrane, profile across it."""
    grid = fig.add_gridspec(2, 4, width_ratios=[1.0, 1.0, 1.0, 1.7])
    plans = [fig.add_subplot(grid[:, k]) for k in range(3)]
    plots = [fig.add_subplot(grid[k, 3]) for k in range(2)]
    draw_relief(plans[0], runs.get("koiter"), "(a) plate, in relief")
    draw_heights(fig, plans[1], runs.get("koiter"), "(b) plate, height")
    draw_states(plans[2], runs.get("tension-field"), "(c) relaxed, state")
    for ax in plans[1:]:
        if ax.axison:
            ax.set_ylabel("")
            ax.tick_params(labelleft=False, left=False)
    _profile(plots[0], runs)
    _stretch_along(plots[1], runs, "stretch_minor", STRETCH_MINOR, "(e) second stretch")
    handles = [*key(runs, ORDER), *state_handles()]
    plots[1].legend(handles=handles, loc="upper center", bbox_to_anchor=(0.45, -0.32), ncols=2, fontsize=7)


def _profile(ax: Axes, runs: Runs) -> None:
    for method in ("membrane", "koiter"):
        stored = runs.get(method)
        section = stored.section("midsection") if stored is not None else {}
        if section:
            curve(ax, section["x_mm"], section["z_mm"], method)
    ax.set_xlabel("$X$ (mm)")
    ax.set_ylabel("height $z$ (mm)")
    ax.set_title("(d) height across the middle")


def _stretch_along(ax: Axes, runs: Runs, field: str, label: str, title: str) -> None:
    """A stretch along the scene's own path, by every method: against the radius where there is one."""
    x_label = "distance along the path (mm)"
    for method in ORDER:
        path = first_path(runs.get(method))
        if not path or field not in path:
            continue
        if "R_mm" in path:
            x_label = "$R$ (mm)"
        curve(ax, np.asarray(path.get("R_mm", path.get("s_mm"))), path[field], method)
    widen(ax)
    ax.set_xlabel(x_label)
    ax.set_ylabel(label)
    ax.set_title(title)


def first_path(stored: Stored | None) -> Columns:
    """The path along which a scene's stretches are drawn; {} without one."""
    for name in ("radius", "midsection", "along_x"):
        if stored is not None and (path := stored.path(name)):
            return path
    return {}


def ladder(fig: FigureBase, runs: Runs) -> None:
    """One scene of the ladder: the sheet, then both stretches along its path by every method."""
    axes = fig.subplots(1, 3)
    candidates = [runs.get(m) for m in ("tension-field", "koiter", "exact")]
    shown = next((s for s in candidates if s is not None and s.drawable), candidates[0])
    if shown is not None and shown.drawable and np.ptp(shown.fields["r"][..., 2]) < SEEN_FLAT_MM:
        draw_states(axes[0], shown, "(a) relaxed membrane, state")
    else:
        draw_lit(axes[0], shown, "(a) relaxed membrane, state", coloured=True, pixels=700)
    _stretch_along(axes[1], runs, "stretch_major", STRETCH_MAJOR, "(b) largest stretch")
    _stretch_along(axes[2], runs, "stretch_minor", STRETCH_MINOR, "(c) second stretch")
    handles = [*state_handles(), *key(runs, ORDER)]
    fig.legend(handles=handles, loc="outside lower center", ncols=6, columnspacing=1.2, handlelength=1.6)
