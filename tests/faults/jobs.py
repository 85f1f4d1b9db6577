"""The runs, studies and reports that the campaign kills: small ones, of every way in which a solve is stored."""

from __future__ import annotations

from pathlib import Path

import reports.command
from cases import load_result, load_scene, run
from cases.results import CHECKPOINT_NAME
from cases.study import run_study
from cases.study_file import load_study
from fdsolver import multilevel
from reports.run import ReportRun
from tests.faults.kills import Job

SAVE_SECONDS = 0.02  # between two checkpoints: small runs need more of them than large ones
RUNS = (
    ("hole", "koiter", 1600, {"solver.levels": 2}),
    ("annulus", "tension-field", 900, {"symmetry.reduce": "none"}),
    ("stretch", "koiter", 600, {"solver.snapshots": 6, "solver.damping": "kinetic"}),
    ("shear", "membrane", 600, {}),
)
REPORTED = (
    ReportRun("strip", "strip-tension", "tension-field", 400, 400),
    ReportRun("hole", "hole", "koiter", 400, 400),
    ReportRun("annulus", "annulus", "tension-field", 900, 900),
)
STUDY = '[study]\nscene = "hole"\nmethods = ["koiter", "tension-field"]\nnodes = [400, 600]\n'


def checkpoints_often() -> None:
    """Let every solve of this process and its copies save its state often."""
    multilevel.SAVE_SECONDS = SAVE_SECONDS


def whole_result(folder: Path) -> None:
    """A result folder is absent, unfinished or whole."""
    if (folder / "result.json").exists():
        load_result(folder)
    for path in folder.glob(CHECKPOINT_NAME):
        assert path.stat().st_size > 0, "an empty checkpoint"


def run_job(scene: str, method: str, nodes: int, changes: dict[str, object]) -> Job:
    """One solve into one folder."""

    def work(folder: Path) -> None:
        run(load_scene(scene, changes), method, nodes=nodes, seed=1, out=folder / "result")

    return Job(
        f"run {scene} {method} {nodes}", work, ("result",), lambda folder: whole_result(folder / "result")
    )


def report_job() -> Job:
    """A report of three small solves, page and PDF."""

    def work(folder: Path) -> None:
        reports.command.report_runs = lambda full, scenes=None: REPORTED
        reports.command.report(folder, results=folder / "no benchmarks", processes=2)

    def sound(folder: Path) -> None:
        for name in names:
            whole_result(folder / name)
        page, pdf = folder / "index.html", folder / "report.pdf"
        assert not page.exists() or page.read_text().rstrip().endswith("</html>"), "half a page"
        assert not pdf.exists() or pdf.read_bytes().rstrip().endswith(b"%%EOF"), "half a PDF"

    names = tuple(f"{reports.command.RESULTS}/quick/{each.name}" for each in REPORTED)
    return Job("report of 3 runs", work, names, sound)


def study_job(folder: Path) -> Job:
    """A study of four points, two processes at a time; a point whose process was killed is begun by the next study."""
    file = folder / "killed.toml"
    file.write_text(STUDY, encoding="utf-8")
    study = load_study(file)

    def work(folder: Path) -> None:
        run_study(study, folder, jobs=2)

    def sound(folder: Path) -> None:
        for name in names:
            whole_result(folder / name)

    names = tuple(point.name for point in study.points)
    return Job(f"study of {len(names)} points", work, names, sound, of_workers=True)
