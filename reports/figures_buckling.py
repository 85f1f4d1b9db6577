"""Buckling modes over the undeformed sheet, several in a row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from reports.maps import plan_axes, unavailable
from reports.plans import HEIGHT_COLOURS
from reports.stored import Stored

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import Collection
    from matplotlib.figure import FigureBase


@dataclass(frozen=True)
class Panel:
    """One mode. stored : its run, None if it is not planned. k : which mode, from 0."""

    stored: Stored | None
    k: int
    title: str


def modes(fig: FigureBase, panels: Sequence[Panel], widths: Sequence[float]) -> None:
    """Modes in one row on one scale of colours. widths : of the panels, in any unit."""
    axes = fig.subplots(1, len(panels), width_ratios=widths, squeeze=False)[0]
    keys = [draw_mode(ax, panel) for ax, panel in zip(axes, panels, strict=True)]
    key = next((key for key in keys if key is not None), None)
    if key is not None:
        bar = fig.colorbar(key, ax=axes, label="height, largest 1 (–)", aspect=35, pad=0.02)
        bar.outline.set_linewidth(0.4)
    same = len({panel.stored.run.scene for panel in panels if panel.stored is not None}) == 1
    for ax in axes[1:] if same else ():
        if ax.axison:
            ax.set_ylabel("")
            ax.tick_params(labelleft=False, left=False)


def draw_mode(ax: Axes, panel: Panel) -> Collection | None:
    """A mode in colours between its vertices, and the rim of the sheet; the key of the colours."""
    stored = panel.stored
    if stored is None or len(stored.fields.get("modes", ())) <= panel.k:
        unavailable(ax, panel.title, stored)
        return None
    from matplotlib.collections import LineCollection
    from matplotlib.tri import Triangulation

    u, cells = stored.fields["u"], stored.fields["cells"]
    heights = stored.fields["modes"][panel.k]
    if heights[np.abs(heights).argmax()] < 0.0:  # the sign of a mode means nothing
        heights = -heights
    key = ax.tripcolor(
        Triangulation(u[:, 0], u[:, 1], halves(cells)),
        heights,
        shading="gouraud",
        cmap=HEIGHT_COLOURS,
        vmin=-1.0,
        vmax=1.0,
        rasterized=True,
    )
    ax.add_collection(LineCollection(list(u[rim(cells)]), colors="#777777", linewidths=0.5))
    plan_axes(ax, "reference")
    ax.set_title(panel.title)
    return key


def halves(cells: np.ndarray) -> np.ndarray:
    """Triangles (m, 3) of triangles, or of both halves of quadrilaterals (m, 4)."""
    if cells.shape[1] == 3:
        return cells
    return np.concatenate([cells[:, :3], cells[:, [0, 2, 3]]])


def rim(cells: np.ndarray) -> np.ndarray:
    """(k, 2) vertices of the sides that belong to one cell only: the sheet's edges, the hole's too."""
    sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    _, first, count = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    return np.asarray(sides[first[count == 1]])
