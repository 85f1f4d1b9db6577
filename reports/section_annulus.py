"""The report's section on the twisted and lifted annulus."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from reports import figures_annulus as figures
from reports import figures_runs
from reports.content import Block, Drawing, Section, Table, Text
from reports.convergence import AXIAL_FORCE, TORQUE, order_data, order_drawing, order_table
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import (
    difference_table,
    quantity_table,
    remarks,
    run_table,
    wrinkle_table,
)

COMPARED_NODES = 20000  # the paper's mesh
LOADS = {
    "torque at the inner circle (N\u00a0mm)": TORQUE,
    "axial force at the inner circle (N)": AXIAL_FORCE,
    "energy (N\u00a0mm)": ("energy_N_mm", "total"),
}


def build(results: Mapping[str, Stored]) -> Section:
    """Assemble the section from the runs of the scene `annulus`."""
    mine = [s for s in results.values() if s.run.scene == "annulus"]
    plain = [s for s in mine if not s.run.overrides]
    runs = main_runs(plain)
    blocks: list[Block] = [Text(_INTRODUCTION)]
    blocks += _figures(runs)
    blocks += [_resolved(s) for s in mine if s.run.overrides]
    meshes = order_data(plain)
    if len(meshes[0]) > 1:
        blocks += [order_drawing(*meshes), order_table(plain)]
    blocks.append(
        Drawing(
            "annulus-residuals",
            "Residuals of the annulus",
            "Residual against step. The nested meshes follow each other from coarse to fine; each begins "
            "anew with the interpolated shape of the one before.",
            "Curves of the residual falling with the step, one for each run.",
            partial(figures_runs.residuals, stored=residual_runs(mine, runs)),
            2.9,
        )
    )
    distances = difference_table(runs, "exact", ("radius",), "Distance from the closed form, ring by ring.")
    blocks += [distances] if distances else []
    blocks.append(_loads(plain, runs))
    wrinkles = wrinkle_table(
        [s for s in mine if s.method == "koiter"], "Wrinkles on three rings, height less the ring's mean."
    )
    blocks += [wrinkles] if wrinkles else []
    blocks.append(run_table(mine, "Runs of the annulus."))
    found = remarks(mine)
    return Section("annulus", "Twisted and lifted annulus", [*blocks, *([found] if found else [])])


def main_runs(plain: list[Stored]) -> dict[str, Stored | None]:
    """For each method the run nearest COMPARED_NODES; of the plate the finest converged one."""
    runs: dict[str, Stored | None] = {}
    for method in dict.fromkeys(s.method for s in plain):
        mine = [s for s in plain if s.method == method]
        usable = [s for s in mine if s.drawable] or mine
        if method == "koiter":
            runs[method] = max(usable, key=lambda s: (s.converged, np.nan_to_num(s.value("nodes"))))
        else:
            runs[method] = min(usable, key=_far_from_compared)
    return runs


def _far_from_compared(stored: Stored) -> float:
    nodes = stored.value("nodes")
    return abs(np.log(nodes / COMPARED_NODES)) if nodes > 0.0 else np.inf


def residual_runs(mine: list[Stored], runs: dict[str, Stored | None]) -> list[Stored]:
    """The compared runs, then every other run of the plate."""
    compared = [s for s in runs.values() if s is not None]
    return [*compared, *(s for s in mine if s.method == "koiter" and s not in compared)]


def _figures(runs: dict[str, Stored | None]) -> list[Block]:
    return [
        Drawing(
            "fig9",
            "Fig. 9",
            "Deformed annulus, inner circle lifted by 125 mm and turned by 90 degrees: the plate with its "
            "wrinkles (a, b) and the relaxed membrane (c, d), which carries the same tension without a "
            "wrinkle. Left: lit views; right: the membrane state from above.",
            "Lit views of the twisted annulus by the plate and by the relaxed membrane, with their "
            "membrane states.",
            partial(figures.deformed, runs=runs),
            5.5,
            vector=False,
        ),
        Drawing(
            "fig10-map",
            "Fig. 10 a",
            "Largest principal stretch over the reference sheet.",
            "Maps of the largest principal stretch of the plate and of the relaxed membrane.",
            partial(figures.stretch_map, runs=runs),
            2.75,
            vector=False,
        ),
        Drawing(
            "fig10-curves",
            "Fig. 10 b",
            "Largest principal stretch, mean of each ring, against the radius and its square, by every "
            "method and by the closed form; below, the distance from the closed form. Tinted: wrinkled in "
            "the closed form. This stretch alone cannot tell a wrinkled sheet from a compressed, "
            "unrelaxed membrane.",
            "Curves of the largest stretch against radius and radius squared, and differences from the "
            "closed form.",
            partial(figures.stretch_curves, runs=runs),
            4.2,
        ),
        Drawing(
            "fig10-apart",
            "Beside Fig. 10",
            "What does tell a wrinkled sheet from a compressed one: the second stretch, the minor stress "
            "(zero where a relaxed membrane is wrinkled, compressive in the unrelaxed one), and the "
            "wrinkles themselves.",
            "Curves of second stretch and minor stress, profiles of the wrinkles on three rings, and "
            "their rms height.",
            partial(figures.what_tells_apart, runs=runs),
            4.4,
        ),
    ]


def _resolved(stored: Stored) -> Drawing:
    thickness = stored.run.overrides.get("sheet.thickness_mm")
    return Drawing(
        "fig9-resolved",
        "Resolved wrinkles",
        f"The plate at a thickness of {thickness} mm on {whole(stored.value('nodes'))} nodes: "
        f"{number(stored.value('nodes_per_wrinkle'), 2)} nodes in its shortest wrinkle. At the thickness "
        "of the scene the wrinkles are finer than most meshes resolve, and their number follows the mesh.",
        "Lit view of a thicker wrinkled ring and the profiles of its wrinkles on three circles.",
        partial(figures.resolved, stored=stored),
        2.9,
        vector=False,
    )


def _loads(plain: list[Stored], runs: dict[str, Stored | None]) -> Table:
    return quantity_table(
        residual_runs(plain, runs),
        "Loads and energy at the thickness of the scene, with the difference from the closed form.",
        LOADS,
        runs.get("exact"),
    )


_INTRODUCTION = (
    "A Kapton ring of radii 62.5 and 250 mm; the outer circle is held, the inner one is lifted by 125 mm "
    "and turned by 90 degrees. The relaxed membrane has a closed form: in the wrinkled band the stretch "
    "follows from R² = C²/f(λ)² + t²/λ² with f(λ) = λ(λ² − 1)/2 and two constants, C and t, given by the "
    "whole boundary-value problem, because the sheet is tense beside both rims."
)
