"""Figures about the runs themselves: residual against step, error against mesh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from reports.stored import Stored
from reports.style import colour, line, method_name

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase


def residuals(fig: FigureBase, stored: Sequence[Stored]) -> None:
    """Residual against step for every run with a history; restarts are not marked, levels follow each other."""
    ax = fig.subplots()
    for run in stored:
        history = run.history
        if "residual" not in history or "step" not in history:
            continue
        step = running_steps(history["step"], history.get("level"))
        residual = np.where(history["residual"] > 0.0, history["residual"], np.nan)
        label = f"{method_name(run.method)}, {run.value('nodes'):.0f} nodes"
        ax.plot(
            step, residual, color=colour(run.method), linestyle=line(run.method), linewidth=0.8, label=label
        )
    ax.set_yscale("log")
    ax.set_xlabel("step, all nested meshes one after the other (–)")
    ax.set_ylabel("residual (–)")
    if ax.lines:
        ax.legend(fontsize=7)


def running_steps(step: np.ndarray, level: np.ndarray | None) -> np.ndarray:
    """Step count that keeps growing over the levels, whether or not the file starts again at each."""
    if level is None or step.size == 0 or np.all(np.diff(step) >= 0):
        return step
    total, offset = step.copy(), 0.0
    for k in range(1, step.size):
        if step[k] < step[k - 1]:
            offset += step[k - 1]
        total[k] = step[k] + offset
    return total


def order(fig: FigureBase, spacing: np.ndarray, errors: dict[str, np.ndarray]) -> None:
    """Errors (relative) against mesh spacing (mm), with the slope of second order beside them."""
    ax = fig.subplots()
    markers = iter("osD^v")
    for label, error in errors.items():
        good = np.isfinite(error) & (error > 0.0)
        ax.loglog(spacing[good], error[good], marker=next(markers), label=label, linewidth=1.0)
    reference = next((e for e in errors.values() if np.isfinite(e).any()), None)
    if reference is not None and np.nanmin(spacing) > 0.0:
        finest = int(np.nanargmin(np.where(np.isfinite(reference), spacing, np.nan)))
        h = np.array([spacing.min(), spacing.max()])
        ax.loglog(
            h,
            0.5 * reference[finest] * (h / spacing[finest]) ** 2,
            color="#999999",
            linewidth=0.8,
            label="second order",
        )
    ax.set_xlabel("mesh spacing, square root of the mean zone area (mm)")
    ax.set_ylabel("relative error (–)")
    ax.legend()
