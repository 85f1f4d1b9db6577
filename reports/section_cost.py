"""The report's section on what accuracy costs: one page per scene that `wrinkle cost` has measured."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from reports import figures_cost as figures
from reports.content import Block, Drawing, Section, Table, Text
from reports.measured import read_document
from reports.style import number, whole

DRAWN = 2  # quantities per scene; the table has the best runs of these
# what a reader asks for first: a height of wrinkles, then the energy, then loads
WANTED = ("sections.midsection.rms_mm", "energy_N_mm.total", "moment_N_mm.z", "force_N", "factor", "rms_mm")
WORDS = {
    "energy_N_mm.total": "energy",
    "energy_N_mm.bending": "energy of bending",
    "stretch.major_max": "largest stretch",
    "stretch.major_min": "smallest major stretch",
    "out_of_plane_mm.rms": "rms height",
    "buckling.critical.0.factor": "first buckling factor",
}
PARTS = {"force_N": "force", "moment_N_mm": "moment", "rms_mm": "rms height", "amplitude_mm": "amplitude"}
LONGEST_TABLE = 6  # runs of each model
Document = Mapping[str, Any]


def read_costs(folder: Path) -> dict[str, Document]:
    """Scene -> cost.json of every `SCENE-cost` in a folder; a damaged one is left out."""
    found: dict[str, Document] = {}
    for path in sorted(folder.glob("*-cost/cost.json")):
        document = read_document(path)
        if isinstance(document, dict) and "scene" in document:
            found[str(document["scene"])] = document
    return found


def build(costs: Mapping[str, Document]) -> Section:
    """Assemble the section; without measurements it says how to make them."""
    blocks: list[Block] = []
    everywhere = _left_everywhere(costs)
    for scene, document in costs.items():
        blocks += _scene(scene, document, everywhere)
    if everywhere:
        blocks.append(Text("Left out on every scene:", items=_items(everywhere)))
    if not blocks:
        blocks = [Text("Nothing was measured yet: `wrinkle cost SCENE` does, and the next report shows it.")]
    return Section("cost", "What accuracy costs", blocks)


def _left_everywhere(costs: Mapping[str, Document]) -> dict[str, str]:
    """What all of several scenes leave out for the same reason."""
    left = [document["omitted"] for document in costs.values()]
    return (
        {what: why for what, why in left[0].items() if all(other.get(what) == why for other in left)}
        if len(left) > 1
        else {}
    )


def _items(left: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(f"{what}: {why}" for what, why in left.items())


def _scene(scene: str, document: Document, everywhere: Mapping[str, str]) -> list[Block]:
    quantities = chosen_quantities(document)
    said = [
        sentence.replace(q, f"the {words(q)}")
        for q in quantities
        for sentence in document["sentences"]
        if f" {q} of" in sentence
    ]
    blocks: list[Block] = [
        Text(f"{scene}: the cheapest way to an accuracy, single thread.", items=tuple(said))
    ]
    if quantities:
        blocks += [_drawing(scene, document, quantities)]
        blocks += [_table(scene, document, quantity) for quantity in quantities[:1]]
    blocks.append(_failures(scene, document["rows"]))
    left = _items({what: why for what, why in document["omitted"].items() if what not in everywhere})
    machine = document["machine"]
    blocks.append(
        Text(
            f"Left out on {scene}; measured on {machine['processor']}, {machine['cores']} cores:", items=left
        )
    )
    return blocks


def words(quantity: str) -> str:
    """A quantity's dotted key as a reader would say it."""
    match quantity.split("."):
        case ["reactions", edge, kind, axis]:
            return f"{PARTS[kind]} of the edge {edge} along {axis}"
        case ["sections", line, kind]:
            return f"{PARTS.get(kind, kind.removesuffix('_mm'))} on {line}"
    return WORDS.get(quantity, quantity)


def chosen_quantities(document: Document) -> list[str]:
    """The quantities that a reader asks for first, of those that have errors of converged runs."""
    fronts = document["pareto"].items()
    names = [name for name, models in fronts if any(len(front) > 1 for front in models.values())]
    ranked = sorted(names, key=lambda name: next((k for k, w in enumerate(WANTED) if w in name), len(WANTED)))
    return ranked[:DRAWN]


def _drawing(scene: str, document: Document, quantities: Sequence[str]) -> Drawing:
    references = {
        (r["model"], r["quantity"]): r["how"] for r in document["references"] if r["quantity"] in quantities
    }
    hows = "; ".join(sorted({f"{model}: {how}" for (model, _), how in references.items()}))
    return Drawing(
        f"cost-{scene}",
        f"Work and precision, {scene}",
        f"Error of the {' and of the '.join(map(words, quantities))} against CPU time without compilation. Lines join"
        " meshes of one method,"
        " dots are other ways to iterate, bars the spread of repeats, crosses above the frame runs without an answer;"
        " grey lines join, for each model, the runs that no other beats in time and in the largest error of their own"
        f" and all finer meshes. References: {hows}.",
        f"Errors falling with CPU time for the methods of the scene {scene}.",
        partial(
            figures.work_precision,
            rows=document["rows"],
            titles={quantity: words(quantity) for quantity in quantities},
            fronts=document["pareto"],
        ),
        3.0,
    )


def _table(scene: str, document: Document, quantity: str) -> Table:
    rows = {row["folder"]: row for row in document["rows"]}
    names = [name for front in document["pareto"][quantity].values() for name in front[-LONGEST_TABLE:]]
    front = [rows[name] for name in names]
    cells = tuple(
        (
            row["method"] + (f", {row['option']}" if row["option"] else ""),
            whole(row["nodes"]),
            number(100.0 * row[f"error.{quantity}"], 2),
            f"{number(row['cpu_seconds'], 3)} ({number(row['cpu_seconds_least'], 2)} to"
            f" {number(row['cpu_seconds_largest'], 2)})",
            number(row["seconds"], 3),
            whole(_or_nan(row["force_evaluations"])),
            number(_or_nan(row["seconds_compile"]), 2),
            number(_or_nan(row["peak_memory_MB"]), 3),
        )
        for row in front
    )
    return Table(
        f"Runs on {scene} that none of their model beats in CPU time and in the error that lasts on finer meshes: error"
        f" of the {words(quantity)}, median and spread of the CPU time.",
        (
            *("method", "nodes", "error (%)", "CPU (s)", "wall (s)"),
            *("force evaluations", "compilation (s)", "memory (MB)"),
        ),
        cells,
        wide=(0,),
    )


def _failures(scene: str, rows: Sequence[Mapping[str, Any]]) -> Text:
    failed = [row for row in rows if row["status"] != "converged"]
    if not failed:
        return Text(f"Every run on {scene} converged.")
    items = tuple(
        f"{row['method']}{', ' + row['option'] if row['option'] else ''}, {row['nodes_asked']} nodes: "
        f"{row['status'].replace('_', ' ')}. {row['message']}"
        for row in failed
    )
    return Text(f"Runs on {scene} without an answer:", items=items)


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else float(value)
