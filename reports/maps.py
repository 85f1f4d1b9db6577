"""Maps of zone and node fields over the sheet, in reference or deformed positions seen from above."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from reports.stored import Stored
from reports.style import STATE_COLOURS, STATE_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHEET_RGB = np.array([0.80, 0.86, 0.92])  # a pale steel for surfaces without a state


def closed_lines(nodes: np.ndarray, closed: bool) -> np.ndarray:
    """Repeat the first line of nodes at the end if the mesh is closed, so that every zone has its corners."""
    return np.concatenate([nodes, nodes[:1]], axis=0) if closed else nodes


def zone_rgb(stored: Stored, coloured: bool) -> np.ndarray:
    """(nzi, nj - 1, 3) colours of the zones: of their membrane state, or of the plain sheet."""
    from matplotlib.colors import to_rgb

    state = stored.fields["state"].astype(int)
    if coloured:
        return np.array([to_rgb(c) for c in STATE_COLOURS])[np.clip(state, 0, 2)]
    return np.broadcast_to(SHEET_RGB, (*state.shape, 3))


def zone_map(ax: Axes, stored: Stored, values: np.ndarray, where: str = "reference", **style: Any) -> Any:
    """Colour every zone by its value; `where` is "reference" or "deformed".  Returns the mappable."""
    nodes = closed_lines(stored.fields["u" if where == "reference" else "r"], stored.closed)
    mesh = ax.pcolormesh(
        nodes[..., 0], nodes[..., 1], values, shading="flat", rasterized=True, linewidth=0, **style
    )
    plan_axes(ax, where)
    return mesh


def state_map(ax: Axes, stored: Stored, where: str = "deformed") -> Any:
    """Draw slack, wrinkled and tense zones."""
    from matplotlib.colors import ListedColormap

    return zone_map(
        ax, stored, stored.fields["state"], where, cmap=ListedColormap(STATE_COLOURS), vmin=-0.5, vmax=2.5
    )


def height_map(ax: Axes, stored: Stored) -> Any:
    """Colour the deformed sheet by its height z (mm), white at zero.  Returns the mappable."""
    r = closed_lines(stored.fields["r"], stored.closed)
    size = max(float(np.abs(r[..., 2]).max()), 1e-12)
    mesh = ax.pcolormesh(
        r[..., 0],
        r[..., 1],
        r[..., 2],
        shading="gouraud",
        rasterized=True,
        cmap="RdBu_r",
        vmin=-size,
        vmax=size,
    )
    plan_axes(ax, "deformed")
    return mesh


def plan_axes(ax: Axes, where: str) -> None:
    """Label the axes of a plan view in mm, at equal scale and without a frame."""
    letter = "X" if where == "reference" else "x"
    ax.set_aspect("equal")
    ax.set_xlabel(f"${letter}$ (mm)")
    ax.set_ylabel(f"${letter.replace('x', 'y').replace('X', 'Y')}$ (mm)")
    for spine in ax.spines.values():
        spine.set_visible(False)
    ax.tick_params(length=2)


def state_legend(ax: Axes, **place: Any) -> None:
    """Key of the three zone states."""
    from matplotlib.patches import Patch

    patches = [
        Patch(facecolor=c, edgecolor="#666666", linewidth=0.4, label=n)
        for c, n in zip(reversed(STATE_COLOURS), reversed(STATE_NAMES), strict=True)
    ]
    ax.legend(handles=patches, handlelength=1.0, handleheight=1.0, **place)


def limits(*fields: np.ndarray) -> tuple[float, float]:
    """Colour limits that hold all but the outermost half per cent of each of several fields."""
    finite = [f[np.isfinite(f)] for f in fields if np.isfinite(f).any()]
    if not finite:
        return 0.0, 1.0
    low = min(float(np.percentile(f, 0.5)) for f in finite)
    high = max(float(np.percentile(f, 99.5)) for f in finite)
    return (low, high) if high > low else (low, low + 1e-9)


def unavailable(ax: Axes, title: str, stored: Stored | None) -> None:
    """In place of a plot that cannot be drawn: what happened, in the run's own words."""
    import textwrap

    ax.set_axis_off()
    ax.set_title(title)
    words = "this run is not part of the report" if stored is None else f"{stored.status}: {stored.message}"
    ax.text(
        0.5,
        0.5,
        "\n".join(textwrap.wrap(words.replace("$", r"\$"), 26)),
        ha="center",
        va="center",
        transform=ax.transAxes,
        color="#8A1C1C",
        fontsize=8,
        linespacing=1.35,
    )
