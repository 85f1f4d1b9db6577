"""Tables of the post-buckled states: agreement with the finite differences, and what every run took."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from reports.bands import Banded
from reports.content import Table, Text
from reports.postbuckling_values import Both
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import stable

NOISE_MM = 1e-4


def agreement_words(pulls: np.ndarray, both: Sequence[Sequence[Both]]) -> Text:
    """How many quantities agree within the sum of both error bars, and which do not."""
    judged = [
        (pull, one)
        for pull, column in zip(pulls, both, strict=True)
        for one in column
        if math.isfinite(one.apart)
    ]
    beyond = [(pull, one) for pull, one in judged if abs(one.apart) > 1.0]
    if not judged:
        return Text("No pull has both methods, so nothing can be compared.")
    text = (
        f"{len(judged) - len(beyond)} of {len(judged)} quantities agree within the sum of both error bars; the largest "
        f"difference is {number(max(abs(one.apart) for _, one in judged), 2)} of that sum."
    )
    items = tuple(
        f"{one.quantity.name} at {pull:g} %: finite elements {_with_error(one.elements)}, finite differences "
        f"{one.differences.text(4)} {one.quantity.unit}"
        for pull, one in beyond
    )
    return Text(f"{text} Beyond it:" if items else text, items)


def agreement_table(pulls: np.ndarray, both: Sequence[Sequence[Both]]) -> Table:
    """Every quantity at every pull by both methods, with their errors."""
    rows: list[tuple[str, ...]] = []
    for pull, column in zip(pulls, both, strict=True):
        if all(is_flat(one) for one in column[:2]):
            rows.append((f"{pull:g}", "no wrinkles by either method", *["–"] * 5))
        else:
            rows += [_agreement_row(float(pull), one) for one in column]
    columns = (
        "pull (%)",
        "quantity",
        "unit",
        "finite elements",
        "finite differences",
        "difference (%)",
        "over both bars (–)",
    )
    return Table(
        "The strip by finite elements (finest mesh ± estimated error) and by finite differences (limit ± band).",
        columns,
        tuple(rows),
    )


def is_flat(one: Both) -> bool:
    """Whether both methods have nothing but what a start leaves of its noise, a thousandth of a thickness."""
    return one.elements.finest == 0.0 and abs(one.differences.finest) < NOISE_MM


def _agreement_row(pull: float, one: Both) -> tuple[str, ...]:
    ours, theirs = one.elements.finest, one.differences.value
    return (
        f"{pull:g}",
        one.quantity.name,
        one.quantity.unit,
        _with_error(one.elements),
        one.differences.text(4),
        number(100.0 * (ours / theirs - 1.0), 2) if ours and theirs else "–",
        number(one.apart, 2),
    )


def _with_error(value: Banded) -> str:
    if math.isnan(value.error):
        return number(value.finest, 5)
    return f"{number(value.finest, 5)} ± {number(value.error, 2)}"


def run_table(runs: Sequence[Stored]) -> Table:
    """Size, cost and end of every finite-element run; of the annulus by finite differences too."""
    rows = []
    for run in runs:
        levels = run.result.get("levels")
        level = levels[-1] if isinstance(levels, list) and levels else {}
        rows.append(
            (
                run.run.name,
                whole(run.value("nodes")),
                whole(float(level.get("unknowns", math.nan))),
                whole(run.value("steps")),
                run.status.replace("_", " "),
                number(run.value("residual"), 2),
                stable(run),
                number(run.value("stability", "lowest"), 2),
                number(run.value("cpu_seconds"), 3),
                number(run.value("peak_memory_MB"), 3),
            )
        )
    columns = (
        "run",
        "nodes",
        "unknowns",
        "steps",
        "status",
        "residual (–)",
        "stable",
        "lowest eigenvalue",
        "CPU (s)",
        "peak memory (MB)",
    )
    caption = (
        "Runs of this section. Unknowns: of the part between the planes of symmetry. Steps: of Newton's method on all "
        "meshes, of relaxation for koiter. Lowest eigenvalue, of the whole sheet: N/mm³ by elements, relative by "
        "differences. Peak memory is that of the whole process so far."
    )
    return Table(caption, columns, tuple(rows))
