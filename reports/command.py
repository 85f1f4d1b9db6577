"""`wrinkle report`: run what is missing, then render.  The two steps share nothing but the result folders."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from reports.plan import FAILED_STARTS, ReportRun, report_runs

RESULTS = "results"
BENCHMARKS = Path("runs") / "benchmark"
FULL_REPORT_PATIENCE = 10.0  # times the quick report's limit of each run


def report(
    out: Path,
    full: bool = False,
    scenes: Sequence[str] | None = None,
    results: Path | None = None,
    progress: Callable[[Any], None] | None = None,
) -> int:
    """Run the planned cases that have no result yet, then write `index.html` and `report.pdf` into `out`.

    out : folder of the report; the runs' result folders are in `out/results`.
    full : the paper's node counts instead of the quick ones.
    scenes : only these; None for all.
    results : folder of the verification runs (`benchmarks.json`), by default `runs/benchmark`.
    progress : called by the running solver, as by `cases.run`.

    Returns 0 when finished, whatever the single runs' statuses, which the report shows.
    Raises ValueError for a scene that the report does not have.
    """
    runs = report_runs(full, scenes)
    started = time.perf_counter()
    run_cases(runs, out / RESULTS, full, progress)
    print(f"{len(runs)} runs after {time.perf_counter() - started:.0f} s; drawing", file=sys.stderr)
    render(out, runs, full, (results or BENCHMARKS) / "benchmarks.json")
    print(f"{out / 'index.html'}\n{out / 'report.pdf'}")
    return 0


def render(out: Path, runs: Sequence[ReportRun], full: bool, benchmarks: Path) -> None:
    """Write the page and the PDF from the result folders in `out/results`, solving nothing."""
    from reports.build import build_report, read_results
    from reports.page import write_page
    from reports.pdf import write_pdf

    content = build_report(read_results(runs, out / RESULTS), full, benchmarks)
    write_page(content, out / "index.html")
    write_pdf(content, out / "report.pdf")


def run_cases(
    runs: Sequence[ReportRun], folder: Path, full: bool, progress: Callable[[Any], None] | None = None
) -> None:
    """Solve every planned case into its own result folder; a result of the same scene and nodes is kept."""
    for k, run in enumerate(runs, start=1):
        print(f"[{k}/{len(runs)}] {run.name}", file=sys.stderr, flush=True)
        run_case(run, folder / run.name, full, progress)


def run_case(run: ReportRun, folder: Path, full: bool, progress: Callable[[Any], None] | None = None) -> None:
    """Solve one case; what it refuses is noted in its folder, in the refusal's own words."""
    import cases

    limit = run.max_seconds * (FULL_REPORT_PATIENCE if full else 1.0)
    overrides = {**run.overrides, "solver.max_seconds": limit}
    try:
        scene = cases.load_scene(run.scene, overrides)
        cases.run(
            scene,
            run.method,
            nodes=run.nodes(full) or None,
            threads=min(2, os.cpu_count() or 1),
            out=folder,
            resume=True,
            progress=progress,
        )
    except (ValueError, RuntimeError, ArithmeticError, MemoryError) as refusal:
        note_refusal(folder, str(refusal) or type(refusal).__name__)


def note_refusal(folder: Path, message: str) -> None:
    """Leave the reason why a case did not start, unless an earlier result is there."""
    if (folder / "result.json").exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    unfinished = folder / f"{FAILED_STARTS}.part"
    unfinished.write_text(json.dumps({"status": "refused", "message": message}), encoding="utf-8")
    unfinished.replace(folder / FAILED_STARTS)
