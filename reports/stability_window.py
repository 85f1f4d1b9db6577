"""Where the flat, finitely strained strip is stable: along its pull, over thickness and aspect ratio.

The numbers are those that the verification runs leave beside `benchmarks.json`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from reports import figures_stability as figures
from reports.content import Block, Drawing, Table, Text
from reports.stored import Columns, read_columns
from reports.style import number, whole

ALONG_THE_LOAD, MAP = "stretch-flat-stability.csv", "stretch-stability-map.csv"
WINDOW = "test_window_of_the_pulled_strip"
HOW = "`pytest -m benchmark tests/benchmarks/test_buckling.py` does it"


def blocks(benchmarks: Path, thickness_mm: float) -> list[Block]:
    """Text, table and figure on the flat strip.

    benchmarks : folder of the verification runs. thickness_mm : of the scene; NaN if it is not known.
    """
    along, over = read_columns(benchmarks / ALONG_THE_LOAD), read_columns(benchmarks / MAP)
    ends = window_words(read_quantities(benchmarks / "benchmarks.json"), along)
    found: list[Block] = [Text(f"{_INTRODUCTION} {ends}")]
    if along:
        found.append(load_table(along))
    if over:
        found.append(_drawing(over, thickness_mm))
    else:
        found.append(Text(f"The map over thickness and aspect ratio was not run beside this report: {HOW}."))
    return found


def read_quantities(path: Path) -> Mapping[str, float]:
    """Numbers of the verification of the window, {} if it was not run."""
    if not path.is_file():
        return {}
    for entry in json.loads(path.read_text(encoding="utf-8"))["runs"]:
        if str(entry.get("name", "")).endswith(WINDOW):
            return {q["quantity"]: q["value"] for q in entry["quantities"] if isinstance(q["value"], float)}
    return {}


def window_words(quantities: Mapping[str, float], along: Columns) -> str:
    """Between which strains the flat strip is unstable, with the change from the next coarser mesh."""
    ends = [
        (quantities.get(end), quantities.get(f"{end}, change from the next coarser mesh"))
        for end in ("appearance", "disappearance")
    ]
    if all(value is not None and error is not None for value, error in ends):
        (low, low_error), (high, high_error) = (
            (100.0 * v, 100.0 * e) for v, e in ends if v and e is not None
        )
        return (
            f"It is unstable from {low:.3f} ± {low_error:.1g} % to {high:.2f} ± {high_error:.1g} % of strain; "
            "±: change from the next coarser mesh."
        )
    brackets = changes(along)
    if brackets:
        return (
            "It changes its stability " + "; ".join(f"between {a:g} and {b:g} %" for a, b in brackets) + "."
        )
    return f"This was not run beside this report: {HOW}."


def changes(along: Columns) -> list[tuple[float, float]]:
    """Neighbouring strains (%) of the table of which one is stable and the other is not."""
    if not along:
        return []
    strain, unstable = 100.0 * along["strain"], along["unstable"] > 0
    return [(float(strain[k]), float(strain[k + 1])) for k in np.flatnonzero(unstable[1:] != unstable[:-1])]


def load_table(along: Columns) -> Table:
    """Stability at each strain."""
    rows = tuple(
        (
            number(100.0 * strain, 3),
            number(factor, 4) if math.isfinite(factor) else "–",
            whole(unstable),
            number(thickness, 3),
        )
        for strain, factor, unstable, thickness in zip(
            *(along[name] for name in ("strain", "factor", "unstable", "neutral_thickness_mm")), strict=True
        )
    )
    return Table(
        "The flat strip along its pull: the multiple of its membrane stress at which it buckles (below 1: unstable; "
        "dash: nowhere compressed), its unstable modes, and the least thickness at which it would be stable.",
        ("strain (%)", "factor of the stress (–)", "unstable modes", "least stable thickness (mm)"),
        rows,
    )


def _drawing(over: Columns, thickness_mm: float) -> Drawing:
    return Drawing(
        "stability-map",
        "Where flat strips are stable",
        "(a) Least thickness at which a flat strip of the scene's width is stable, against its strain, for several "
        "ratios of height to width: below its curve a sheet is wrinkled. (b) The largest of each curve: sheets above "
        "are not wrinkled at any of these strains. Bars: change from a mesh of half the vertices. Broken line: the "
        "thickness of the scene." + _worst_words(over),
        "Curves of the least stable thickness against strain, one for each aspect ratio, and their largest values "
        "against the aspect ratio.",
        partial(figures.stability_map, over=over, thickness_mm=thickness_mm),
        3.1,
    )


def _worst_words(over: Columns) -> str:
    """How far the bars reach, of the thicknesses that are not small."""
    value, error = over["neutral_thickness_mm"], over["error_mm"]
    high = value > 0.25 * value.max()
    worst = float((error[high] / value[high]).max()) if high.any() else 0.0
    return f" Largest bar above a quarter of the highest curve: {number(100.0 * worst, 2)} %."


_INTRODUCTION = (
    "Is the flat strip stable at a finite pull? The plane state is that of the finite strains (St. Venant and "
    "Kirchhoff's law), and its out-of-plane tangent is that of the plate's energy about it, on the same elements. The "
    "linear factors above know only when wrinkles appear; the finite strains also say when they are gone."
)
