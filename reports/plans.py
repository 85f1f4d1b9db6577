"""Deformed rectangles from above, several in one figure: in relief, or coloured by height."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reports.maps import SHEET_RGB, plan_axes, unavailable
from reports.stored import Stored
from reports.surface import View, flat_view, lit_view

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable

RELIEF_SLOPE = 0.35  # rms slope to which the shading exaggerates shallow wrinkles
STEEPEST_RELIEF = 200.0
PIXELS = 1000
HEIGHT_COLOURS = "RdBu_r"


def relief_factor(stored: Sequence[Stored]) -> float:
    """One factor on z for all of several sheets: it gives the steepest an rms slope of RELIEF_SLOPE; 1 to 200."""
    steepest = max((rms_slope(s.fields["r"]) for s in stored if s.drawable), default=0.0)
    return float(np.clip(RELIEF_SLOPE / steepest, 1.0, STEEPEST_RELIEF)) if steepest > 1e-9 else 1.0


def rms_slope(r: np.ndarray) -> float:
    """Root mean square of the rise over run along all mesh lines of a sheet (ni, nj, 3)."""
    slopes = []
    for axis in (0, 1):
        step = np.diff(r, axis=axis)
        run = np.linalg.norm(step[..., :2], axis=-1)
        slopes.append((step[..., 2] / np.where(run > 0.0, run, 1.0)).ravel())
    return float(np.sqrt(np.mean(np.concatenate(slopes) ** 2)))


def draw_relief(ax: Axes, stored: Stored | None, title: str, relief: float) -> None:
    """Deformed sheet from above as shaded relief, z taken `relief` times for the light only."""
    if stored is None or not stored.drawable:
        unavailable(ax, title, stored)
        return
    r = stored.fields["r"]
    rgb = np.broadcast_to(SHEET_RGB, (*stored.fields["state"].shape, 3))
    picture = lit_view(r, rgb, stored.closed, View(), PIXELS, relief)
    ax.imshow(picture.rgba, extent=picture.extent, interpolation="antialiased")
    plan_axes(ax, "deformed")
    ax.set_title(title)


def draw_height(ax: Axes, r: np.ndarray, size: float, title: str, smooth: bool = True) -> ScalarMappable:
    """An open sheet (ni, nj, 3) mm from above, coloured by height from -size to size mm; returns the key.

    smooth : zones have the mean height of their corners, which hides a checkerboard; otherwise that of one corner.
    """
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    key = ScalarMappable(Normalize(-size, size), colormaps[HEIGHT_COLOURS])
    z = r[..., 2]
    mean = 0.25 * (z[:-1, :-1] + z[1:, :-1] + z[1:, 1:] + z[:-1, 1:])
    picture = flat_view(r, key.to_rgba(mean if smooth else z[:-1, :-1])[..., :3], False, PIXELS)
    ax.imshow(picture.rgba, extent=picture.extent, interpolation="antialiased")
    rim = np.concatenate([r[:-1, 0], r[-1, :-1], r[:0:-1, -1], r[0, ::-1]])
    ax.plot(rim[:, 0], rim[:, 1], color="#9A9A9A", linewidth=0.4)
    plan_axes(ax, "deformed")
    ax.set_title(title)
    return key


def inner_plans(axes: Sequence[Axes]) -> None:
    """Number the height axis of the first plan only."""
    for ax in axes[1:]:
        if ax.axison:
            ax.set_ylabel("")
            ax.tick_params(labelleft=False, left=False)
