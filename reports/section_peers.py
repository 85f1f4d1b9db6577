"""The report's section that puts wrinklebench beside other programs, from what `peers/compare.py` left."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from reports import figures_peers as figures
from reports.content import Block, Drawing, Section, Table, Text
from reports.measured import read_document
from reports.style import number, whole

FILE = "peers.json"
OURS = ("wrinklebench", "wrinklebench, limit", "wrinklebench, quarter", "wrinklebench, quarter, limit")
TARGETS = (1e-2, 1e-3, 1e-4, 1e-5)
HOWS = {
    "wrinklebench": "finite differences, relaxed and finished",
    "wrinklebench, limit": "the same runs; where the values on their nested meshes lead, as their results give it",
    "wrinklebench, quarter": "the same on a quarter of the sheet; the whole one is examined after the run",
    "wrinklebench, quarter, limit": "the limits of these",
    "ngsolve": "cubic elements, energy differentiated symbolically and compiled; plate by Hellan, Herrmann and Johnson",
    "dolfinx": "biquadratic elements, energy in UFL; plate with interior penalties",
    "felupe": "biquadratic elements, stress and elasticity written out; quadratic bricks in place of a plate",
    "calculix": "quadratic shells, which it expands to bricks",
}
Document = Mapping[str, Any]


def read_peers(folder: Path) -> Document | None:
    """The comparison, or None if it was not made."""
    return read_document(folder / FILE)


def build(document: Document | None) -> Section:
    """Assemble the section; without a comparison it says how to make one."""
    title = "Beside other programs"
    if document is None:
        text = "No comparison was made: `tests/benchmarks/peers/compare.py` does, where other programs are installed."
        return Section("peers", title, [Text(text)])
    return Section("peers", title, _blocks(document))


def _blocks(document: Document) -> list[Block]:
    runs = document["runs"]
    problems = list(dict.fromkeys(run["problem"] for run in runs))
    references = {r["problem"]: r["how"] for r in document["references"]}
    hows = "; ".join(f"{problem}: {how}" for problem, how in references.items())
    drawing = Drawing(
        "peers",
        "The same problems by several programs",
        "Largest relative error (annulus: energy and torque; hole: energy and pull; stretch: rms height of wrinkles)"
        " against CPU seconds of assembling and solving, one thread; meshing, compilation and start-up are left out for"
        f" all. Crosses: no answer. References: {hows}. The plates of the others start from waves of nearly the right"
        " length and height, ours from noise.",
        "Errors falling with CPU time for several programs on three problems.",
        partial(figures.side_by_side, runs=runs, problems=problems),
        3.0,
    )
    left = tuple(f"{what}: {why}" for what, why in document["omitted"].items())
    return [drawing, _equal_errors(runs, problems), _table(runs), _failures(runs), Text("Left out:", left)]


def time_to(runs: Sequence[Mapping[str, Any]], peer: str, problem: str, target: float) -> float:
    """CPU seconds of a peer's cheapest run from which on, on finer meshes, its error stays below the target; or nan."""
    mine = [r for r in runs if (r["peer"], r["problem"]) == (peer, problem) and "error" in r]
    mine.sort(key=lambda run: run["unknowns"])
    lasting = [
        run["cpu_seconds"]
        for k, run in enumerate(mine)
        if all(finer["error"] <= target for finer in mine[k:])
    ]
    return min(lasting, default=math.nan)


def _equal_errors(runs: Sequence[Mapping[str, Any]], problems: Sequence[str]) -> Table:
    peers = list(dict.fromkeys(run["peer"] for run in runs))
    rows = []
    for problem in problems:
        for target in TARGETS:
            times = {peer: time_to(runs, peer, problem, target) for peer in peers}
            if all(math.isnan(seconds) for seconds in times.values()):
                continue
            others = [s for peer, s in times.items() if peer not in OURS and not math.isnan(s)]
            fastest = min(others, default=math.nan)
            cells = (number(times[peer], 3) for peer in peers)
            ours = min(
                (times[peer] for peer in OURS if not math.isnan(times.get(peer, math.nan))), default=math.nan
            )
            ratios = number(times.get(OURS[0], math.nan) / fastest, 2), number(ours / fastest, 2)
            rows.append((problem, number(100.0 * target, 1), *cells, *ratios))
    caption = (
        "CPU seconds to equal error; the last columns are ours, and our fastest road, over the fastest other."
    )
    columns = ("problem", "error (%)", *peers, "ratio (–)", "ratio of our fastest (–)")
    return Table(caption, columns, tuple(rows), wide=(0,))


def _table(runs: Sequence[Mapping[str, Any]]) -> Table:
    rows = []
    for peer in dict.fromkeys(run["peer"] for run in runs):
        for problem in dict.fromkeys(run["problem"] for run in runs if run["peer"] == peer):
            mine = [r for r in runs if (r["peer"], r["problem"]) == (peer, problem)]
            good = [run for run in mine if run["status"] == "converged"]
            last = good[-1] if good else None
            version = " ".join(last["versions"].values()) if last else "–"
            rows.append(
                (
                    peer,
                    version,
                    problem,
                    HOWS.get(peer, ""),
                    whole(mine[0]["lines"]),
                    f"{len(good)} of {len(mine)}",
                    whole(last["unknowns"]) if last else "–",
                    number(last["cpu_seconds"], 3) if last else "–",
                    number(last["process_cpu_seconds"], 3) if last else "–",
                    number(last["memory_MB"], 3) if last else "–",
                )
            )
    columns = (
        *("program", "version", "problem", "how", "lines to write", "answers", "unknowns"),
        *("CPU (s)", "whole process, CPU (s)", "memory (MB)"),
    )
    caption = "What each program took on its finest mesh with an answer; lines are statements, or of our scene file."
    return Table(caption, columns, tuple(rows), wide=(1, 3))


def _failures(runs: Sequence[Mapping[str, Any]]) -> Text:
    items = tuple(
        f"{run['peer']}, {run['problem']}, mesh {run['mesh']}: {' '.join(run['message'].split())}"
        for run in runs
        if run["status"] != "converged"
    )
    return Text("Runs without an answer:" if items else "Every run found an answer.", items)
