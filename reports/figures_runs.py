"""Figures about the runs themselves: residual against step, error against mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from reports.stored import Stored
from reports.style import colour, line, whole

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

ERROR_COLOURS = ("#D55E00", "#56B4E9", "#009E73", "#CC79A7")


def residuals(fig: FigureBase, stored: Sequence[Stored]) -> None:
    """Residual against step for every run with a history; the nested meshes follow each other."""
    ax = fig.subplots()
    seen: dict[str, int] = {}
    for run in stored:
        history = run.history
        if "residual" not in history or history["residual"].size < 2:
            continue
        seen[run.method] = seen.get(run.method, 0) + 1
        residual = np.where(history["residual"] > 0.0, history["residual"], np.nan)
        changed = ", ".join(
            f"{k.split('.')[-1]} = {v}" for k, v in run.run.overrides.items() if "move" not in k
        )
        label = f"{run.method}, {whole(run.value('nodes'))} nodes" + (f", {changed}" if changed else "")
        step = running_steps(history["step"], history.get("level"))
        # further runs of the same method in the same colour, lighter
        ax.plot(
            step,
            residual,
            color=colour(run.method),
            linestyle=line(run.method),
            linewidth=0.8,
            alpha=1.0 / seen[run.method],
            label=label,
        )
    ax.set_xlabel("step, all nested meshes one after the other (–)")
    ax.set_ylabel("residual (–)")
    if ax.lines:
        ax.set_yscale("log")
        fig.legend(loc="outside lower center", ncols=3, columnspacing=1.2)


def running_steps(step: np.ndarray, level: np.ndarray | None) -> np.ndarray:
    """Step count that keeps growing over the levels, whether or not the file starts again at each."""
    if level is None or step.size == 0 or np.all(np.diff(step) >= 0):
        return step
    falls = np.concatenate([[0], np.where(np.diff(step) < 0, step[:-1], 0)])
    return step + np.cumsum(falls)


def order(fig: FigureBase, spacing: np.ndarray, errors: Mapping[str, np.ndarray]) -> None:
    """Errors (relative) against mesh spacing (mm), with the slope of second order beside them."""
    ax = fig.subplots()
    for (label, error), marker, shade in zip(errors.items(), "osD^", ERROR_COLOURS, strict=False):
        good = np.isfinite(error) & (error > 0.0)
        if good.any():
            ax.loglog(spacing[good], error[good], marker=marker, label=label, color=shade, linewidth=1.0)
    first = next(iter(errors.values()))
    good = np.isfinite(first) & (first > 0.0)
    if good.any():
        h = np.array([spacing.min(), spacing.max()])
        slope = 0.5 * first[good][-1] * (h / spacing[good][-1]) ** 2
        ax.loglog(h, slope, color="#888888", linewidth=0.8, linestyle="--", label="second order")
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        ax.set_xticks(spacing, [f"{h:.3g}" for h in spacing])
        ax.set_xticks([], minor=True)
    ax.set_xlabel("mesh spacing, square root of the mean zone area (mm)")
    ax.set_ylabel("relative error (–)")
