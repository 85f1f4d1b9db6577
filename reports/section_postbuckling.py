"""The report's section on the post-buckled states by finite elements, beside those by finite differences."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from cases.mesh_sequence import mesh_limit
from reports import element_cost
from reports import figures_postbuckling as figures
from reports.bands import FEWEST, Banded, banded
from reports.content import Block, Drawing, Section, Text
from reports.loads import finest, planned_nodes
from reports.plan_postbuckling import PART, SHOWN_PULLS
from reports.postbuckling_tables import agreement_table, agreement_words, run_table
from reports.postbuckling_values import (
    QUANTITIES,
    Both,
    Strip,
    element_value,
    level_values,
    strip_of,
    verified_runs,
)
from reports.stored import Stored
from reports.style import number
from reports.tables import remarks

GRID, ELEMENTS = "koiter", "postbuckling"
CREST = QUANTITIES[0]


def build(results: Mapping[str, Stored], benchmarks: Path) -> Section:
    """Assemble the section from the post-buckling runs, and from what the verification runs left in a folder."""
    mine = [s for s in results.values() if s.run.part == PART]
    strip = strip_of(results.values(), verified_runs(benchmarks))
    pulls = np.array(list(strip.elements), dtype=float)
    both = [strip.both_at(percent) for percent in strip.elements]
    exact = next((s for s in results.values() if s.run.scene == "annulus-lift" and s.method == "exact"), None)
    blocks: list[Block] = [Text(_INTRODUCTION)]
    blocks += [_measures(pulls, both), _profiles(strip), _convergence(strip)]
    blocks += [agreement_words(pulls, both), agreement_table(pulls, both)]
    blocks += _lift([s for s in mine if s.run.scene == "annulus-lift"], exact)
    blocks.append(run_table([*strip.elements.values(), *(s for s in mine if s.run.scene == "annulus-lift")]))
    blocks += element_cost.blocks(benchmarks)
    remarked = remarks(mine)
    return Section(
        "postbuckling", "Post-buckled states by finite elements", [*blocks, *([remarked] if remarked else [])]
    )


def _measures(pulls: np.ndarray, both: Sequence[Sequence[Both]]) -> Drawing:
    return Drawing(
        "postbuckling-measures",
        "The strip's wrinkles by two methods",
        "(a) to (d): the wrinkles across the middle against the pull. Squares: finite elements on the finest of their "
        "meshes, with the error that the run estimates from three. Line: limit of the finite differences within its "
        "band; dots: their finest mesh. (e) Difference of the two over the sum of both error bars: inside the blue "
        "stripe they agree.",
        "Four curves of wrinkle measures against the pull with the marks of finite elements on them, and the "
        "differences of the methods in units of their error bars.",
        partial(figures.measures, pulls=pulls, both=both),
        6.4,
    )


def _profiles(strip: Strip) -> Drawing:
    runs = {percent: (strip.elements.get(percent), finest(strip.grids(percent))) for percent in SHOWN_PULLS}
    return Drawing(
        "postbuckling-profiles",
        "Heights across the middle",
        "Thin: heights of the wrinkles by both methods, on their finest meshes. Thick: their envelopes, which is what "
        "can be compared: the wrinkles slide under them at no cost, so that their phase is what the start and "
        "rounding make it.",
        "Three pairs of wavy profiles under bell-shaped envelopes that lie on each other.",
        partial(figures.profiles, runs=runs),
        2.6,
    )


def _convergence(strip: Strip) -> Drawing:
    series, limits = {}, {}
    for percent in SHOWN_PULLS:
        run, grids = strip.meshes.get(percent), strip.grids(percent)
        by_elements = level_values(run, CREST.key) if run is not None else (np.empty(0), np.empty(0))
        values = np.array([strip.value(each, CREST) for each in grids])
        nodes = np.array([each.value("nodes") for each in grids])
        series[percent] = {ELEMENTS: by_elements, GRID: (nodes, values)}
        finer = strip.elements.get(percent)
        limits[percent] = _element_limit(series[percent][ELEMENTS], finer if finer is not run else None)
    return Drawing(
        "postbuckling-convergence",
        "Convergence of the amplitude",
        "Distance of the crest height across the middle from the finite elements' limit, in per cent, against the "
        "mesh. Broken line: the 0.5 % that is asked of the finite elements.",
        "Falling lines of the distance from the limit on ever finer meshes, steeper for finite elements.",
        partial(figures.convergence, series=series, limits=limits),
        2.5,
    )


def _element_limit(found: tuple[np.ndarray, np.ndarray], finer: Stored | None) -> float:
    """The limit of three meshes of finite elements, their finest value without one; the value of a finer run if any."""
    if finer is not None:
        return element_value(finer, CREST.key).finest
    nodes, values = found
    if len(values) < FEWEST:
        return math.nan
    limit = mesh_limit(nodes.tolist(), values.tolist())
    return limit.finest if limit.refused else limit.value


def _lift(mine: Sequence[Stored], exact: Stored | None) -> list[Block]:
    """Energies of the annulus that is lifted and not turned, where nothing wrinkles."""
    elements = [s for s in mine if s.method == ELEMENTS and s.converged]
    grids = sorted((s for s in mine if s.method == GRID and s.converged), key=planned_nodes)
    if not elements and not grids:
        return []
    nodes = np.array([s.value("nodes") for s in grids])
    series = {
        part: {
            GRID: (nodes, np.array([s.value("energy_N_mm", part) for s in grids])),
            ELEMENTS: level_values(elements[0], f"energy_N_mm.{part}") if elements else (np.empty(0),) * 2,
        }
        for part in ("total", "bending")
    }
    limit = banded(grids, lambda s: s.value("energy_N_mm", "bending"))
    total = exact.value("energy_N_mm", "total") if exact is not None else math.nan
    drawing = Drawing(
        "postbuckling-lift",
        "The lifted annulus by finite elements",
        "The inner circle is lifted and not turned: nothing wrinkles. (a) Distance of the total energy from that of "
        "the axisymmetric membrane, whose boundary-value problem is solved to ten digits; bending adds 2e-8 of it. "
        "(b) The bending energy, which the membrane has not; stripe: limit of the finite differences within its band.",
        "Falling distances from the membrane's energy for both methods, and bending energies that meet.",
        partial(figures.lift, exact=total, energies=series["total"], bending=series["bending"], limit=limit),
        2.5,
    )
    return [drawing, lift_words(series, total, limit)]


def lift_words(
    series: Mapping[str, Mapping[str, tuple[np.ndarray, np.ndarray]]], exact: float, limit: Banded
) -> Text:
    """How far both energies of the finite elements are from their references."""
    _, total = series["total"][ELEMENTS]
    _, bending = series["bending"][ELEMENTS]
    if not total.size:
        return Text("The lifted annulus has no result by finite elements.")
    return Text(
        f"The finite elements' total energy is {number(abs(total[-1] / exact - 1.0), 2)} (relative) from the "
        f"axisymmetric membrane's {number(exact, 9)} N\u00a0mm; their bending energy is {number(bending[-1], 5)} "
        f"N\u00a0mm, the finite differences' {limit.text(5)} N\u00a0mm."
    )


_INTRODUCTION = (
    "The same Koiter energy once more, by bicubic finite elements with continuous slopes (Bogner, Fox and Schmit) and "
    "Newton's method with the exact Hessian: no mesh, no discretisation, no iteration and no line of code is shared "
    "with the finite differences. The flat state is solved first, its lowest mode starts the wrinkles on a coarse "
    "mesh, and they are carried to finer ones; at the end the Hessian of the whole sheet is factorised in every class "
    "of symmetry, and its inertia says whether the state is stable. Compared is what does not depend on the phase of "
    "the wrinkles, which is neutral; the total energy is left out, because wrinkles change it by a hundred-thousandth."
)
