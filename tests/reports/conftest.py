"""One set of made-up result folders, and the report made from it, for all tests of this folder."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fdsolver.result import Status
from reports.build import build_report, read_results
from reports.command import note_refusal
from reports.content import Report
from reports.page import render_page
from reports.plan import report_runs
from reports.plan_sheets import pull
from reports.run import ReportRun
from reports.stored import Stored
from tests.reports.synthetic import write_synthetic
from tests.reports.synthetic_buckling import write_synthetic_buckling
from tests.reports.synthetic_postbuckling import write_synthetic_postbuckling

HOSTILE = "<script>alert('x')</script> & \"quotes\" $x_1$"
REFUSED, STALLED, MISSING, HOSTILE_RUN = (
    "hole-membrane",
    "annulus-koiter-resolved",
    "stretch-membrane",
    "stretch-koiter",
)
BENCHMARKS = {
    "runs": [
        {
            "name": "test_annulus::test_stretch",
            "title": "Annulus against its <closed> form",
            "status": "failed",
            "message": "beyond the limit",
            "seconds": 12.5,
            "cpu_seconds": 11.0,
            "finished": "2026-01-01T00:00:00+00:00",
            "folders": [],
            "quantities": [
                {
                    "quantity": "error of the torque",
                    "value": 3.1e-4,
                    "unit": "",
                    "requirement": "at most 0.0003",
                    "reason": "second order at this mesh",
                    "holds": False,
                }
            ],
        }
    ]
}


DRAWN_PULLS = (2.0, 4.0, 5.0, 10.0, 20.0, 30.0)  # of the others there is no result


def is_left_out(run: ReportRun) -> bool:
    """Whether the made-up report has no result of a run: the one named above, and many pulls of the strip."""
    pulls = {str(overrides) for overrides in map(pull, DRAWN_PULLS)}
    load = str({key: value for key, value in run.overrides.items() if "move" in key})
    return run.name == MISSING or (
        run.scene == "stretch" and run.part in ("sweep", "flat") and load not in pulls
    )


def nodes_of(run: ReportRun) -> int:
    """Few nodes; the meshes of one scene still differ."""
    fewer = {"sweep": 2, "flat": 2, "seeds": 2, "mesh": 2, "scan": 2, "published": 2}.get(
        run.part, 10
    )  # parts whose wrinkles are measured
    return 3000 if run.name == STALLED else max(400, (run.nodes_quick or 0) // fewer)


@pytest.fixture(scope="session")
def results_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of the quick report, one refused, one stalled, one missing, one with a hostile title."""
    folder = tmp_path_factory.mktemp("results")
    for run in report_runs():
        if run.name == REFUSED:
            note_refusal(folder / run.name, "refused", f"No mesh for {HOSTILE}")
        elif run.method == "buckling":
            write_synthetic_buckling(folder / run.name, run, max(400, (run.nodes_quick or 0) // 2))
        elif run.method == "postbuckling":
            write_synthetic_postbuckling(folder / run.name, run, max(400, (run.nodes_quick or 0) // 6))
        elif not is_left_out(run):
            status = Status.STALLED if run.name == STALLED else Status.CONVERGED
            title = HOSTILE if run.name == HOSTILE_RUN else None
            write_synthetic(folder / run.name, run, nodes_of(run), status, title)
    (folder / "benchmarks.json").write_text(json.dumps(BENCHMARKS), encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def results(results_folder: Path) -> dict[str, Stored]:
    return read_results(report_runs(), results_folder)


@pytest.fixture(scope="session")
def report(results: dict[str, Stored], results_folder: Path) -> Report:
    return build_report(results, False, results_folder / "benchmarks.json")


@pytest.fixture(scope="session")
def page(report: Report) -> str:
    return render_page(report)
