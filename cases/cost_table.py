"""The table of `wrinkle cost`: what each run cost, how wrong it is, which are worth their time, and what to say."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cases.cost_plan import CostRun
from cases.cost_reference import MODELS, Reference, quantities_of, references
from cases.methods import METHODS
from cases.study_table import result_of

TARGETS = (0.1, 0.01, 0.001, 1e-4)
WORTH = 0.9  # of the error before: a smaller gain is no reason to pay more
COSTS = ("cpu_seconds", "seconds")
UNITS = ("_mm", "_N", "_N_mm")


@dataclass(frozen=True)
class Measured:
    """One run and its repeats.

    status, message : of the result, or why there is none. costs : name -> (median, least, largest) seconds.
    numbers : nodes, steps, force evaluations, compile time, memory. values : quantities. errors : relative.
    """

    run: CostRun
    status: str
    message: str
    repeats: int
    costs: Mapping[str, tuple[float, float, float]]
    numbers: Mapping[str, float | None]
    values: Mapping[str, float]
    errors: Mapping[str, float]

    @property
    def converged(self) -> bool:
        """Whether its errors mean anything."""
        return self.status == "converged"


def measure(
    runs: Sequence[tuple[CostRun, Sequence[CostRun]]], out: Path, thickness_mm: float
) -> tuple[list[Measured], list[Reference]]:
    """All runs with their repeats, measured against references that are found among them.

    runs : pairs of a run and its repeats, results in `out`. thickness_mm : of the sheet.
    """
    raw = [_read(run, repeats, out, thickness_mm) for run, repeats in runs]
    series: dict[str, list[tuple[int, Mapping[str, float]]]] = {}
    for one in raw:
        if one.converged and not one.run.option:
            series.setdefault(one.run.point.method, []).append((int(one.numbers["nodes"] or 0), one.values))
    found = references({method: sorted(rows, key=lambda row: row[0]) for method, rows in series.items()})
    known = {(reference.model, reference.quantity): reference for reference in found}
    return [_with_errors(one, known) for one in raw], found


def _read(run: CostRun, repeats: Sequence[CostRun], out: Path, thickness_mm: float) -> Measured:
    document = result_of(run.point, out)
    documents = [document, *(result_of(again.point, out) for again in repeats)]
    documents = [one for one in documents if "cpu_seconds" in one]
    costs = {}
    for name in COSTS if documents else ():
        seconds = [float(one[name]) for one in documents]
        costs[name] = (statistics.median(seconds), min(seconds), max(seconds))
    keys = ("nodes", "steps", "force_evaluations", "seconds_compile", "peak_memory_MB", "residual")
    numbers = {key: document.get(key) for key in keys}
    values = quantities_of(document, thickness_mm) if documents else {}
    status, message = str(document["status"]), str(document["message"])
    return Measured(run, status, message, len(documents), costs, numbers, values, {})


def _with_errors(one: Measured, known: Mapping[tuple[str, str], Reference]) -> Measured:
    """The run with its relative errors; of its own model, where there is a reference."""
    model = MODELS[one.run.point.method]
    errors = {
        name: abs(value - known[model, name].value) / abs(known[model, name].value)
        for name, value in one.values.items()
        if (model, name) in known
    }
    return Measured(one.run, one.status, one.message, one.repeats, one.costs, one.numbers, one.values, errors)


def lasting_error(rows: Sequence[Measured], one: Measured, quantity: str) -> float:
    """The largest error of a run and of all finer meshes of its method, by the same option or the scene's own.

    An error that happens to pass through zero on one mesh is no accuracy.
    """
    nodes = one.numbers["nodes"] or 0
    finer = [
        other
        for other in rows
        if other.run.point.method == one.run.point.method
        and (
            other.run.option == one.run.option
            or (not other.run.option and (other.numbers["nodes"] or 0) > nodes)
        )
        and (other.numbers["nodes"] or 0) >= nodes
        and other.converged
    ]
    return max((other.errors.get(quantity, math.inf) for other in finer), default=math.inf)


def pareto(rows: Sequence[Measured], quantity: str, cost: str = "cpu_seconds") -> list[Measured]:
    """The converged runs that no cheaper one equals in lasting error, up to a tenth, cheapest first."""
    ready = [
        one for one in rows if one.converged and quantity in one.errors and one.run.point.method != "exact"
    ]
    lasting = [(one.costs[cost][0], lasting_error(rows, one, quantity), k) for k, one in enumerate(ready)]
    front: list[Measured] = []
    best = math.inf
    for _, error, k in sorted(lasting):
        if error < WORTH * best:
            front.append(ready[k])
            best = error
    return front


def fronts(rows: Sequence[Measured], quantity: str) -> dict[str, list[Measured]]:
    """The front of each model: an error is a difference within the model's own equations."""
    models = dict.fromkeys(MODELS[one.run.point.method] for one in rows)
    mine = {model: [one for one in rows if MODELS[one.run.point.method] == model] for model in models}
    found = {model: pareto(some, quantity) for model, some in mine.items()}
    return {model: front for model, front in found.items() if front}


def cheapest(rows: Sequence[Measured], model: str, quantity: str, target: float) -> Measured | None:
    """The cheapest run of a model whose lasting error is below the target."""
    good = [
        one for one in fronts(rows, quantity).get(model, []) if lasting_error(rows, one, quantity) <= target
    ]
    return good[0] if good else None


def sentences(rows: Sequence[Measured], found: Sequence[Reference]) -> list[str]:
    """What a user wants to know: for each quantity and target, the cheapest way.

    A run that is the cheapest way to several targets is named with the smallest.
    """
    said = []
    for reference in found:
        ways: dict[str, tuple[Measured, float]] = {}
        for target in TARGETS:
            if reference.uncertainty > 0.5 * target * abs(reference.value):
                break  # the reference itself is not known that well
            best = cheapest(rows, reference.model, reference.quantity, target)
            if best is not None:
                ways[best.run.point.name] = best, target
        said += [_sentence(best, reference, target) for best, target in ways.values()]
    return said


def _sentence(best: Measured, reference: Reference, target: float) -> str:
    option = f" ({best.run.option})" if best.run.option else ""
    median, least, largest = best.costs["cpu_seconds"]
    spread = f" ({least:.2g} to {largest:.2g})" if best.repeats > 1 else ""
    nodes = f"{int(best.numbers['nodes'] or 0):,}".replace(",", " ")
    return (
        f"{100.0 * target:g} % in {reference.quantity} of the {reference.model}:"
        f" {METHODS[best.run.point.method].title}{option} on {nodes} nodes, {median:.2g} s{spread}."
    )


def as_row(one: Measured) -> dict[str, Any]:
    """The run as a row of cost.csv."""
    row: dict[str, Any] = {"method": one.run.point.method, "option": one.run.option, "status": one.status}
    row |= {"nodes_asked": one.run.point.nodes, **one.numbers, "repeats": one.repeats}
    for name in COSTS:
        median, least, largest = one.costs.get(name, (None, None, None))
        row |= {name: median, f"{name}_least": least, f"{name}_largest": largest}
    row |= {f"value.{name}": value for name, value in one.values.items()}
    row |= {f"error.{name}": error for name, error in one.errors.items()}
    return {**row, "folder": one.run.point.name, "message": one.message}
