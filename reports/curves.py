"""Curves by method and their key, which also says which method has no curve, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.stored import Stored
from reports.style import colour, line, method_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Runs = Mapping[str, Stored | None]  # method -> its run


def curve(ax: Axes, x: np.ndarray, y: np.ndarray, method: str, **style: Any) -> None:
    """One method's curve in its colour and line style; the closed form thin, to lie on top of the others."""
    width = 0.8 if method == "exact" else 1.4
    ax.plot(x, y, color=colour(method), linestyle=line(method), linewidth=width, **style)


def key(runs: Runs, methods: Sequence[str]) -> list[Any]:
    """Legend entries of some methods; the status is named where it is not "converged"."""
    from matplotlib.lines import Line2D

    handles = []
    for method in methods:
        stored = runs.get(method)
        if stored is None:
            continue
        label = method_name(method)
        if not stored.converged:
            label += f": {stored.status.replace('_', ' ')}"
        style: Any = line(method) if stored.drawable else "none"
        width = 0.8 if method == "exact" else 1.4
        handles.append(Line2D([], [], color=colour(method), linestyle=style, linewidth=width, label=label))
    return handles


def legend(ax: Axes, runs: Runs, methods: Sequence[str], **place: Any) -> None:
    """Put the key of some methods on an axis, if there is any."""
    handles = key(runs, methods)
    if handles:
        ax.legend(handles=handles, **place)


def widen(ax: Axes, least: float = 1e-5) -> None:
    """Keep a constant from filling its axis with rounding."""
    low, high = ax.get_ylim()
    if high - low < least:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5 * least, middle + 0.5 * least)
