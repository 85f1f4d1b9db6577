"""The way from the random start to the wrinkled equilibrium: Fig. 3 of Taylor et al. (2014)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reports.figures_runs import running_steps
from reports.maps import unavailable
from reports.plans import draw_height, inner_plans
from reports.stored import Stored
from reports.style import colour, power_of_ten

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

LETTERS = "abcdefghijkl"
SCALE_PART = 99.5  # percentile of |z| at which the colours of a shape are full


def progress(fig: FigureBase, stored: Stored | None) -> None:
    """Kinetic energy against step with the kept shapes marked, and these shapes below."""
    rows = fig.add_gridspec(2, 1, height_ratios=[1.0, 1.55])
    above = fig.add_subplot(rows[0])
    if stored is None or stored.history.get("kinetic", np.empty(0)).size < 2:
        unavailable(above, "Kinetic energy", stored)
        return
    step, kinetic = (
        running_steps(stored.history["step"], stored.history.get("level")),
        stored.history["kinetic"],
    )
    moving = kinetic > 0.0  # a sample at the very moment of a restart finds the sheet at rest
    above.semilogy(step[moving], kinetic[moving], color=colour("koiter"), linewidth=0.7)
    above.set_xlabel("step (–)")
    above.set_ylabel("kinetic energy (N mm)")
    above.margins(x=0.015)
    if not stored.snapshots:
        below = fig.add_subplot(rows[1])
        unavailable(below, "Shapes on the way: none were kept by this run", stored)
        return
    marks = snapshot_steps(stored)
    _mark(above, marks, np.asarray(stored.snapshots["kinetic_N_mm"]))
    shapes = stored.snapshots["r"]
    cells = rows[1].subgridspec(1, len(marks))
    axes = [fig.add_subplot(cells[k]) for k in range(len(marks))]
    for k, (ax, r) in enumerate(zip(axes, shapes, strict=True)):
        size = max(float(np.percentile(np.abs(r[..., 2]), SCALE_PART)), 1e-30)
        draw_height(ax, r, size, f"({LETTERS[k]}) step {marks[k]:.0f}")
        ax.set_xlabel("$x$ (mm)")
        ax.text(
            0.5,
            -0.27,
            rf"$z$: $\pm${power_of_ten(size)} mm",
            transform=ax.transAxes,
            ha="center",
            fontsize=7.5,
        )
    inner_plans(axes)


def snapshot_steps(stored: Stored) -> np.ndarray:
    """Running step of every kept shape, counted over the nested meshes as in the history."""
    history = stored.history
    level = history.get("level", np.zeros_like(history["step"]))
    running = running_steps(history["step"], level)
    offset = {int(n): float((running - history["step"])[level == n].max()) for n in np.unique(level)}
    return np.array(
        [
            s + offset.get(int(n), 0.0)
            for s, n in zip(stored.snapshots["step"], stored.snapshots["level"], strict=True)
        ]
    )


def _mark(ax: Axes, steps: np.ndarray, kinetic: np.ndarray) -> None:
    """Put lettered marks on the curve; the shape at rest at the start goes to the foot of the axis."""
    low, high = ax.get_ylim()
    for k, (step, energy) in enumerate(zip(steps, kinetic, strict=True)):
        height = float(np.clip(energy, low, high))
        ax.plot([step], [height], marker="o", markersize=4.5, color="#D55E00", clip_on=False, zorder=4)
        ax.annotate(
            f"{LETTERS[k]}", (step, height), xytext=(4, 4), textcoords="offset points", fontsize=9, zorder=5
        )
    ax.set_ylim(low, high)
