"""`wrinkle report`: run what is missing, then render.  The two steps share nothing but the result folders."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from fdsolver.checkpoint import make_folder, write_atomically
from reports.plan import report_runs
from reports.run import ReportRun
from reports.side_by_side import solve_side_by_side
from reports.stored import refusal_path

WAVE_HEIGHT = 10.0  # of imposed waves, in thicknesses: about as high as the sheet's own
RESULTS = "results"
BENCHMARKS = Path("runs") / "benchmark"
PROCESSES = 2  # side by side: the time that a report may take is that of two cores
FULL_PATIENCE = 10.0  # a run of the full report has this many times the quick report's limit
# What is left of the ten (sixty) minutes that a report may take is for drawing and for the last run's excess.
QUICK_SECONDS, FULL_SECONDS = 450.0, 3200.0


def report(
    out: Path,
    full: bool = False,
    scenes: Sequence[str] | None = None,
    results: Path | None = None,
    progress: Callable[[Any], None] | None = None,
    processes: int = 1,
) -> int:
    """Run the planned cases that have no result yet, then write `index.html` and `report.pdf` into `out`.

    out : folder of the report; the runs' result folders are in `out/results/quick` and `out/results/full`.
    full : the paper's node counts instead of the quick ones.
    scenes : only these; None for all.
    results : folder of the verification runs (`benchmarks.json`), by default `runs/benchmark`.
    progress : called by the solver that runs in this process, as by `cases.run`.
    processes : solving side by side; a script that asks for more than one has to guard its main module.

    Returns 0 when finished, whatever the single runs' statuses, which the report shows.
    Raises ValueError for a scene that the report does not have.
    """
    runs = report_runs(full, scenes)
    started = time.perf_counter()
    folder = out / RESULTS / ("full" if full else "quick")
    run_cases(runs, folder, full, progress, processes)
    print(f"{len(runs)} runs after {time.perf_counter() - started:.0f} s; drawing", file=sys.stderr)
    render(out, runs, folder, full, (results or BENCHMARKS) / "benchmarks.json")
    print(f"{out / 'index.html'}\n{out / 'report.pdf'}")
    return 0


def render(out: Path, runs: Sequence[ReportRun], folder: Path, full: bool, benchmarks: Path) -> None:
    """Write the page and the PDF from the result folders in `folder`, solving nothing."""
    from reports.build import build_report, read_results
    from reports.page import write_page
    from reports.pdf import write_pdf

    content = build_report(read_results(runs, folder), full, benchmarks)
    write_page(content, out / "index.html")
    write_pdf(content, out / "report.pdf")


def run_cases(
    runs: Sequence[ReportRun],
    folder: Path,
    full: bool,
    progress: Callable[[Any], None] | None = None,
    processes: int = 1,
) -> None:
    """Solve every planned case into its own result folder; a result of the same scene and nodes is kept.

    When the report's time is used up, what is left is noted as not run.
    """
    finish = time.monotonic() + (FULL_SECONDS if full else QUICK_SECONDS)
    solve_side_by_side(partial(_in_time, runs, folder, full, finish), len(runs), processes, progress)


def _in_time(
    runs: Sequence[ReportRun],
    folder: Path,
    full: bool,
    finish: float,
    k: int,
    progress: Callable[[Any], None] | None,
) -> None:
    """Solve case k in its own time limit or in what is left until `finish`."""
    run = runs[k]
    print(f"[{k + 1}/{len(runs)}] {run.name}", file=sys.stderr, flush=True)
    limit = min(run.max_seconds * (FULL_PATIENCE if full else 1.0), finish - time.monotonic())
    run_case(run, folder / run.name, run.nodes(full), limit, progress)


def run_case(
    run: ReportRun,
    folder: Path,
    nodes: int | None,
    max_seconds: float,
    progress: Callable[[Any], None] | None = None,
) -> None:
    """Solve one case; what it refuses is noted beside its folder, in the refusal's own words.

    max_seconds : limit of this solve; none is begun with less than a second.

    Raises KeyboardInterrupt if the solve was interrupted; it can go on with the next report.
    """
    if max_seconds < 1.0 and not (folder / "result.json").exists():
        note_refusal(folder, "not run", "The time of the report was used up before this run began.")
        return
    try:
        status = _solve(run, folder, nodes, max(max_seconds, 1.0), progress)
    except (ValueError, RuntimeError, ArithmeticError, MemoryError) as refusal:
        note_refusal(folder, "refused", str(refusal) or type(refusal).__name__)
        return
    if status == "interrupted":
        raise KeyboardInterrupt
    refusal_path(folder).unlink(missing_ok=True)


def _solve(
    run: ReportRun,
    folder: Path,
    nodes: int | None,
    max_seconds: float,
    progress: Callable[[Any], None] | None,
) -> str:
    """The status of the solve.  A result of an older scene in the report's own folder is replaced."""
    import cases

    try:
        scene = cases.load_scene(run.scene, {**run.overrides, "solver.max_seconds": max_seconds})
    except cases.SceneError as problems:
        raise ValueError(str(problems)) from problems

    if run.kept_flat or run.imposed_mm is not None:
        return _solve_otherwise(run, scene, folder, nodes)

    def solve(force: bool) -> str:
        solution = cases.run(
            scene,
            run.method,
            nodes=nodes,
            seed=run.seed,
            threads=1,
            out=folder,
            force=force,
            progress=progress,
        )
        return str(solution.status.value)

    try:
        return solve(force=False)
    except ValueError:
        if not folder.exists():
            raise
        return solve(force=True)


def _solve_otherwise(run: ReportRun, scene: Any, folder: Path, nodes: int | None) -> str:
    """The status of a solve that no method of the command line makes: kept flat, or from imposed waves.

    A converged result of the same scene, nodes and start is kept.
    """
    from cases.methods import METHODS, with_numbers
    from cases.results import probe, read_document, write_result
    from cases.scene_text import scene_hash

    resolved = with_numbers(scene, METHODS["koiter"], nodes, None)
    identity = scene_hash(resolved, "koiter", kept_flat=run.kept_flat, imposed_mm=run.imposed_mm)
    if (folder / "result.json").exists():
        document = read_document(folder)
        if document.get("scene_hash") == identity and document["status"] == "converged":
            return "converged"
    solution = _flat(resolved) if run.imposed_mm is None else _from_waves(resolved, run.imposed_mm)
    make_folder(folder)
    write_result(folder, solution, resolved, probe(solution, resolved), {}, identity)
    return str(solution.status.value)


def _flat(scene: Any) -> Any:
    from cases.energy_gained import flat_state

    return flat_state(scene)


def _from_waves(scene: Any, half_wavelength_mm: float) -> Any:
    """The state that a start with straight waves, as high as the sheet's own, ends in."""
    from cases.boundary import grid_of
    from cases.starts import relax_from, with_waves

    grid = grid_of(scene)(scene.mesh.nodes)
    start = with_waves(scene, grid, half_wavelength_mm, WAVE_HEIGHT * scene.sheet.thickness_mm)
    return relax_from(scene, grid, start)


def note_refusal(folder: Path, status: str, message: str) -> None:
    """Leave the reason why a case has no result."""
    make_folder(folder.parent)
    text = json.dumps({"status": status, "message": message}).encode()
    write_atomically(refusal_path(folder), lambda file: file.write(text))
