"""The report's section on the paper's own discretisation: where it agrees with the conservative one, where it fails."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from reports.content import Block, Drawing, Section, Table, Text
from reports.loads import measure, partner_key, pull_percent
from reports.maps import unavailable
from reports.plans import draw_height, inner_plans
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import hourglass, percent

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

VARIANTS = {
    "printed": "as printed",
    "filtered": "filtered ghost line",
    "stabilised": "filtered, with hourglass stiffness",
}
DRAWN = 6  # sheets side by side
FULL_COLOUR = 99.5  # percentile of |z| at which the colours are full
CHECKERBOARD = 0.2  # share out of plane above which a state is one


def build(results: Mapping[str, Stored]) -> Section:
    """Assemble the section from the runs of the part `published` and their conservative partners."""
    mine = [s for s in results.values() if s.run.part == "published" and s.method == "koiter-published"]
    partners = {
        mesh_key(s): s
        for s in results.values()
        if s.run.scene == "stretch" and s.method == "koiter" and s.run.part in ("published", "sweep")
    }
    blocks: list[Block] = [Text(_INTRODUCTION)]
    shown = sorted(mine, key=lambda s: (healthy(s), s.run.name))[:DRAWN]
    blocks.append(
        Drawing(
            "published-states",
            "The published scheme",
            "States that the published scheme ended in, failures first, coloured by height, each on its own scale.",
            "Plan views of the strip by variants of the published scheme: checkerboards, zigzag edges, and wrinkles.",
            partial(states, runs=shown),
            2.9,
            vector=False,
        )
    )
    blocks.append(comparison(mine, partners))
    failures = tuple(f"{described(s)}: {s.message}" for s in mine if not s.converged)
    if failures:
        blocks.append(Text("How its runs failed, in their own words:", failures))
    return Section("published", "The published scheme itself", blocks)


def mesh_key(stored: Stored) -> tuple[object, ...]:
    """Scene, load and mesh of a run, the shape of its cells included."""
    return (*partner_key(stored), cell_ratio(stored))


def cell_ratio(stored: Stored) -> float:
    """Height over width of the cells."""
    value = stored.run.overrides.get("mesh.cell_ratio", 1.0)
    return float(value) if isinstance(value, int | float) else math.nan


def variant(stored: Stored) -> str:
    """The variant of the scheme."""
    return str(stored.run.overrides.get("solver.published", "filtered"))


def healthy(stored: Stored) -> bool:
    """Whether a run converged to a state that is not mostly checkerboard."""
    share = stored.value("hourglass", "out_of_plane")
    return stored.converged and not share > CHECKERBOARD


def described(stored: Stored) -> str:
    """Variant, pull and mesh in words."""
    cells = (
        "" if cell_ratio(stored) == 1.0 else f", cells {cell_ratio(stored):g} times as long along the pull"
    )
    return f"{VARIANTS[variant(stored)]}, {pull_percent(stored):g} %, {whole(stored.value('nodes'))} nodes{cells}"


def comparison(mine: Sequence[Stored], partners: Mapping[tuple[object, ...], Stored]) -> Table:
    """Every run of the published scheme beside the conservative one on the same mesh."""
    rows = []
    for run in mine:
        other = partners.get(mesh_key(run))
        sizes = [measure(run, "rms_mm"), measure(other, "rms_mm") if other is not None else math.nan]
        rows.append(
            (
                VARIANTS[variant(run)],
                f"{pull_percent(run):g}",
                whole(run.value("nodes")),
                f"{cell_ratio(run):g}",
                run.status.replace("_", " "),
                number(run.value("residual"), 2),
                hourglass(run),
                number(sizes[0], 4),
                number(sizes[1], 4),
                percent(*sizes) if healthy(run) and other is not None and healthy(other) else "–",
                number(run.value("cpu_seconds"), 2),
                number(other.value("cpu_seconds"), 2) if other is not None else "–",
            )
        )
    columns = (
        "variant",
        "pull (%)",
        "nodes",
        "cell ratio (–)",
        "status",
        "residual (–)",
        "hourglass out / in (–)",
        "rms z (mm)",
        "conservative (mm)",
        "difference (%)",
        "CPU (s)",
        "CPU, conservative (s)",
    )
    caption = (
        "The published scheme on the strip beside the conservative one on the same mesh: rms height across the middle, "
        "which does not depend on the phase, compared where both are healthy. Cell ratio: length of a cell along the "
        "pull over its width."
    )
    return Table(caption, columns, tuple(rows))


def states(fig: FigureBase, runs: Sequence[Stored]) -> None:
    """Sheets side by side, each coloured by height on its own scale."""
    axes = fig.subplots(1, max(len(runs), 1), squeeze=False)[0]
    for k, (ax, run) in enumerate(zip(axes, runs, strict=False)):
        title = f"({'abcdefgh'[k]}) {variant(run)}, {pull_percent(run):g} %"
        if not run.drawable:
            unavailable(ax, title, run)
            continue
        z = run.fields["r"][..., 2]
        size = max(float(np.percentile(np.abs(z), FULL_COLOUR)), 1e-30)
        draw_height(ax, run.fields["r"], size, title, smooth=False)
        cells = "" if cell_ratio(run) == 1.0 else f", cells 1:{cell_ratio(run):g}"
        ax.set_title(f"{title}\n{run.status.replace('_', ' ')}{cells}", fontsize=7.5)
    inner_plans(list(axes))
    if not runs:
        axes[0].set_axis_off()
        axes[0].text(0.5, 0.5, "no run of the published scheme", ha="center")


_INTRODUCTION = (
    "The paper's scheme, Eqs. (52)–(65) and (74)–(77), on the pulled strip, in three variants: as printed; with a "
    "filtered ghost line; and with a consistent hourglass stiffness besides. As printed its explicit ghost update "
    "grows without bound. Without hourglass control it has meshes on which a pure checkerboard has no energy; such "
    "states are detected and named by the run, and shown here with the meshes that cause them."
)
