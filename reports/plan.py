"""The runs behind the report, declared as data: which scene, by which method, on how many nodes."""

from __future__ import annotations

from collections.abc import Sequence

from reports.plan_buckling import buckling_runs
from reports.plan_postbuckling import postbuckling_runs
from reports.plan_sheets import shear_runs, stretch_runs
from reports.run import ReportRun

ANNULUS_MESHES = (1250, 5000, 20000, 80000)
HOLE_5 = {"edges.top.move_mm": [0.0, 3.125, 0.0], "edges.bottom.move_mm": [0.0, -3.125, 0.0]}
SCENES = ("stretch", "shear", "hole", "annulus")  # in the order of the report; then the ladder
THINNING = {"solver.thinning": [4.0, 2.0, 1.4]}  # from 66 waves, which four times the thickness has, to 132
THICK = {"sheet.thickness_mm": 0.5}
THICKER = {"annulus-twist": THICK, "annulus-shrink": THICK}  # wrinkles that these meshes resolve
LADDER = ("annulus-lift", "annulus-twist", "annulus-shrink", "strip-tension", "shear-rails")


def _annulus_meshes() -> list[ReportRun]:
    return [
        ReportRun(f"annulus-{method}-{nodes}", "annulus", method, nodes, nodes, max_seconds=60.0)
        for nodes in ANNULUS_MESHES
        for method in ("exact", "tension-field")
    ]


def _annulus() -> list[ReportRun]:
    return [
        ReportRun("annulus-membrane-20000", "annulus", "membrane", 20000, 20000),
        ReportRun("annulus-koiter-5000", "annulus", "koiter", 5000, 5000, max_seconds=60.0),
        ReportRun("annulus-koiter-20000", "annulus", "koiter", 20000, 20000, max_seconds=90.0),
        ReportRun("annulus-koiter-120000", "annulus", "koiter", None, 120000, THINNING, max_seconds=60.0),
        ReportRun(
            "annulus-koiter-resolved",
            "annulus",
            "koiter",
            120000,
            160000,
            {"sheet.thickness_mm": 0.1},
            max_seconds=150.0,
        ),
    ]


def _hole() -> list[ReportRun]:
    return [
        ReportRun("hole-tension-field", "hole", "tension-field", 20000, 40000, max_seconds=60.0),
        ReportRun("hole-membrane", "hole", "membrane", 10000, 40000),
        ReportRun("hole-koiter", "hole", "koiter", 40000, 40000, max_seconds=120.0),
        ReportRun("hole-5-tension-field", "hole", "tension-field", 10000, 40000, HOLE_5),
        ReportRun("hole-5-koiter", "hole", "koiter", 40000, 40000, HOLE_5, max_seconds=90.0),
    ]


def _ladder() -> list[ReportRun]:
    return [
        ReportRun(
            f"{scene}-{method}",
            scene,
            method,
            12000 if scene.startswith("annulus") else 5000,
            40000,
            THICKER.get(scene, {}),
            max_seconds=60.0,
        )
        for scene in LADDER
        for method in ("exact", "tension-field", "koiter")
    ]


def report_runs(full: bool = False, scenes: Sequence[str] | None = None) -> list[ReportRun]:
    """Return the runs of the quick or full report, of the named scenes only (None: of all).

    Cheap runs and those of the paper's figures come first: if the report's time is used up, others are cut short.

    Raises ValueError for a scene that the report does not have.
    """
    runs = [
        *stretch_runs(),
        *_annulus_meshes(),
        *_hole(),
        *_ladder(),
        *buckling_runs(),
        *_annulus(),
        *shear_runs(),
        *postbuckling_runs(),
    ]
    known = {run.scene for run in runs}
    unknown = [scene for scene in scenes or () if scene not in known]
    if unknown:
        raise ValueError(f"the report has no scene {', '.join(unknown)}; it has {', '.join(sorted(known))}")
    return [run for run in runs if run.nodes(full) is not None and (scenes is None or run.scene in scenes)]
