"""Figures of the built-in parameter studies, from their tables."""

from __future__ import annotations

import json
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
MARKERS = "osD^v"


def thickness(figure: FigureBase, table: pd.DataFrame) -> None:
    """Wavelength and amplitude against thickness, both scales logarithmic."""
    ready = table[table["status"] == "converged"].assign(pull=_component(table[PULL], 1))
    measures = (("wavelength_mm", "wavelength (mm)"), ("amplitude_mm", "amplitude (mm)"))
    for k, (name, label) in enumerate(measures):
        ax = figure.add_subplot(1, 2, k + 1)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlabel("thickness (mm)")
        ax.set_ylabel(label)
        if SECTION + name not in ready:
            continue
        wrinkled = ready[ready[SECTION + "wavelength_mm"].notna()]
        for (method, pull), group in wrinkled.groupby(["method", "pull"]):
            marker = MARKERS[sorted(wrinkled["pull"].unique()).index(pull) % len(MARKERS)]
            line = group.sort_values(H)
            ax.plot(
                line[H],
                line[SECTION + name],
                marker=marker,
                color=colour(str(method)),
                label=f"{method}, {pull:g} mm",
            )
        if k == 0:
            _slope(ax, wrinkled[H], wrinkled[SECTION + name])
            ax.legend(loc="upper left", fontsize=6.0)


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
