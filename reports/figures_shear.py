"""The sheared sheet: Fig. 6 of Taylor et al. (2014)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from cases.estimates import ShearEstimate
from reports.loads import MIDDLE
from reports.maps import unavailable
from reports.plans import draw_relief, inner_plans
from reports.stored import Stored

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

Load = tuple[float, float]  # displacement and pre-stretch of the upper edge, mm
SHADES = ("#0072B2", "#D55E00")  # without and with pre-stretch
DRAWN_WAVES = 6  # half-waves of the estimate that are drawn over the middle


def sheared(
    fig: FigureBase,
    runs: Mapping[Load, Stored | None],
    reliefs: Mapping[float, float],
    estimates: Mapping[float, ShearEstimate],
) -> None:
    """Fig. 6: the sheets in relief, then section A with the estimate, in one column for each displacement.

    A single displacement has one column for each pre-stretch instead.
    """
    columns = in_columns(list(runs))
    plans = max(len(column) for column in columns)
    axes = fig.subplots(
        plans + 1, len(columns), squeeze=False, height_ratios=[*(1.0 for _ in range(plans)), 1.15]
    )
    letters = iter("abcdefghij")
    for row in range(plans):
        for ax, column in zip(axes[row], columns, strict=True):
            move, rise = column[row]
            draw_relief(
                ax, runs[column[row]], f"({next(letters)}) {move:g} mm, {pre_stretch(rise)}", reliefs[move]
            )
            if ax.axison and row + 1 < plans:
                ax.set_xlabel("")
                ax.tick_params(labelbottom=False, bottom=False)
    for ax, column in zip(axes[-1], columns, strict=True):
        move = column[0][0]
        title = f"({next(letters)}) section A, {move:g} mm"
        _section_a(ax, {load: runs[load] for load in column}, title, estimates.get(move))
    for line in axes[:-1]:
        inner_plans(line)
    handles = {
        label: handle
        for ax in axes[-1]
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    if handles:
        fig.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=3)


def in_columns(loads: Sequence[Load]) -> list[list[Load]]:
    """Loads by displacement; those of a single displacement each on its own."""
    moves = sorted({move for move, _ in loads})
    if len(moves) == 1:
        return [[load] for load in sorted(loads)]
    return [sorted(load for load in loads if load[0] == move) for move in moves]


def pre_stretch(rise: float) -> str:
    """A pre-stretch (mm) in words."""
    return f"pre-stretch {rise:g} mm" if rise else "no pre-stretch"


def _section_a(
    ax: Axes,
    runs: Mapping[Load, Stored | None],
    title: str,
    estimate: ShearEstimate | None,
) -> None:
    """Heights along the horizontal centre line, with waves of the estimated size drawn below them."""
    lowest = 0.0
    for (_, rise), stored in runs.items():
        section = stored.section(MIDDLE) if stored is not None else {}
        if not section:
            continue
        shade = SHADES[1 if rise else 0]
        ax.plot(section["x_mm"], section["z_mm"], color=shade, linewidth=0.8, label=pre_stretch(rise))
        lowest = min(lowest, float(section["z_mm"].min()))
    if not ax.lines:
        unavailable(ax, title, next(iter(runs.values()), None))
        return
    if estimate is not None:
        _draw_estimate(ax, estimate, lowest - 1.6 * estimate.amplitude_mm)
    ax.margins(x=0.0)
    ax.set_title(title)
    ax.set_xlabel("$X$ (mm)")
    ax.set_ylabel("height $z$ (mm)")


def _draw_estimate(ax: Axes, estimate: ShearEstimate, level: float) -> None:
    """Some waves of the estimated size; a section at 45 degrees to the wrinkles sees them sqrt(2) longer."""
    half = np.sqrt(2.0) * estimate.half_wavelength_mm
    x = np.linspace(-0.5 * DRAWN_WAVES * half, 0.5 * DRAWN_WAVES * half, 400)
    z = level + estimate.amplitude_mm * np.sin(np.pi * (x - x[0]) / half)
    ax.plot(
        x, z, color="#555555", linewidth=0.9, linestyle=(0, (3, 1.5)), label="waves of the estimated size"
    )


def scan(
    fig: FigureBase, imposed: np.ndarray, found: np.ndarray, energy: np.ndarray, seeds: np.ndarray
) -> None:
    """Energy of the states that imposed waves end in.

    imposed, found : (m,) half-wavelengths across the wrinkles, mm. energy : (m,) above the lowest of all, N mm.
    seeds : (k, 2) half-wavelength and energy of the states from random starts on the same mesh.
    """
    left, right = fig.subplots(1, 2)
    left.plot(imposed, found, "o-", color=SHADES[0], linewidth=1.0)
    left.plot(imposed, imposed, color="#999999", linewidth=0.8, linestyle=(0, (4, 2)), label="as imposed")
    left.set_xlabel("imposed half-wavelength (mm)")
    left.set_ylabel("half-wavelength found (mm)")
    left.set_title("(a) what becomes of imposed waves")
    left.legend()
    right.plot(found, energy, "o", color=SHADES[0], label="imposed waves")
    right.plot(seeds[:, 0], seeds[:, 1], "s", color=SHADES[1], linestyle="none", label="random starts")
    right.ticklabel_format(axis="y", style="sci", scilimits=(0, 0), useMathText=True)
    right.set_xlabel("half-wavelength found (mm)")
    right.set_ylabel("energy above the lowest (N mm)")
    right.set_title("(b) energy of the states", pad=14)
    right.legend()
