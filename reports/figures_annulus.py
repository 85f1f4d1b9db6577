"""Figures of the twisted and lifted annulus: Fig. 9 and Fig. 10 of Taylor et al. (2014), and what they leave out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.maps import limits, state_legend, unavailable, zone_map, zone_rgb
from reports.stored import Columns, Stored
from reports.style import STRESS_MINOR, STRETCH_MAJOR, STRETCH_MINOR, colour, line, method_name
from reports.surface import View, lit_view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

Runs = Mapping[str, Stored | None]  # method -> its run
VIEW = View(azimuth_deg=-70.0, elevation_deg=38.0)
METHODS = ("membrane", "tension-field", "koiter", "exact")  # later ones are drawn on top


def draw_lit(ax: Axes, stored: Stored | None, title: str, view: View = VIEW, coloured: bool = False) -> None:
    """Lit view of the deformed sheet with a scale bar, or the reason why there is none."""
    if stored is None or not stored.drawable:
        unavailable(ax, title, stored)
        return
    picture = lit_view(stored.fields["r"], zone_rgb(stored, coloured), stored.closed, view)
    ax.imshow(picture.rgba, extent=picture.extent, interpolation="antialiased")
    ax.set_title(title)
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
    axes = fig.subplots(2, 2)
    letters = iter("abcd")
    for row, method in enumerate(("koiter", "tension-field")):
        name = method_name(method)
        draw_lit(axes[row, 0], runs.get(method), f"({next(letters)}) {name}")
        draw_lit(
            axes[row, 1], runs.get(method), f"({next(letters)}) {name}, membrane state", View(), coloured=True
        )
    state_legend(axes[1, 1], loc="center", bbox_to_anchor=(0.5, 0.5))


def stretch_map(fig: FigureBase, runs: Runs) -> None:
    """Fig. 10 a: the largest principal stretch over the reference sheet, plate beside relaxed membrane."""
    axes = fig.subplots(1, 2, sharey=True)
    there = {m: s for m in ("koiter", "tension-field") if (s := runs.get(m)) is not None and s.drawable}
    low, high = limits(*(s.fields["stretch_major"] for s in there.values()))
    mesh = None
    for ax, method, letter in zip(axes, ("koiter", "tension-field"), "ab", strict=True):
        title = f"({letter}) {method_name(method)}"
        if method not in there:
            unavailable(ax, title, runs.get(method))
            continue
        field = there[method].fields["stretch_major"]
        mesh = zone_map(ax, there[method], field, cmap="viridis", vmin=low, vmax=high)
        ax.set_title(title)
        ax.label_outer()
    if mesh is not None:
        fig.colorbar(mesh, ax=axes, label=STRETCH_MAJOR, extend="both", shrink=0.8, aspect=30, pad=0.02)


def curve(ax: Axes, x: np.ndarray, y: np.ndarray, method: str, **style: Any) -> None:
    """One method's curve in its colour and line style; the closed form thin, on top of the others."""
    width = 0.8 if method == "exact" else 1.4
    ax.plot(
        x,
        y,
        color=colour(method),
        linestyle=line(method),
        linewidth=width,
        label=method_name(method),
        **style,
    )


def _paths(runs: Runs) -> dict[str, Columns]:
    return {m: s.path("radius") for m in METHODS if (s := runs.get(m)) is not None and s.path("radius")}


def shade_band(ax: Axes, columns: Columns | None, x: np.ndarray) -> None:
    """Tint where the closed form is wrinkled."""
    if not columns or "state" not in columns:
        return
    wrinkled = np.rint(columns["state"]) == 1
    if wrinkled.any():
        ax.axvspan(x[wrinkled].min(), x[wrinkled].max(), color="#F0B94D", alpha=0.16, linewidth=0)


def stretch_curves(fig: FigureBase, runs: Runs) -> None:
    """Fig. 10 b: stretch against R and R^2, and the differences from the closed form."""
    paths = _paths(runs)
    axes = fig.subplots(2, 2, sharex="col", sharey="row", height_ratios=[1.7, 1.0])
    exact = paths.get("exact")
    for column, power in enumerate((1, 2)):
        above, below = axes[0, column], axes[1, column]
        for method, path in paths.items():
            x = path["R_mm"] ** power
            curve(above, x, path["stretch_major"], method)
            if exact and method != "exact":
                reference = np.interp(path["R_mm"], exact["R_mm"], exact["stretch_major"])
                curve(below, x, np.abs(path["stretch_major"] - reference), method)
        if exact:
            shade_band(above, exact, exact["R_mm"] ** power)
            shade_band(below, exact, exact["R_mm"] ** power)
        below.set_yscale("log")
        below.set_xlabel("$R$ (mm)" if power == 1 else "$R^2$ (mm$^2$)")
        above.set_title("(a) against the radius" if power == 1 else "(b) against its square")
    axes[0, 0].set_ylabel(STRETCH_MAJOR)
    axes[1, 0].set_ylabel("difference from closed form (–)")
    if paths:
        axes[0, 1].legend()


def what_tells_apart(fig: FigureBase, runs: Runs) -> None:
    """Second stretch, minor stress and the wrinkles' profiles: what tells a wrinkled sheet from a compressed one."""
    axes = fig.subplots(2, 2)
    for method, path in _paths(runs).items():
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
    axes[0, 0].legend()
    _ring_profiles(axes[1, 0], runs.get("koiter"))
    _amplitude(axes[1, 1], runs)


def ring_means(stored: Stored | None, field: str) -> tuple[np.ndarray, np.ndarray]:
    """Mean of a zone field round each ring of zones, against the radius of the zone centres, mm."""
    if stored is None or field not in stored.fields or stored.fields["u"].ndim != 3:
        return np.empty(0), np.empty(0)
    radius = np.linalg.norm(stored.fields["u"], axis=-1).mean(axis=0)
    return 0.5 * (radius[1:] + radius[:-1]), stored.fields[field].mean(axis=0)


def _ring_profiles(ax: Axes, stored: Stored | None) -> None:
    title = "(c) height on a ring less its mean, plate"
    names = [] if stored is None else [n for n in stored.section_names if n.startswith("ring")]
    if stored is None or not names:
        unavailable(ax, title, stored)
        return
    shades = ("#0B3C5D", "#0072B2", "#7DB8DA")
    for name, shade in zip(names, shades, strict=False):
        section = stored.section(name)
        radius = float(np.hypot(section["x_mm"], section["y_mm"]).mean())
        angle = np.degrees(section["s_mm"] / radius)
        ax.plot(angle, section["z_mm"], color=shade, linewidth=0.8, label=f"$R$ = {radius:.0f} mm")
    ax.set_xlim(0.0, 90.0)  # a quarter of the circle, so that single wrinkles can be seen
    ax.set_xlabel("angle along the ring (degrees)")
    ax.set_ylabel("height $z$ less ring mean (mm)")
    ax.set_title(title)
    ax.legend(ncols=len(names), loc="upper center", columnspacing=1.0, handlelength=1.2)
    ax.margins(y=0.25)


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
