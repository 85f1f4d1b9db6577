"""What the finite elements take against their unknowns with each direct solver, as the verification measured it."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from reports import figures_element_cost as figures
from reports.content import Block, Drawing, Table, Text
from reports.style import number, whole

FILE = "finite-element-cost.csv"
METHODS = {"buckling": "quintic triangles of the buckling factors", "postbuckling": "bicubic rectangles"}
SOLVERS = {"superlu": "SuperLU", "pardiso": "PARDISO"}
DEFAULT, OPTIONAL = SOLVERS
NUMBERS = (
    "vertices",
    "unknowns",
    "assemble_s",
    "factorise_s",
    "factor_entries",
    "whole_s",
    "peak_MB",
)
GAINS = {"factorise_s": "factorisation", "whole_s": "whole solve", "peak_MB": "peak memory"}


def blocks(benchmarks: Path) -> list[Block]:
    """Figure, what the optional solver saves, and table; a sentence where nothing was measured."""
    rows = read_rows(benchmarks / FILE)
    if not rows:
        return [Text("Seconds and memory of the finite elements were not measured beside this report.")]
    return [_drawing(rows), gain_words(rows), cost_table(rows)]


def read_rows(path: Path) -> list[figures.Row]:
    """Rows of the measurement; [] without a file. Numbers that were not measured are NaN."""
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        found = list(csv.DictReader(file))
    return [
        figures.Row(row["method"], row["solver"], {name: float(row[name] or "nan") for name in NUMBERS})
        for row in found
    ]


def _drawing(rows: Sequence[figures.Row]) -> Drawing:
    return Drawing(
        "finite-element-cost",
        "What the finite elements take",
        "CPU seconds of one thread and memory against the unknowns: (a) assembly of the Hessian and one factorisation "
        "of it, (b) whole solves with their coarser meshes, (c) peak memory of a process that does one solve. "
        "PARDISO: the extra `fast`. Both direct solvers count inertia, so that either certifies the same.",
        "Straight rising lines in logarithmic scales: seconds of parts and of whole solves, and memory.",
        partial(figures.cost, rows=rows, solvers=SOLVERS),
        3.0,
    )


def gain_words(rows: Sequence[figures.Row]) -> Text:
    """How much the optional solver saves on the largest meshes that both have solved."""
    items = []
    for method, words in METHODS.items():
        both = _largest_of_both([row for row in rows if row.method == method])
        if both:
            saved = ", ".join(
                f"{name} {number(both[DEFAULT].values[key] / both[OPTIONAL].values[key], 2)} times"
                for key, name in GAINS.items()
            )
            items.append(f"{words}, {whole(both[DEFAULT].values['unknowns'])} unknowns: {saved}.")
    if not items:
        return Text("The optional direct solver was not installed where this was measured.")
    return Text(
        "What the default solver takes over what the optional one takes, on the largest mesh:", tuple(items)
    )


def _largest_of_both(rows: Sequence[figures.Row]) -> Mapping[str, figures.Row]:
    """By solver, the rows of the largest mesh that every solver has solved as a whole; empty without one."""
    meshes: dict[float, dict[str, figures.Row]] = {}
    for row in rows:
        if row.whole:
            meshes.setdefault(row.values["vertices"], {})[row.solver] = row
    both = [count for count, found in meshes.items() if set(found) == set(SOLVERS)]
    return meshes[max(both)] if both else {}


def cost_table(rows: Sequence[figures.Row]) -> Table:
    """One row per method, mesh and solver."""
    cells = tuple(
        (
            row.method,
            SOLVERS.get(row.solver, row.solver),
            whole(row.values["vertices"]),
            whole(row.values["unknowns"]),
            number(row.values["assemble_s"]),
            number(row.values["factorise_s"]),
            number(row.values["factor_entries"] / 1e6),
            number(row.values["whole_s"]),
            number(row.values["peak_MB"]),
        )
        for row in rows
    )
    columns = (
        "method",
        "direct solver",
        "vertices",
        "unknowns",
        "assembly (s)",
        "factorisation (s)",
        "entries (millions)",
        "whole solve (s)",
        "peak memory (MB)",
    )
    return Table(
        "Finite elements of the pulled strip: CPU seconds of one thread, and memory.", columns, cells
    )
