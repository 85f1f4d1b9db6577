"""Figures of the twisted and lifted annulus: Fig. 9 and 10 of Taylor et al. (2014), and more."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reports.curves import Runs, curve, legend
from reports.maps import (
    draw_states,
    limits,
    plain_rgb,
    state_legend,
    state_rgb,
    unavailable,
    zone_map,
)
from reports.stored import Columns, Stored
from reports.style import STRESS_MINOR, STRETCH_MAJOR, STRETCH_MINOR, WRINKLED_TINT, method_name
from reports.surface import View, lit_view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

VIEW = View(azimuth_deg=-70.0, elevation_deg=38.0)
METHODS = ("membrane", "tension-field", "koiter", "exact")  # later ones are drawn on top
SURFACES = ("koiter", "tension-field")


def draw_lit(ax: Axes, stored: Stored | None, title: str, coloured: bool = False, pixels: int = 1400) -> None:
    """Lit view of the deformed sheet with a scale bar, or the reason why there is none."""
    if stored is None or not stored.drawable:
        unavailable(ax, title, stored)
        return
    colours = state_rgb(stored) if coloured else plain_rgb(stored)
    picture = lit_view(stored.fields["r"], colours, stored.closed, VIEW, pixels)
    ax.imshow(picture.rgba, extent=picture.extent, interpolation="antialiased")
    ax.set_title(title)
    ax.set_anchor("N")
    ax.set_axis_off()
    left, right, bottom, _ = picture.extent
    length = 10.0 ** np.floor(np.log10((right - left) / 3.0))
    ax.plot([left, left + length], [bottom, bottom], color="black", linewidth=1.5, clip_on=False)
    ax.annotate(
        f"{length:g} mm",
        (left + length / 2, bottom),
        xytext=(0, 3),
        textcoords="offset points",
        ha="center",
        fontsize=7.5,
    )


def deformed(fig: FigureBase, runs: Runs) -> None:
    """Fig. 9: the deformed sheet, plate above, relaxed membrane below, plain and coloured by state."""
    axes = fig.subplots(2, 2, width_ratios=[1.5, 1.0])
    for row, (method, letters) in enumerate(zip(SURFACES, ("ab", "cd"), strict=True)):
        draw_lit(axes[row, 0], runs.get(method), f"({letters[0]}) {method_name(method)}")
        draw_states(axes[row, 1], runs.get(method), f"({letters[1]}) state, seen from above")
    state_legend(fig, loc="outside lower center", ncols=3)


def resolved(fig: FigureBase, stored: Stored) -> None:
    """A plate whose wrinkles the mesh resolves: lit view, and its height on three rings."""
    left, right = fig.subplots(1, 2, width_ratios=[1.35, 1.0])
    draw_lit(left, stored, "(a) plate")
    _ring_profiles(right, stored, "(b) height on three rings less its mean")


def stretch_map(fig: FigureBase, runs: Runs) -> None:
    """Fig. 10 a: the largest principal stretch over the reference sheet, plate beside relaxed membrane."""
    axes = fig.subplots(1, 2, sharey=True)
    there = {m: s for m in SURFACES if (s := runs.get(m)) is not None and s.drawable}
    span = limits(*(s.fields["stretch_major"] for s in there.values()))
    key = None
    for ax, method, letter in zip(axes, SURFACES, "ab", strict=True):
        title = f"({letter}) {method_name(method)}"
        if method not in there:
            unavailable(ax, title, runs.get(method))
            continue
        stored = there[method]
        key = zone_map(ax, stored, stored.fields["stretch_major"], "reference", "viridis", span)
        ax.set_title(title)
        ax.label_outer()
    if key is not None:
        fig.colorbar(key, ax=axes, label=STRETCH_MAJOR, extend="both", shrink=0.85, aspect=30, pad=0.02)


def paths(runs: Runs) -> dict[str, Columns]:
    """The radial paths that were stored, by method."""
    return {m: s.path("radius") for m in METHODS if (s := runs.get(m)) is not None and s.path("radius")}


def shade_band(ax: Axes, columns: Columns, x: np.ndarray) -> None:
    """Tint where the closed form is wrinkled."""
    wrinkled = np.rint(columns["state"]) == 1
    if wrinkled.any():
        ax.axvspan(x[wrinkled].min(), x[wrinkled].max(), color=WRINKLED_TINT, linewidth=0, zorder=0)


def stretch_curves(fig: FigureBase, runs: Runs) -> None:
    """Fig. 10 b: stretch against R and R^2, and the differences from the closed form."""
    found = paths(runs)
    axes = fig.subplots(2, 2, sharex="col", sharey="row", height_ratios=[1.7, 1.0])
    exact = found.get("exact")
    for column, power in enumerate((1, 2)):
        above, below = axes[0, column], axes[1, column]
        for method, path in found.items():
            x = path["R_mm"] ** power
            curve(above, x, path["stretch_major"], method)
            if exact and method != "exact":
                reference = np.interp(path["R_mm"], exact["R_mm"], exact["stretch_major"])
                gap = np.abs(path["stretch_major"] - reference)
                curve(below, x, np.where(gap > 0.0, gap, np.nan), method)
        if exact:
            shade_band(above, exact, exact["R_mm"] ** power)
            shade_band(below, exact, exact["R_mm"] ** power)
        below.set_yscale("log")
        below.set_xlabel("$R$ (mm)" if power == 1 else "$R^2$ (mm$^2$)")
        above.set_title("(a) against the radius" if power == 1 else "(b) against its square")
    axes[0, 0].set_ylabel(STRETCH_MAJOR)
    axes[1, 0].set_ylabel("distance from\nclosed form (–)")
    legend(axes[0, 1], runs, METHODS)


def what_tells_apart(fig: FigureBase, runs: Runs) -> None:
    """Second stretch, minor stress and wrinkles: what tells a wrinkled sheet from a compressed one."""
    axes = fig.subplots(2, 2)
    for method, path in paths(runs).items():
        curve(axes[0, 0], path["R_mm"], path["stretch_minor"], method)
        radius, stress = ring_means(runs[method], "stress_minor")
        if radius.size:
            curve(axes[0, 1], radius, stress, method)
    axes[0, 0].set_ylabel(STRETCH_MINOR)
    axes[0, 1].set_ylabel(STRESS_MINOR)
    axes[0, 0].set_title("(a) second stretch, ring means")
    axes[0, 1].set_title("(b) minor membrane stress, ring means")
    for ax in axes[0]:
        ax.set_xlabel("$R$ (mm)")
    legend(axes[0, 0], runs, METHODS)
    _ring_profiles(axes[1, 0], runs.get("koiter"), "(c) height on three rings less its mean, plate")
    _amplitude(axes[1, 1], runs)


def ring_means(stored: Stored | None, field: str) -> tuple[np.ndarray, np.ndarray]:
    """Mean of a zone field round each ring of zones, against the radius of the zone centres, mm."""
    if stored is None or not stored.drawable or field not in stored.fields:
        return np.empty(0), np.empty(0)
    radius = np.linalg.norm(stored.fields["u"], axis=-1).mean(axis=0)
    return 0.5 * (radius[1:] + radius[:-1]), stored.fields[field].mean(axis=0)


def _ring_profiles(ax: Axes, stored: Stored | None, title: str) -> None:
    names = [] if stored is None else [n for n in stored.section_names if n.startswith("ring")]
    if stored is None or not names:
        unavailable(ax, title, stored)
        return
    for name, shade in zip(names, ("#0B3C5D", "#0072B2", "#8CC4E3"), strict=False):
        section = stored.section(name)
        radius = float(np.hypot(section["x_mm"], section["y_mm"]).mean())
        angle = np.degrees(section["s_mm"] / radius)
        ax.plot(angle, section["z_mm"], color=shade, linewidth=0.8, label=f"$R$ = {radius:.0f} mm")
    ax.set_xlim(0.0, 90.0)  # a quarter of the circle, so that single wrinkles can be seen
    ax.set_xlabel("angle along the ring (degrees)")
    ax.set_ylabel("height $z$ less ring mean (mm)")
    ax.set_title(title)
    ax.margins(y=0.25)
    ax.legend(ncols=len(names), loc="upper center", columnspacing=1.0, handlelength=1.2)


def _amplitude(ax: Axes, runs: Runs) -> None:
    """Root mean square of the height's deviation from its ring mean, ring by ring of nodes."""
    for method in ("membrane", "tension-field", "koiter"):
        stored = runs.get(method)
        if stored is None or not stored.drawable:
            continue
        z = stored.fields["r"][..., 2]
        radius = np.linalg.norm(stored.fields["u"], axis=-1).mean(axis=0)
        curve(ax, radius, np.std(z, axis=0), method)
    ax.set_xlabel("$R$ (mm)")
    ax.set_ylabel("rms height of wrinkles (mm)")
    ax.set_title("(d) size of the wrinkles, rms round each ring")
