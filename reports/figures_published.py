"""States of the published scheme: whole sheets, and the cells around their highest points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from reports.maps import unavailable
from reports.plans import draw_height, inner_plans
from reports.stored import Stored
from reports.style import power_of_ten

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

FULL_COLOUR = 99.5  # percentile of |z| at which the colours are full
CLOSE_CELLS = 8  # to either side of the highest point


def states(fig: FigureBase, runs: Sequence[Stored], titles: Sequence[str]) -> None:
    """Sheets side by side, each coloured by height on its own scale, and below each its highest cells."""
    above, below = fig.subplots(2, max(len(runs), 1), squeeze=False, height_ratios=(2.1, 1.0))
    for k, (run, title) in enumerate(zip(runs, titles, strict=True)):
        name = f"({'abcdefgh'[k]}) {title}"
        if not run.drawable:
            unavailable(above[k], name, run)
            below[k].set_axis_off()
            continue
        r = run.fields["r"]
        size = max(float(np.percentile(np.abs(r[..., 2]), FULL_COLOUR)), 1e-30)
        draw_height(above[k], r, size, name, smooth=False)
        above[k].set_title(name, fontsize=7.5)
        _close_up(below[k], r, size)
    inner_plans(list(above))
    if not runs:
        for ax in (above[0], below[0]):
            ax.set_axis_off()
        above[0].text(0.5, 0.5, "no run of the published scheme", ha="center")


def _close_up(ax: Axes, r: np.ndarray, size: float) -> None:
    """The cells around the highest point, and the scale of the colours, mm."""
    i, j = np.unravel_index(int(np.abs(r[..., 2]).argmax()), r.shape[:2])
    rows, columns = (
        slice(max(k - CLOSE_CELLS, 0), min(k + CLOSE_CELLS, count - 1) + 1)
        for k, count in zip((int(i), int(j)), r.shape[:2], strict=True)
    )
    draw_height(ax, r[rows, columns], size, "", smooth=False)
    ax.set_title(rf"$z$: $\pm${power_of_ten(size)} mm", fontsize=7.5)
    low, high = ax.get_xlim()
    ax.set_xticks([math.ceil(low), math.floor(high)])  # the columns are narrow: there is room for two
