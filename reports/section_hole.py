"""The report's section on the pulled sheet with a hole."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from reports import figures_hole as figures
from reports import figures_runs
from reports.content import Block, Drawing, Section, Text
from reports.plan import HOLE_5
from reports.stored import Stored
from reports.tables import difference_table, quantity_table, remarks, run_table, wrinkle_table

LOADS = {
    "force on the top edge (N)": ("reactions", "top", "force_N", "#1"),
    "force on the bottom edge (N)": ("reactions", "bottom", "force_N", "#1"),
    "energy (N\u00a0mm)": ("energy_N_mm", "total"),
}


def build(results: Mapping[str, Stored]) -> Section:
    """Assemble the section from the runs of the scene `hole`, at both pulls."""
    mine = [s for s in results.values() if s.run.scene == "hole"]
    full = {s.method: s for s in mine if not s.run.overrides}
    half = {s.method: s for s in mine if s.run.overrides == HOLE_5}
    blocks: list[Block] = [Text(_INTRODUCTION), _deformed("fig7", "Fig. 7", full, "10")]
    blocks += [_maps(full), _paths("fig8-paths", "Fig. 8 b, c", full, "10")]
    if half:
        if any(s.method == "koiter" for s in half.values()):
            blocks.append(_deformed("hole-5", "Fig. 7 at half the pull", half, "5"))
        blocks.append(_paths("fig8-paths-5", "Fig. 8 b, c at half the pull", half, "5"))
    differences = difference_table(
        full, "tension-field", ("along_x", "along_y"), "Distance from the relaxed membrane along the paths."
    )
    blocks += [differences] if differences else []
    blocks.append(
        Drawing(
            "hole-residuals",
            "Residuals of the sheet with a hole",
            "Residual against step, nested meshes from coarse to fine.",
            "Curves of the residual falling with the step, one for each run.",
            partial(figures_runs.residuals, stored=list(full.values())),
            2.9,
        )
    )
    for runs, pull in ((full, "10"), (half, "5")):
        if runs:
            caption = (
                f"Loads and energy at a pull of {pull} %, with the difference from the relaxed membrane."
            )
            blocks.append(quantity_table(list(runs.values()), caption, LOADS, runs.get("tension-field")))
    wrinkles = wrinkle_table(
        [s for s in mine if s.method == "koiter"], "Wrinkles of the plate beside the hole."
    )
    blocks += [wrinkles] if wrinkles else []
    blocks.append(run_table(mine, "Runs of the sheet with a hole: 10 % first, then 5 %."))
    found = remarks(mine)
    return Section("hole", "Pulled sheet with a hole", [*blocks, *([found] if found else [])])


def _deformed(name: str, title: str, runs: Mapping[str, Stored], pull: str) -> Drawing:
    plate = runs.get("koiter")
    factor = figures.relief_factor(plate) if plate is not None and plate.drawable else 1.0
    light = f", slopes {factor:.0f} times steeper for the light only" if factor > 1.5 else ""
    return Drawing(
        name,
        title,
        f"Deformed sheet at a pull of {pull} %. The plate: (a) lit from the upper left{light}; "
        "(b) height; (c) state of its membrane stress. (d) The relaxed membrane.",
        "The pulled sheet with a hole seen from above: wrinkles in relief, heights, and zone states of "
        "both models.",
        partial(figures.deformed, runs=runs),
        4.5,
        vector=False,
    )


def _maps(runs: Mapping[str, Stored]) -> Drawing:
    return Drawing(
        "fig8-maps",
        "Fig. 8 a",
        "Largest principal stretch over the reference sheet at a pull of 10 %. Grey: slack in the relaxed "
        "membrane, where the stretch is not unique.",
        "Maps of the largest principal stretch of plate, relaxed membrane and unrelaxed membrane.",
        partial(figures.stretch_maps, runs=runs),
        4.1,
        vector=False,
    )


def _paths(name: str, title: str, runs: Mapping[str, Stored], pull: str) -> Drawing:
    return Drawing(
        name,
        title,
        f"Principal stretches at a pull of {pull} % along X and Y: below, distance from the hole's edge; "
        "above, distance from the hole's centre in units of half the sheet's length, as in the paper. "
        "Slack zones of the relaxed membrane are left out.",
        "Curves of both principal stretches along two paths from the hole by every method.",
        partial(figures.paths, runs=runs),
        4.3,
    )


_INTRODUCTION = (
    "A Kapton sheet 50 mm wide and 125 mm long with a hole of 15 mm radius, its short edges pinned and "
    "pulled apart by 10 % of the length. The paper's axes fit a pull of 5 % better on one of its paths, "
    "so both pulls were run. The relaxed membrane has slack zones beside the hole, in which its stretch "
    "is not unique; they are drawn as slack and not compared."
)
