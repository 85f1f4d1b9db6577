"""The runs of the finite-element buckling factors: the strip on two meshes and with two elements, shear and hole."""

from __future__ import annotations

from collections.abc import Mapping

from reports.run import ReportRun

PART = "buckling"
SECOND_ELEMENT = {"solver.element": "bogner-fox-schmit"}


def buckling_runs() -> list[ReportRun]:
    """Every run makes its own coarser mesh of a quarter of the vertices too, which is where its errors come from."""
    planned: tuple[tuple[str, str, int, int, Mapping[str, object]], ...] = (
        ("stretch-buckling-600", "stretch", 600, 1400, {}),
        ("stretch-buckling-1200", "stretch", 1200, 2800, {}),
        ("stretch-buckling-rectangles", "stretch", 1400, 5600, SECOND_ELEMENT),
        ("shear-buckling", "shear", 1500, 6000, {}),
        ("hole-buckling", "hole", 1500, 4000, {}),
    )
    return [
        ReportRun(name, scene, "buckling", quick, full, changes, part=PART)
        for name, scene, quick, full, changes in planned
    ]
