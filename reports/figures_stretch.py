"""The pulled strip: shapes and mid-section profiles at several pulls (Fig. 4), measures against the pull."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from reports.bands import Banded
from reports.loads import MIDDLE, finest
from reports.maps import unavailable
from reports.plans import draw_relief, inner_plans
from reports.stored import Stored
from reports.style import colour, whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

LOAD_COLOURS = ("#56B4E9", "#0072B2", "#D55E00", "#333333")  # of the pulls of Fig. 4, in their order
LOAD_LINES = ((0, (5, 1.5)), "-", "-", (0, (1.2, 1.2)))
MESH_COLOURS = ("#8CC4E3", "#0072B2", "#0B3C5D", "#000000")  # from coarse to fine
LETTERS = "abcdefgh"


def shapes(fig: FigureBase, runs: Mapping[float, Stored | None], relief: float) -> None:
    """Fig. 4: the strip in relief at several pulls (%), and the heights across its middle."""
    grid = fig.add_gridspec(1, len(runs) + 1, width_ratios=[*(1.0 for _ in runs), 2.3])
    plans = [fig.add_subplot(grid[k]) for k in range(len(runs))]
    for k, (ax, (percent, stored)) in enumerate(zip(plans, runs.items(), strict=True)):
        draw_relief(ax, stored, f"({LETTERS[k]}) {percent:g} %", relief)
    inner_plans(plans)
    _same_scale([ax for ax in plans if ax.axison])
    ax = fig.add_subplot(grid[len(runs)])
    for (percent, stored), shade, dashes in zip(runs.items(), LOAD_COLOURS, LOAD_LINES, strict=False):
        section = stored.section(MIDDLE) if stored is not None else {}
        if section:
            x, z = section["x_mm"], section["z_mm"]
            ax.plot(x, z, color=shade, linestyle=dashes, linewidth=1.1, label=f"{percent:g} %")
    ax.set_title(f"({LETTERS[len(runs)]}) height across the middle")
    ax.set_xlabel("$X$ (mm)")
    ax.set_ylabel("height $z$ (mm)")
    if ax.lines:
        ax.margins(x=0.0, y=0.2)
        ax.legend(loc="upper center", ncols=4, columnspacing=0.9, handlelength=1.5, handletextpad=0.4)
    else:
        unavailable(ax, ax.get_title(), finest([s for s in runs.values() if s is not None]))


def _same_scale(plans: Sequence[Axes]) -> None:
    """One scale for all plans, lower edges in line."""
    if plans:
        bottom, top = min(ax.get_ylim()[0] for ax in plans), max(ax.get_ylim()[1] for ax in plans)
        for ax in plans:
            ax.set_ylim(bottom, top)


def measures(
    fig: FigureBase,
    pulls: np.ndarray,
    curves: Mapping[str, Sequence[Banded]],
    flat: Mapping[float, tuple[np.ndarray, np.ndarray]],
) -> None:
    """Measures of the wrinkles against the pull (%), each with the band of its mesh sequence.

    curves : for each pull, of "amplitude", "rms", "wavelength", "half_waves", "bending" and "gained".
    flat : nodes -> pulls (%) and lowest eigenvalues of the strip kept flat.
    """
    grid = fig.add_gridspec(3, 2, height_ratios=[1.0, 1.0, 0.85])
    axes = [fig.add_subplot(grid[k // 2, k % 2]) for k in range(4)]
    blue, red = colour("koiter"), "#D55E00"
    band(axes[0], pulls, curves["amplitude"], blue, "o", "crests, by their envelope")
    band(axes[0], pulls, curves["rms"], red, "s", "root mean square")
    axes[0].set_ylabel("height across the middle (mm)")
    axes[0].set_title("(a) height of the wrinkles")
    band(axes[1], pulls, curves["wavelength"], blue, "o")
    axes[1].set_ylabel("wavelength (mm)")
    axes[1].set_title("(b) mean wavelength")
    band(axes[2], pulls, curves["half_waves"], blue, "o")
    axes[2].set_ylabel("half-waves across the middle (–)")
    axes[2].set_title("(c) number of half-waves")
    band(axes[3], pulls, curves["bending"], blue, "o", "bending energy")
    band(axes[3], pulls, curves["gained"], red, "s", "gained by wrinkling")
    axes[3].ticklabel_format(axis="y", style="sci", scilimits=(0, 0), useMathText=True)
    axes[3].set_ylabel("energy (N mm)")
    axes[3].set_title("(d) energies of the wrinkles", pad=14)
    for ax in axes:
        ax.set_ylim(bottom=0.0)
        ax.set_xlim(0.0, 1.03 * float(pulls.max()))
    for ax in (axes[0], axes[3]):
        if ax.get_legend_handles_labels()[0]:
            ax.legend()
    below = fig.add_subplot(grid[2, :])
    below.set_xlim(0.0, 1.03 * float(pulls.max()))
    _flat_stability(below, flat)
    for ax in (*axes, below):
        ax.set_xlabel("pull (%)")


def _flat_stability(ax: Axes, flat: Mapping[float, tuple[np.ndarray, np.ndarray]]) -> None:
    """Lowest eigenvalue of the strip kept flat, mesh by mesh: where it is negative the strip must wrinkle."""
    ax.set_title("(e) lowest eigenvalue of the strip kept flat: negative where it must wrinkle")
    ax.axhline(0.0, color="#BBBBBB", linewidth=0.8, zorder=0)
    for (nodes, (pulls, lowest)), shade in zip(flat.items(), MESH_COLOURS, strict=False):
        ax.plot(
            pulls,
            lowest,
            marker="o",
            markersize=3.0,
            color=shade,
            linewidth=1.0,
            label=f"{whole(nodes)} nodes",
        )
    ax.set_ylabel("relative eigenvalue (–)")
    ax.set_ylim(-0.4, 0.4)
    if flat:
        ax.legend(ncols=len(flat), loc="upper left", columnspacing=1.2)


def band(
    ax: Axes, x: np.ndarray, values: Sequence[Banded], shade: str, marker: str, label: str | None = None
) -> None:
    """The limit as a line within its band (the finest value where there is no limit), the finest mesh as marks."""
    limit = np.array([v.finest if np.isnan(v.value) else v.value for v in values])
    half = np.nan_to_num([v.band for v in values])
    fine = np.array([v.finest for v in values])
    if not np.isfinite(fine).any():
        return
    ax.fill_between(x, limit - half, limit + half, color=shade, alpha=0.18, linewidth=0)
    ax.plot(x, limit, color=shade, linewidth=1.0)
    ax.plot(x, fine, color=shade, linestyle="none", marker=marker, markersize=3.4, label=label)
