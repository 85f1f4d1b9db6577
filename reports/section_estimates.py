"""The report's section on the error estimates that come with every result: are they true?"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

from reports import figures_estimates as figures
from reports.content import Block, Drawing, Section, Table, Text
from reports.measured import read_document
from reports.style import number, whole

FILE = "error-coverage.json"
Coverage = Mapping[str, Any]


def read_coverage(folder: Path) -> Coverage | None:
    """What the benchmark of the error estimates left; None if it was not run."""
    return read_document(folder / FILE)


def build(coverage: Coverage | None) -> Section:
    """Assemble the section; without a measurement it says how to make one."""
    title = "How far the error estimates can be trusted"
    if coverage is None:
        text = "The estimates were not yet held against known truths: `pytest -m benchmark` does."
        return Section("estimates", title, [Text(text)])
    return Section("estimates", title, _blocks(coverage))


def _blocks(coverage: Coverage) -> list[Block]:
    quantities = coverage["quantities"]
    made = sum(one["estimates"] for one in quantities.values())
    refused = sum(one["refused"] for one in quantities.values())
    inside = sum(one["inside"] for one in quantities.values())
    every = [ratio for one in quantities.values() for ratio in one["ratios"]]
    said = (
        f"Every result carries an estimate of its own error. On {whole(coverage['runs'])} runs whose answer is known"
        " (closed-form annuli of random shape, material and load; given wavy shapes; homogeneous strips)"
        f" {number(100.0 * inside / (made - refused), 3)} % of {whole(made - refused)} true errors lie inside the"
        f" estimate, whose median is {number(median(every), 3)} times the true error;"
        f" {number(100.0 * refused / made, 2)} % of the estimates are refused with a reason."
    )
    drawing = Drawing(
        "error-estimates",
        "Estimated and true errors",
        "Estimated over true error, by quantity: dots, medians; bars, the span of nine tenths of the runs. Left of 1"
        " the estimate is too small, right of the dashed line five times too large.",
        "Ratios of estimated to true errors by quantity, mostly between one and five.",
        partial(figures.ratios, quantities=quantities),
        3.4,
    )
    return [Text(said), drawing, _table(quantities), _reasons(quantities)]


def _table(quantities: Mapping[str, Coverage]) -> Table:
    rows = tuple(
        (
            name,
            whole(one["estimates"]),
            whole(one["refused"]),
            _share(one["inside"], one["estimates"] - one["refused"]),
            number(median(one["ratios"]), 3) if one["ratios"] else "–",
        )
        for name, one in quantities.items()
    )
    columns = ("quantity", "estimates", "refused", "inside (%)", "median of estimate over error (–)")
    return Table("Error estimates against known truths, by quantity.", columns, rows, wide=(0,))


def _reasons(quantities: Mapping[str, Coverage]) -> Text:
    found: dict[str, dict[str, int]] = {}
    for name, one in quantities.items():
        for reason, count in one["reasons"].items():
            found.setdefault(reason, {})[name] = count
    items = tuple(
        f"{reason}: " + ", ".join(f"{name} ({count} times)" for name, count in names.items())
        for reason, names in found.items()
    )
    return Text("Why estimates were refused:" if items else "No estimate was refused.", items)


def _share(part: int, whole_: int) -> str:
    return number(100.0 * part / whole_, 3) if whole_ else "–"
