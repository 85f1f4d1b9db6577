"""Figures of the pulled sheet with a hole: Fig. 7 and Fig. 8 of Taylor et al. (2014)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from reports.curves import Runs, curve, legend, widen
from reports.maps import (
    bar_below,
    draw_states,
    height_map,
    limits,
    plain_rgb,
    plan_axes,
    state_legend,
    unavailable,
    zone_map,
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
    relief = relief_factor(stored)
    picture = lit_view(stored.fields["r"], plain_rgb(stored), stored.closed, View(), 1000, relief)
    ax.imshow(picture.rgba, extent=picture.extent, interpolation="antialiased")
    plan_axes(ax, "deformed")
    ax.set_title(title)


def draw_heights(fig: FigureBase, ax: Axes, stored: Stored | None, title: str) -> None:
    """Map of the height of the deformed sheet with its colour bar."""
    if stored is None or not stored.drawable:
        unavailable(ax, title, stored)
        return
    bar_below(fig, ax, height_map(ax, stored), "height $z$ (mm)")
    ax.set_title(title)


def deformed(fig: FigureBase, runs: Runs) -> None:
    """Fig. 7: the plate's wrinkles in relief and by height, beside both membranes' states."""
    axes = fig.subplots(1, 4)
    draw_relief(axes[0], runs.get("koiter"), "(a) plate, in relief")
    draw_heights(fig, axes[1], runs.get("koiter"), "(b) plate, height")
    draw_states(axes[2], runs.get("koiter"), "(c) plate, state")
    draw_states(axes[3], runs.get("tension-field"), "(d) relaxed membrane, state")
    for ax in axes[1:]:
        if ax.axison:
            ax.set_ylabel("")
            ax.tick_params(labelleft=False, left=False)
    legend_under = next((ax for ax in (axes[3], axes[2]) if ax.axison), None)
    if legend_under is not None:
        state_legend(legend_under, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=1)


def stretch_maps(fig: FigureBase, runs: Runs) -> None:
    """Fig. 8 a: largest principal stretch over the reference sheet by every method."""
    order = ("koiter", "tension-field", "membrane")
    axes = fig.subplots(1, 3, sharey=True)
    there = {m: s for m in order if (s := runs.get(m)) is not None and s.drawable}
    fields = {m: _unique_stretch(s) for m, s in there.items()}
    span = limits(*fields.values())
    key = None
    for ax, method, letter in zip(axes, order, "abc", strict=True):
        title = f"({letter}) {method_name(method).split(' (')[0]}"
        if method not in there:
            unavailable(ax, title, runs.get(method))
            continue
        key = zone_map(ax, there[method], fields[method], "reference", "viridis", span)
        ax.set_title(title)
        ax.label_outer()
    if key is not None:
        fig.colorbar(key, ax=axes, label=STRETCH_MAJOR, extend="both", aspect=35, pad=0.03)


def _unique_stretch(stored: Stored) -> np.ndarray:
    """The largest stretch of every zone, NaN where the relaxed membrane is slack and has none of its own."""
    values = stored.fields["stretch_major"]
    return (
        np.where(stored.fields["state"] == 0, np.nan, values) if stored.method == "tension-field" else values
    )


def paths(fig: FigureBase, runs: Runs) -> None:
    """Fig. 8 b, c: both principal stretches along both paths, from the hole's edge and from its centre."""
    axes = fig.subplots(2, 2, sharex="col", sharey="row")
    for column, (name, letter) in enumerate((("along_x", "X"), ("along_y", "Y"))):
        found = {m: s.path(name) for m in METHODS if (s := runs.get(m)) is not None and s.path(name)}
        for method, path in found.items():
            for row, field in enumerate(("stretch_major", "stretch_minor")):
                curve(axes[row, column], path["s_mm"], _where_not_slack(path, field, method), method)
        axes[1, column].set_xlabel(f"distance from the hole's edge along ${letter}$ (mm)")
        axes[0, column].set_title(f"({'ab'[column]}) largest stretch along ${letter}$")
        axes[1, column].set_title(f"({'cd'[column]}) second stretch along ${letter}$")
        if not found:
            for ax, method in zip(axes[:, column], ("koiter", "tension-field"), strict=True):
                unavailable(ax, ax.get_title(), runs.get(method))
        else:
            method, path = next(iter(found.items()))
            stored = runs[method]
            assert stored is not None
            _centre_axis(axes[0, column], path, half_length(stored), letter)
    for ax in axes.ravel():
        widen(ax)
    axes[0, 0].set_ylabel(STRETCH_MAJOR)
    axes[1, 0].set_ylabel(STRETCH_MINOR)
    legend(axes[0, 0], runs, METHODS)


def _centre_axis(ax: Axes, path: Columns, half: float, letter: str) -> None:
    """Second scale above: distance from the hole's centre in units of half the sheet's length."""
    start = float(np.hypot(path["x_mm"][0], path["y_mm"][0]))

    def from_centre(s: Any) -> Any:
        return (s + start) / half

    def from_edge(x: Any) -> Any:
        return x * half - start

    top = ax.secondary_xaxis("top", functions=(from_centre, from_edge))
    top.set_xlabel(f"from the centre along ${letter}$, in half lengths (–)")
    top.tick_params(labelsize=7.5)


def _where_not_slack(path: Columns, field: str, method: str) -> np.ndarray:
    """A path's stretch, NaN in the relaxed membrane's slack zones, where it is not unique."""
    slack = (np.rint(path["state"]) == 0) & (method == "tension-field")
    return np.where(slack, np.nan, path[field])


def half_length(stored: Stored) -> float:
    """Half of the longer side of the sheet, mm: the paper's unit of distance."""
    return 0.5 * float(np.ptp(stored.fields["u"].reshape(-1, 2), axis=0).max())
