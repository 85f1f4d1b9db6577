"""Figures of the built-in parameter studies, from their tables."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.style import WRINKLED_TINT, colour, method_name

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

H, PULL = "sheet.thickness_mm", "edges.top.move_mm"
TWIST, LIFT = "edges.inner.rotate_deg", "edges.inner.move_mm"
SECTION = "sections.midsection."
BAND_FROM, BAND_TO = "paths.radius.wrinkled_from_mm", "paths.radius.wrinkled_to_mm"
PULL_COLOURS = ("#440154", "#31688E", "#35B779", "#E0A800")
METHOD_MARKERS = {"koiter": "o", "koiter-published": "x", "postbuckling": "s"}


def thickness(figure: FigureBase, table: pd.DataFrame) -> None:
    """Wavelength and amplitude against thickness, both scales logarithmic: a colour per pull, a marker per method."""
    ready = table[table["status"] == "converged"].assign(pull=_component(table[PULL], 1))
    wrinkled = (
        ready[ready[SECTION + "wavelength_mm"].notna()] if SECTION + "wavelength_mm" in ready else ready[:0]
    )
    colours = dict(zip(sorted(wrinkled["pull"].unique()), PULL_COLOURS, strict=False))
    left, right = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2)
    measures = ((left, "wavelength_mm", "wavelength (mm)"), (right, "amplitude_mm", "amplitude (mm)"))
    for ax, name, label in measures:
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlabel("thickness (mm)")
        ax.set_ylabel(label)
        for (method, pull), group in wrinkled.groupby(["method", "pull"]):
            line = group.sort_values(H)
            ax.plot(
                line[H],
                line[SECTION + name],
                marker=METHOD_MARKERS.get(str(method), "."),
                color=colours.get(pull, "#777777"),
                linestyle="-" if method == "koiter" else "none",
                markersize=7.0 if method == "postbuckling" else 4.0,
                markerfacecolor="none" if method == "postbuckling" else None,
                label=f"{method}, {pull:g} mm",
            )
        _plain_ticks(ax, wrinkled[H])
    _slope(left, wrinkled[H], wrinkled.get(SECTION + "wavelength_mm", wrinkled[H]))
    _key(left, [(f"pulled {pull:g} mm", {"color": shade}) for pull, shade in colours.items()])
    methods = [str(method) for method in wrinkled["method"].unique()]
    looks = [
        (method_name(m), {"marker": METHOD_MARKERS.get(m, "."), "color": "#555555", "linestyle": "none"})
        for m in methods
    ]
    _key(right, looks)


def _key(ax: Axes, entries: Sequence[tuple[str, Mapping[str, Any]]]) -> None:
    """A legend of looks that stand for several lines."""
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], label=label, **look) for label, look in entries]
    if handles:
        ax.legend(handles=handles, fontsize=6.5, loc="lower right")


def _plain_ticks(ax: Axes, h: pd.Series) -> None:
    """The thicknesses themselves as ticks, without powers of ten."""
    from matplotlib.ticker import NullFormatter

    values = sorted(h.unique())
    ax.set_xticks(values, [f"{value:g}" for value in values])
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.yaxis.set_major_formatter("{x:g}")


def _slope(ax: Axes, h: pd.Series, wavelength: pd.Series) -> None:
    """A line of the power one half through the middle of the data."""
    if len(h) == 0:
        return
    ends = np.array([h.min(), h.max()])
    middle = np.exp(np.log(wavelength).mean() - 0.5 * np.log(h).mean())
    ax.plot(ends, middle * np.sqrt(ends), color="#BBBBBB", linewidth=3.0, zorder=0)


def band(figure: FigureBase, table: pd.DataFrame) -> None:
    """The wrinkled radii against twist, one panel per lift."""
    ready = table[table["status"] == "converged"].assign(lift=_component(table[LIFT], 2))
    lifts = sorted(ready["lift"].unique())
    shared: Any = None
    for k, lift in enumerate(lifts):
        ax = figure.add_subplot(1, len(lifts), k + 1, sharey=shared)
        shared = shared or ax
        mine = ready[ready["lift"] == lift]
        exact = mine[mine["method"] == "exact"].sort_values(TWIST)
        wrinkled = exact[exact[BAND_FROM].notna()]
        ax.fill_between(wrinkled[TWIST], wrinkled[BAND_FROM], wrinkled[BAND_TO], color=WRINKLED_TINT)
        ax.plot(wrinkled[TWIST], wrinkled[BAND_FROM], color=colour("exact"), linewidth=0.8)
        ax.plot(wrinkled[TWIST], wrinkled[BAND_TO], color=colour("exact"), linewidth=0.8)
        relaxed = mine[(mine["method"] == "tension-field") & mine[BAND_FROM].notna()]
        ax.vlines(
            relaxed[TWIST], relaxed[BAND_FROM], relaxed[BAND_TO], color=colour("tension-field"), linewidth=2.0
        )
        ax.set_title(f"lift {lift:g} mm")
        ax.set_xlabel("twist (degrees)")
        if k == 0:
            ax.set_ylabel("radius (mm)")
        else:
            ax.tick_params(labelleft=False)
        if k == len(lifts) - 1:  # most lifted, least wrinkled: there is room above
            ax.plot([], [], color=colour("exact"), linewidth=0.8, label=method_name("exact"))
            ax.plot([], [], color=colour("tension-field"), linewidth=2.0, label=method_name("tension-field"))
            ax.legend(loc="upper left", fontsize=6.0)


def _component(vectors: pd.Series, axis: int) -> pd.Series:
    """One component of a column of vectors, stored as text."""
    return vectors.map(lambda text: float(json.loads(text)[axis]))
