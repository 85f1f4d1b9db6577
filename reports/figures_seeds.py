"""Ten random starts at one pull: Fig. 5 of Taylor et al. (2014), and the circle of their phases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from reports.maps import unavailable
from reports.phases import Phase, phase_of
from reports.plans import draw_height
from reports.stored import Stored

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase
    from matplotlib.gridspec import GridSpecBase

CENTRE = 0.16  # of the strip's length: half the height of the part that is shown
COLUMNS = 5
WHEEL = (
    "#0072B2",
    "#009E73",
    "#E69F00",
    "#D55E00",
    "#CC79A7",
    "#6A51A3",
)  # colours of the phases, 0 to 360 degrees
TOGETHER_DEG = 12.0  # phases closer than this share a label


def seeds(fig: FigureBase, runs: Sequence[Stored]) -> None:
    """Central regions side by side; the heights across the middle; the phases on their circle."""
    lines = -(-len(runs) // COLUMNS)
    rows = fig.add_gridspec(2, 1, height_ratios=[0.95 * lines, 2.1])
    _centres(
        fig,
        rows[0].subgridspec(lines, COLUMNS + 1, width_ratios=[*(1.0 for _ in range(COLUMNS)), 0.06]),
        runs,
    )
    below = rows[1].subgridspec(1, 2, width_ratios=[1.6, 1.0])
    phases = [(run, phase) for run in runs if (phase := phase_of(run)) is not None]
    _profiles(fig.add_subplot(below[0]), runs, phases)
    _circle(fig.add_subplot(below[1]), runs, phases)


def _centres(fig: FigureBase, grid: GridSpecBase, runs: Sequence[Stored]) -> None:
    there = [run for run in runs if run.drawable]
    size = max((float(np.abs(run.fields["r"][..., 2]).max()) for run in there), default=1.0)
    key = None
    for k, run in enumerate(runs):
        ax = fig.add_subplot(grid[k // COLUMNS, k % COLUMNS])
        title = f"{'(a) ' if k == 0 else ''}seed {run.run.seed}"
        if not run.drawable:
            unavailable(ax, title, run)
            continue
        key = draw_height(ax, run.fields["r"], size, title)
        _centre(ax, run)
    if key is not None:
        bar = fig.colorbar(key, cax=fig.add_subplot(grid[:, COLUMNS]), label="height $z$ (mm)")
        bar.outline.set_linewidth(0.4)


def _centre(ax: Axes, run: Stored) -> None:
    y = run.fields["r"][..., 1]
    middle, half = 0.5 * float(y.min() + y.max()), CENTRE * float(np.ptp(y))
    ax.set_ylim(middle - half, middle + half)
    ax.set_axis_off()


def phase_colour(phase: Phase) -> str:
    """A colour that goes round with the phase."""
    from matplotlib.colors import LinearSegmentedColormap, to_hex

    wheel = LinearSegmentedColormap.from_list("phase", [*WHEEL, WHEEL[0]])
    return to_hex(wheel(phase.angle_deg % 360.0 / 360.0))


def _profiles(ax: Axes, runs: Sequence[Stored], phases: Sequence[tuple[Stored, Phase]]) -> None:
    title = "(b) heights across the middle, coloured by phase"
    if not phases:
        unavailable(ax, title, runs[0] if runs else None)
        return
    for run, phase in phases:
        section = run.section("midsection")
        ax.plot(section["x_mm"], section["z_mm"], color=phase_colour(phase), linewidth=0.9)
    ax.margins(x=0.0)
    ax.set_xlabel("$X$ (mm)")
    ax.set_ylabel("height $z$ (mm)")
    ax.set_title(title)


def _circle(ax: Axes, runs: Sequence[Stored], phases: Sequence[tuple[Stored, Phase]]) -> None:
    title = "(c) phases on their circle"
    if not phases:
        unavailable(ax, title, runs[0] if runs else None)
        return
    radius = float(np.mean([p.rms_mm for _, p in phases]))
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    ax.plot(radius * np.cos(turn), radius * np.sin(turn), color="#BBBBBB", linewidth=0.8, zorder=0)
    for _, phase in phases:
        ax.plot([phase.even_mm], [phase.odd_mm], "o", color=phase_colour(phase), markersize=5.5)
    for angle, words in _labels(phases):
        place = (1.12 * radius * np.cos(angle), 1.12 * radius * np.sin(angle))
        side = "center" if abs(np.cos(angle)) < 0.3 else "left" if np.cos(angle) > 0.0 else "right"
        height = "center" if abs(np.sin(angle)) < 0.9 else "bottom" if np.sin(angle) > 0.0 else "top"
        ax.text(*place, words, ha=side, va=height, fontsize=7.5)
    ax.axhline(0.0, color="#DDDDDD", linewidth=0.6, zorder=0)
    ax.axvline(0.0, color="#DDDDDD", linewidth=0.6, zorder=0)
    ax.set_aspect("equal")
    ax.set_anchor("N")
    ax.set_xlim(-1.5 * radius, 1.5 * radius)
    ax.set_ylim(-1.5 * radius, 1.5 * radius)
    ax.set_xlabel("symmetric part, rms (mm)")
    ax.set_ylabel("antisymmetric part, rms (mm)")
    ax.set_title(title)


def _labels(phases: Sequence[tuple[Stored, Phase]]) -> list[tuple[float, str]]:
    """Angles (radians) and seeds of the labels; neighbours share one."""
    groups: list[list[tuple[float, int]]] = []
    for angle, seed in sorted((phase.angle_deg, run.run.seed) for run, phase in phases):
        if groups and angle - groups[-1][-1][0] < TOGETHER_DEG:
            groups[-1].append((angle, seed))
        else:
            groups.append([(angle, seed)])
    return [
        (float(np.radians(np.mean([angle for angle, _ in group]))), ", ".join(str(seed) for _, seed in group))
        for group in groups
    ]
