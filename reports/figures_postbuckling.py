"""Post-buckled strip and lifted annulus: finite elements beside finite differences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.envelope import envelope
from reports.bands import Banded
from reports.figures_stretch import LETTERS, LOAD_COLOURS, band
from reports.loads import MIDDLE
from reports.maps import unavailable
from reports.postbuckling_values import Both
from reports.stored import Stored
from reports.style import colour, method_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

GRID, ELEMENTS = "koiter", "postbuckling"
PANELS = ("crest height", "wavelength", "bending energy", "energy gained")
ASKED = 0.5  # %, of the heights between meshes
LEAST_DRAWN = 1e-3  # %: below, a distance is as good as none
ROUNDING = 1e-15  # relative: below, two energies are the same
ELEMENT_STYLE: dict[str, Any] = {"marker": "s", "markersize": 4.2, "markerfacecolor": "none", "capsize": 2.5}


def measures(fig: FigureBase, pulls: np.ndarray, both: Sequence[Sequence[Both]]) -> None:
    """Four quantities against the pull (%) by both methods; below, how far apart in units of their bars.

    both : of every pull, all quantities.
    """
    grid = fig.add_gridspec(3, 2, height_ratios=[1.0, 1.0, 0.75])
    names = [one.quantity.name for one in both[0]] if both else []
    axes = [fig.add_subplot(grid[k // 2, k % 2]) for k in range(len(PANELS))]
    for k, (ax, name) in enumerate(zip(axes, PANELS, strict=True)):
        if name in names:
            _measure(ax, pulls, [column[names.index(name)] for column in both])
        ax.set_title(f"({LETTERS[k]}) {name}", pad=14 if k > 1 else None)
        ax.set_xlabel("pull (%)")
    if axes[0].get_legend_handles_labels()[0]:
        axes[0].legend(loc="lower center")
    _apart(fig.add_subplot(grid[2, :]), pulls, both)


def _measure(ax: Axes, pulls: np.ndarray, values: Sequence[Both]) -> None:
    band(ax, pulls, [v.differences for v in values], colour(GRID), "o", "finite differences")
    fine = np.array([v.elements.finest for v in values])
    bars = np.nan_to_num([v.elements.error for v in values])
    ax.errorbar(
        pulls, fine, bars, color="#D55E00", linestyle="none", label="finite elements", **ELEMENT_STYLE
    )
    quantity = values[0].quantity
    if "energy" in quantity.name:
        ax.ticklabel_format(axis="y", style="sci", scilimits=(0, 0), useMathText=True)
    ax.set_ylabel(f"{quantity.name} ({quantity.unit})")
    ax.set_ylim(bottom=0.0)
    ax.set_xlim(0.0, 1.05 * float(pulls.max()))


def _apart(ax: Axes, pulls: np.ndarray, both: Sequence[Sequence[Both]]) -> None:
    """Difference over the sum of both bars: one group of marks for each quantity, a mark for each pull."""
    ax.set_title("(e) difference of the methods over the sum of their error bars")
    ax.axhspan(-1.0, 1.0, color="#0072B2", alpha=0.10, linewidth=0)
    ax.axhline(0.0, color="#BBBBBB", linewidth=0.8)
    columns = [(pull, column) for pull, column in zip(pulls, both, strict=True)]
    wrinkled = [
        (pull, column) for pull, column in columns if np.isfinite([one.apart for one in column]).any()
    ]
    for k, (pull, column) in enumerate(wrinkled):
        place = np.arange(len(column)) + 0.6 * ((k + 0.5) / len(wrinkled) - 0.5)
        shade = LOAD_COLOURS[k % len(LOAD_COLOURS)]
        marker = "os^Dv<>p"[k % 8]
        ax.plot(
            place,
            [one.apart for one in column],
            marker=marker,
            linestyle="none",
            color=shade,
            label=f"{pull:g} %",
        )
    if both:
        ax.set_xticks(np.arange(len(both[0])), [one.quantity.name for one in both[0]])
    ax.set_xlabel("measure (–)")
    ax.set_ylabel("difference (–)")
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -1.4), max(high, 1.4))
    if wrinkled:
        ax.legend(ncols=len(wrinkled), loc="upper right", columnspacing=0.9, handletextpad=0.1)


def profiles(fig: FigureBase, runs: Mapping[float, tuple[Stored | None, Stored | None]]) -> None:
    """Heights across the middle and their envelopes. runs : pull (%) -> finest by elements and by differences."""
    axes = fig.subplots(1, len(runs), squeeze=False)[0]
    styles = ((1, GRID, colour(GRID), "-"), (0, ELEMENTS, "#D55E00", (0, (4, 1.5))))
    for k, (ax, (percent, pair)) in enumerate(zip(axes, runs.items(), strict=True)):
        ax.set_title(f"({LETTERS[k]}) {percent:g} %")
        for which, method, shade, dashes in styles:
            run = pair[which]
            section = run.section(MIDDLE) if run is not None else {}
            if section:
                x, z = section["x_mm"], section["z_mm"]
                ax.plot(x, z, color=shade, linewidth=0.7, alpha=0.75)
                ax.plot(
                    x, envelope(z), color=shade, linestyle=dashes, linewidth=1.5, label=method_name(method)
                )
        if not ax.lines:
            unavailable(ax, ax.get_title(), pair[0])
        ax.set_xlabel("$X$ (mm)")
        ax.set_ylabel("height $z$ (mm)")
    handles, labels = axes[0].get_legend_handles_labels()
    if handles:
        fig.legend(handles, labels, loc="outside lower center", ncols=2, title="thick: envelopes")


def convergence(
    fig: FigureBase,
    series: Mapping[float, Mapping[str, tuple[np.ndarray, np.ndarray]]],
    limits: Mapping[float, float],
) -> None:
    """Distance of a height from its limit against the mesh, a panel for each pull (%).

    series : pull -> method -> nodes of the whole sheet and values. limits : pull -> of the finite elements.
    """
    axes = fig.subplots(1, len(series), squeeze=False, sharey=True)[0]
    for k, (ax, (percent, methods)) in enumerate(zip(axes, series.items(), strict=True)):
        ax.set_title(f"({LETTERS[k]}) {percent:g} %")
        limit = limits[percent]
        for method, marker, shade in ((GRID, "o", colour(GRID)), (ELEMENTS, "s", "#D55E00")):
            nodes, values = methods[method]
            if nodes.size and np.isfinite(limit):
                apart = np.maximum(100.0 * np.abs(values / limit - 1.0), LEAST_DRAWN)
                ax.loglog(nodes, apart, color=shade, marker=marker, linewidth=1.0, label=method_name(method))
        if not ax.lines:
            unavailable(ax, ax.get_title(), None)
            continue
        ax.axhline(ASKED, color="#777777", linewidth=0.8, linestyle=(0, (4, 3)))
        ax.set_xlabel("nodes of the whole sheet (–)")
    axes[0].set_ylabel("distance from the limit (%)")
    drawn = [ax for ax in axes if ax.lines]
    if drawn:
        drawn[-1].legend(loc="lower left")


def lift(
    fig: FigureBase,
    exact: float,
    energies: Mapping[str, tuple[np.ndarray, np.ndarray]],
    bending: Mapping[str, tuple[np.ndarray, np.ndarray]],
    limit: Banded,
) -> None:
    """The lifted annulus: total energy from that of the axisymmetric membrane, and bending energy against the mesh.

    exact : N mm, of the membrane. energies, bending : method -> nodes and values, N mm.
    limit : of the bending energy by finite differences.
    """
    left, right = fig.subplots(1, 2)
    for method, marker, shade in ((GRID, "o", colour(GRID)), (ELEMENTS, "s", "#D55E00")):
        nodes, values = energies[method]
        if nodes.size and np.isfinite(exact):
            apart = np.maximum(np.abs(values / exact - 1.0), ROUNDING)
            left.loglog(nodes, apart, color=shade, marker=marker, linewidth=1.0, label=method_name(method))
        nodes, values = bending[method]
        if nodes.size:
            right.semilogx(
                nodes, values, color=shade, marker=marker, linewidth=1.0, label=method_name(method)
            )
    if np.isfinite(limit.band):
        right.axhspan(
            limit.value - limit.band, limit.value + limit.band, color=colour(GRID), alpha=0.18, linewidth=0
        )
    left.set(title="(a) total energy", ylabel="relative distance from the membrane (–)", xlabel="nodes (–)")
    right.set(title="(b) bending energy", ylabel="bending energy (N mm)", xlabel="nodes (–)")
    right.margins(y=0.25)
    for ax in (left, right):
        if ax.get_legend_handles_labels()[0]:
            ax.legend()
