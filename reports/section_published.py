"""The report's section on the paper's own discretisation: where it agrees with the conservative one, where it fails."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from reports.content import Block, Drawing, Section, Table, Text
from reports.figures_published import states
from reports.loads import measure, partner_key, pull_percent
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import percent

if TYPE_CHECKING:
    pass

VARIANTS = {
    "printed": "as printed",
    "filtered": "filtered ghost line",
    "stabilised": "filtered, with hourglass stiffness",
}
DRAWN = 6  # sheets side by side
CHECKERBOARD = 0.2  # share out of plane above which a state is one
APART = ("solver.published", "effects.out_of_plane")  # keys in which a run and its partner differ


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
            "States that the published scheme ended in, failures first, coloured by height, each on its own scale, "
            "which stands below it. Second row: the cells around the highest point of each.",
            "Plan views of the strip by variants of the published scheme: checkerboards, zigzag edges, and wrinkles; "
            "and close views in which the cells of the checkerboards are seen.",
            partial(states, runs=shown, titles=[short_title(s) for s in shown]),
            4.6,
            vector=False,
        )
    )
    blocks.append(comparison(mine, partners))
    failures = tuple(f"{described(s)}: {s.message}" for s in mine if not s.converged)
    if failures:
        blocks.append(Text("How its runs failed, in their own words:", failures))
    return Section("published", "The published scheme itself", blocks)


def mesh_key(stored: Stored) -> tuple[object, ...]:
    """Scene, load, mesh and start of a run: all but the scheme."""
    others = sorted((key, str(value)) for key, value in stored.run.overrides.items() if key not in APART)
    return (*partner_key(stored), *others)


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


def high_start(stored: Stored) -> bool:
    """Whether a run starts from noise about as high as the sheet is thick."""
    return "start.perturbation" in stored.run.overrides


def described(stored: Stored) -> str:
    """Variant, pull, mesh and start in words."""
    cells = (
        "" if cell_ratio(stored) == 1.0 else f", cells {cell_ratio(stored):g} times as long along the pull"
    )
    start = ", square cells, a start about as high as the sheet is thick" if high_start(stored) else ""
    nodes = whole(stored.value("nodes"))
    return f"{VARIANTS[variant(stored)]}, {pull_percent(stored):g} %, {nodes} nodes{cells}{start}"


def short_title(stored: Stored) -> str:
    """Two lines over a drawing."""
    cells = "" if cell_ratio(stored) == 1.0 else f", cells 1:{cell_ratio(stored):g}"
    status = stored.status.replace("_", " ")
    return f"{variant(stored)}, {pull_percent(stored):g} %\n{status}{cells}"


def seconds(run: Stored, other: Stored | None) -> str:
    """CPU seconds of a run and of its partner."""
    partner = number(other.value("cpu_seconds"), 2) if other is not None else "–"
    return f"{number(run.value('cpu_seconds'), 2)} / {partner}"


def comparison(mine: Sequence[Stored], partners: Mapping[tuple[object, ...], Stored]) -> Table:
    """Every run of the published scheme beside the conservative one on the same mesh."""
    rows = []
    for run in mine:
        other = partners.get(mesh_key(run))
        sizes = [measure(run, "rms_mm"), measure(other, "rms_mm") if other is not None else math.nan]
        rows.append(
            (
                variant(run),
                f"{pull_percent(run):g}",
                whole(run.value("nodes")),
                f"{cell_ratio(run):g}",
                "high" if high_start(run) else "low",
                run.status.replace("_", " "),
                number(run.value("residual"), 2),
                number(run.value("hourglass", "out_of_plane"), 2),
                number(sizes[0], 4),
                number(sizes[1], 4),
                percent(*sizes) if healthy(run) and other is not None and healthy(other) else "–",
                seconds(run, other),
            )
        )
    columns = (
        "variant",
        "pull (%)",
        "nodes",
        "cell ratio (–)",
        "start",
        "status",
        "residual (–)",
        "checkerboard (–)",
        "rms z (mm)",
        "partner (mm)",
        "difference (%)",
        "CPU (s)",
    )
    caption = (
        "The published scheme on the strip beside the conservative one on the same mesh: rms height across the middle, "
        "which does not depend on the phase, compared where both are healthy. Variants: as printed; filtered ghost "
        "line; stabilised, which is filtered with hourglass stiffness. Cell ratio: length of a cell along the pull "
        "over its width. Start: noise of a millionth of the strip's size, or of a thousandth (high). Checkerboard: "
        "its share of the heights. CPU: of this run and of its conservative partner."
    )
    return Table(caption, columns, tuple(rows))


_INTRODUCTION = (
    "The paper's scheme, Eqs. (52)–(65) and (74)–(77), on the pulled strip, in three variants: as printed; with a "
    "filtered ghost line; and with a consistent hourglass stiffness besides. As printed its explicit ghost update "
    "grows without bound. Without hourglass control a checkerboard of the mesh costs no energy. Compression across the "
    "pull makes one grow, and the pull, which holds true wrinkles down, does not resist it. On cells longer along the "
    "pull it grows from any start; on square cells at 20 %, where wrinkles have nearly vanished, only from a start "
    "about as high as the sheet is thick: from lower ones the strip wrinkles on all meshes tried, 1 500 to 24 000 "
    "nodes. Such states are detected and named by the run."
)
