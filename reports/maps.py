"""Maps of zone and node fields over the sheet, in reference or deformed positions seen from above."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.stored import Stored
from reports.style import STATE_COLOURS, STATE_NAMES
from reports.surface import flat_view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import FigureBase

SHEET_RGB = np.array([0.80, 0.86, 0.92])  # a pale steel for surfaces without a state


def state_rgb(stored: Stored) -> np.ndarray:
    """(nzi, nj - 1, 3) colours of the zones' membrane states."""
    from matplotlib.colors import to_rgb

    state = stored.fields["state"].astype(int)
    return np.array([to_rgb(c) for c in STATE_COLOURS])[np.clip(state, 0, 2)]


def plain_rgb(stored: Stored) -> np.ndarray:
    """(nzi, nj - 1, 3) of the bare sheet."""
    return np.broadcast_to(SHEET_RGB, (*stored.fields["state"].shape, 3))


def zone_map(
    ax: Axes, stored: Stored, values: np.ndarray, where: str, colours: str, limits: tuple[float, float]
) -> ScalarMappable:
    """Colour every zone by its value, grey where it is NaN, and return the key for a colour bar.

    values : (nzi, nj - 1).  where : "reference" or "deformed".  colours : name of a colour map.
    """
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize, to_rgb

    key = ScalarMappable(Normalize(*limits), colormaps[colours])
    rgb = key.to_rgba(np.nan_to_num(values, nan=limits[0]))[..., :3]
    rgb = np.where(np.isnan(values)[..., None], np.array(to_rgb(STATE_COLOURS[0])), rgb)
    show_zones(ax, stored, rgb, where)
    return key


def draw_states(ax: Axes, stored: Stored | None, title: str) -> None:
    """Map of slack, wrinkled and tense zones on the deformed sheet."""
    if stored is None or not stored.drawable:
        unavailable(ax, title, stored)
        return
    show_zones(ax, stored, state_rgb(stored), "deformed")
    ax.set_title(title)


def height_map(ax: Axes, stored: Stored) -> ScalarMappable:
    """Colour the deformed sheet by its height z (mm), white at zero."""
    z = stored.fields["r"][..., 2]
    z = np.concatenate([z, z[:1]]) if stored.closed else z
    mean = 0.25 * (z[:-1, :-1] + z[1:, :-1] + z[1:, 1:] + z[:-1, 1:])
    size = max(float(np.abs(mean).max()), 1e-12)
    return zone_map(ax, stored, mean, "deformed", "RdBu_r", (-size, size))


def show_zones(ax: Axes, stored: Stored, rgb: np.ndarray, where: str) -> None:
    """Show zones in given colours (nzi, nj - 1, 3) on labelled axes."""
    picture = flat_view(stored.fields["u" if where == "reference" else "r"], rgb, stored.closed)
    ax.imshow(picture.rgba, extent=picture.extent, interpolation="antialiased")
    plan_axes(ax, where)


def plan_axes(ax: Axes, where: str) -> None:
    """Label the axes of a plan view in mm, at equal scale and without a frame."""
    x, y = ("X", "Y") if where == "reference" else ("x", "y")
    ax.set_aspect("equal")
    ax.set_anchor("N")
    ax.set_xlabel(f"${x}$ (mm)")
    ax.set_ylabel(f"${y}$ (mm)")
    for spine in ax.spines.values():
        spine.set_visible(False)
    ax.tick_params(direction="out", length=2)


def bar_below(fig: FigureBase, ax: Axes, key: ScalarMappable, label: str) -> None:
    """Put a colour bar under a map, clear of its axis label."""
    space = ax.inset_axes((0.04, -0.17, 0.92, 0.022))
    bar = fig.colorbar(key, cax=space, orientation="horizontal", label=label)
    bar.ax.tick_params(direction="out", length=2, labelsize=7)
    bar.outline.set_linewidth(0.4)


def state_handles() -> list[Any]:
    """Key of the three zone states, for a legend."""
    from matplotlib.patches import Patch

    return [
        Patch(facecolor=c, edgecolor="#666666", linewidth=0.4, label=n)
        for c, n in zip(reversed(STATE_COLOURS), reversed(STATE_NAMES), strict=True)
    ]


def state_legend(target: Axes | FigureBase, **place: Any) -> None:
    """Put the key of the zone states somewhere."""
    target.legend(handles=state_handles(), handlelength=1.0, handleheight=1.0, **place)


def limits(*fields: np.ndarray) -> tuple[float, float]:
    """Colour limits that hold all but the outermost half per cent of each of several fields."""
    finite = [f[np.isfinite(f)] for f in fields if np.isfinite(f).any()]
    if not finite:
        return 0.0, 1.0
    low = min(float(np.percentile(f, 0.5)) for f in finite)
    high = max(float(np.percentile(f, 99.5)) for f in finite)
    return (low, high) if high - low > 1e-9 else (low - 1e-9, high + 1e-9)


def unavailable(ax: Axes, title: str, stored: Stored | None) -> None:
    """In place of a plot that cannot be drawn: what happened, in the run's own words."""
    words = "this run is not part of the report" if stored is None else f"{stored.status}: {stored.message}"
    ax.set_axis_off()
    ax.set_title(title)
    ax.text(
        0.5,
        0.5,
        "\n".join(textwrap.wrap(words.replace("_", " "), 26)),
        ha="center",
        va="center",
        transform=ax.transAxes,
        color="#8A1C1C",
        fontsize=8,
        linespacing=1.35,
        parse_math=False,
    )
