"""Seconds and memory of the finite elements against their unknowns."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from reports.style import colour, label_sparsely

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

LINES = {"superlu": "-", "pardiso": (0, (4, 1.5))}


@dataclass(frozen=True)
class Row:
    """One measured mesh. values : of the columns, by their names; NaN where not measured."""

    method: str
    solver: str
    values: Mapping[str, float]

    @property
    def whole(self) -> bool:
        """Whether the scene was solved, not only a matrix factorised."""
        return math.isfinite(self.values["whole_s"])


def cost(fig: FigureBase, rows: Sequence[Row], solvers: Mapping[str, str]) -> None:
    """(a) parts of the post-buckled solve, (b) whole solves, (c) memory. solvers : name -> for readers."""
    axes = fig.subplots(1, 3)
    for solver, name in solvers.items():
        parts = [row for row in rows if row.method == "postbuckling" and row.solver == solver]
        if solver == next(iter(solvers)):  # the assembly has no direct solver
            _line(axes[0], parts, "assemble_s", "^", "#009E73", solver, "assembly")
        _line(axes[0], parts, "factorise_s", "o", "#0072B2", solver, f"factorisation, {name}")
        for method in ("buckling", "postbuckling"):
            mine = [row for row in rows if row.method == method and row.solver == solver and row.whole]
            for ax, key in ((axes[1], "whole_s"), (axes[2], "peak_MB")):
                _line(ax, mine, key, "s", colour(method), solver, f"{method}, {name}")
    titles = ("(a) parts, bicubic elements", "(b) whole solves", "(c) peak memory")
    for ax, title, unit in zip(axes, titles, ("CPU time (s)", "CPU time (s)", "memory (MB)"), strict=True):
        ax.set(title=title, xlabel="unknowns (–)", ylabel=unit)
        if ax.lines:
            ax.legend(fontsize=6.5)
            label_sparsely(ax.xaxis)
            label_sparsely(ax.yaxis)


def _line(ax: Axes, rows: Sequence[Row], key: str, marker: str, shade: str, solver: str, label: str) -> None:
    if rows:
        x, y = [row.values["unknowns"] for row in rows], [row.values[key] for row in rows]
        ax.loglog(x, y, color=shade, marker=marker, linestyle=LINES.get(solver, "-"), label=label)
