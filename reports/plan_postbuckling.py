"""The runs of the post-buckled states by finite elements: the strip at several pulls, and the lifted annulus."""

from __future__ import annotations

from reports.plan_sheets import pull
from reports.run import ReportRun

PART = "postbuckling"
SHOWN_PULLS = (5.0, 10.0, 20.0)  # % of the length: profiles, convergence
QUICK_PULLS = (2.5, 3.0, *SHOWN_PULLS, 24.0)
FULL_PULLS = (4.0, 7.0, 13.0, 16.0, 22.0)
# vertices whose nested meshes are three; 0.5 % of the heights at 20 % needs the second
STRIP_QUICK, STRIP_FULL = 5329, 12000
LIFT_VERTICES = (1500, 3000)
LIFT_MESHES = ((2500, 10000), (5000, 20000), (10000, 40000))  # of finite differences, quick and full


def postbuckling_runs() -> list[ReportRun]:
    """One run at each pull, which has coarser meshes of its own, and the annulus by both methods."""
    strip = [
        ReportRun(
            f"stretch-elements-{percent:g}",
            "stretch",
            "postbuckling",
            STRIP_QUICK if percent in QUICK_PULLS else None,
            STRIP_FULL,
            pull(percent),
            60.0,
            PART,
        )
        for percent in sorted((*QUICK_PULLS, *FULL_PULLS))
    ]
    levels = {"solver.levels": 3}
    lift = [ReportRun("lift-elements", "annulus-lift", "postbuckling", *LIFT_VERTICES, levels, 60.0, PART)]
    for quick, full in LIFT_MESHES:
        lift.append(ReportRun(f"lift-koiter-{quick}", "annulus-lift", "koiter", quick, full, part=PART))
    return [*strip, *lift]
