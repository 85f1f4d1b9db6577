"""Figures of the pulled sheet with a hole: Fig. 7 and Fig. 8 of Taylor et al. (2014)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reports.figures_annulus import Runs, curve
from reports.maps import (
    height_map,
    limits,
    plan_axes,
    state_legend,
    state_map,
    unavailable,
    zone_map,
    zone_rgb,
)
from reports.stored import Columns, Stored
from reports.style import STRETCH_MAJOR, STRETCH_MINOR, method_name
from reports.surface import View, lit_view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

RELIEF_SLOPE = 0.35  # rms slope to which the shading exaggerates shallow wrinkles
METHODS = ("membrane", "tension-field", "koiter")


def relief_factor(stored: Stored) -> float:
    """Factor on z that gives the lit wrinkles an rms slope of RELIEF_SLOPE, at least 1 and at most 200."""
    r = stored.fields["r"]
    slopes = []
    for axis in (0, 1):
        step = np.diff(r, axis=axis)
        run = np.linalg.norm(step[..., :2], axis=-1)
        slopes.append((step[..., 2] / np.where(run > 0.0, run, 1.0)).ravel())
    rms = float(np.sqrt(np.mean(np.concatenate(slopes) ** 2)))
    return float(np.clip(RELIEF_SLOPE / rms, 1.0, 200.0)) if rms > 1e-9 else 1.0


def draw_relief(ax: Axes, stored: Stored | None, title: str) -> None:
    """Deformed sheet from above as shaded relief, in mm."""
    if stored is None or not stored.drawable:
        unavailable(ax, title, stored)
        return
    picture = lit_view(
        stored.fields["r"], zone_rgb(stored, False), stored.closed, View(), relief=relief_factor(stored)
    )
    ax.imshow(picture.rgba, extent=picture.extent, interpolation="antialiased")
    plan_axes(ax, "deformed")
    ax.set_title(title)


def draw_states(ax: Axes, stored: Stored | None, title: str) -> None:
    """Map of slack, wrinkled and tense zones on the deformed sheet."""
    if stored is None or not stored.drawable:
        unavailable(ax, title, stored)
        return
    state_map(ax, stored)
    ax.set_title(title)


def draw_heights(fig: FigureBase, ax: Axes, stored: Stored | None, title: str) -> None:
    """Map of the height of the deformed sheet with its colour bar."""
    if stored is None or not stored.drawable:
        unavailable(ax, title, stored)
        return
    mesh = height_map(ax, stored)
    fig.colorbar(mesh, ax=ax, label="height $z$ (mm)", location="bottom", shrink=0.9, aspect=14, pad=0.02)
    ax.set_title(title)


def deformed(fig: FigureBase, runs: Runs) -> None:
    """Fig. 7: the plate's wrinkles in relief and by height, beside both membranes' states."""
    axes = fig.subplots(1, 4, sharey=True)
    draw_relief(axes[0], runs.get("koiter"), "(a) plate, in relief")
    draw_heights(fig, axes[1], runs.get("koiter"), "(b) plate, height")
    draw_states(axes[2], runs.get("koiter"), "(c) plate, state")
    draw_states(axes[3], runs.get("tension-field"), "(d) relaxed membrane")
    for ax in axes[1:]:
        ax.set_ylabel("")
        ax.tick_params(labelleft=False, left=False)
    if axes[3].axison:
        state_legend(axes[3], loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=1)


def stretch_maps(fig: FigureBase, runs: Runs) -> None:
    """Fig. 8 a: largest principal stretch over the reference sheet by every method."""
    order = ("koiter", "tension-field", "membrane")
    axes = fig.subplots(1, 3, sharey=True)
    there = {m: s for m in order if (s := runs.get(m)) is not None and s.drawable}
    low, high = limits(*(s.fields["stretch_major"] for s in there.values()))
    mesh = None
    for ax, method, letter in zip(axes, order, "abc", strict=True):
        title = f"({letter}) {method_name(method).split(' (')[0]}"
        if method not in there:
            unavailable(ax, title, runs.get(method))
            continue
        stored = there[method]
        values = stored.fields["stretch_major"]
        if method == "tension-field":  # a slack zone has no stretch of its own
            values = np.where(stored.fields["state"] == 0, np.nan, values)
        ax.set_facecolor("#E4E4E4")
        mesh = zone_map(ax, stored, values, cmap="viridis", vmin=low, vmax=high)
        ax.set_facecolor("white")
        ax.set_title(title)
        ax.label_outer()
    if mesh is not None:
        fig.colorbar(mesh, ax=axes, label=STRETCH_MAJOR, extend="both", aspect=35, pad=0.03)


def paths(fig: FigureBase, runs: Runs) -> None:
    """Fig. 8 b, c: both principal stretches along both paths, from the hole's edge and from its centre."""
    axes = fig.subplots(2, 2, sharex="col", sharey="row")
    for column, (name, letter) in enumerate((("along_x", "X"), ("along_y", "Y"))):
        half_length = None
        for method in METHODS:
            stored = runs.get(method)
            path = stored.path(name) if stored is not None else {}
            if stored is None or not path:
                continue
            half_length = _half_length(stored, half_length)
            for row, field in enumerate(("stretch_major", "stretch_minor")):
                curve(axes[row, column], path["s_mm"], _where_not_slack(path, field, method), method)
            start = float(np.hypot(path["x_mm"][0], path["y_mm"][0]))
        axes[1, column].set_xlabel(f"distance from the hole's edge along ${letter}$ (mm)")
        axes[1, column].set_title(f"({'cd'[column]}) second stretch along ${letter}$")
        if half_length is None:
            axes[0, column].set_title(f"({'ab'[column]}) largest stretch along ${letter}$")
            continue
        top = axes[0, column].secondary_xaxis(
            "top",
            functions=(
                lambda s, a=start, h=half_length: (s + a) / h,
                lambda x, a=start, h=half_length: x * h - a,
            ),
        )
        top.set_xlabel(f"({'ab'[column]}) distance from the centre along ${letter}$ / half length (–)")
        top.tick_params(labelsize=7.5)
    axes[0, 0].set_ylabel(STRETCH_MAJOR)
    axes[1, 0].set_ylabel(STRETCH_MINOR)
    if axes[0, 0].lines:
        axes[0, 0].legend()


def _where_not_slack(path: Columns, field: str, method: str) -> np.ndarray:
    """A path's stretch, NaN in the relaxed membrane's slack zones, where it is not unique."""
    values = path[field]
    slack = (
        np.rint(path["state"]) == 0 if "state" in path and method == "tension-field" else np.zeros(1, bool)
    )
    return np.where(slack, np.nan, values)


def _half_length(stored: Stored, otherwise: float | None) -> float:
    """Half of the longer side of the sheet, mm: the paper's unit of distance."""
    sheet = stored.scene.get("sheet")
    if isinstance(sheet, dict) and "height_mm" in sheet:
        return 0.5 * max(float(sheet["height_mm"]), float(sheet["width_mm"]))
    u = stored.fields["u"]
    return otherwise or 0.5 * float(np.ptp(u.reshape(-1, 2), axis=0).max())
