"""Put the report together from the result folders.  Nothing is solved here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from cases.hard_table import read_hard
from reports import (
    section_annulus,
    section_buckling,
    section_campaigns,
    section_cost,
    section_effects,
    section_estimates,
    section_growth,
    section_hard,
    section_hole,
    section_ladder,
    section_other,
    section_peers,
    section_postbuckling,
    section_published,
    section_shear,
    section_stretch,
    section_study,
)
from reports.content import Report, Section
from reports.plan import LADDER
from reports.run import ReportRun
from reports.stored import Stored


def read_results(runs: Sequence[ReportRun], folder: Path) -> dict[str, Stored]:
    """Return the result of every planned run, in the plan's order; missing and refused ones too."""
    return {run.name: Stored(run, folder / run.name) for run in runs}


def build_report(results: Mapping[str, Stored], full: bool, benchmarks: Path) -> Report:
    """Return the content of the report.

    benchmarks : path of `benchmarks.json`, which need not exist. What `wrinkle cost` and `wrinkle study` left is looked
    for beside its folder.
    """
    scenes = {stored.run.scene for stored in results.values()}
    sections: list[Section] = [section_other.summary(results, full)]
    built = (
        ("stretch", section_stretch),
        ("stretch", section_published),
        ("shear", section_shear),
        ("hole", section_hole),
        ("annulus", section_annulus),
    )
    on_grids = {name: stored for name, stored in results.items() if not stored.finite_elements}
    sections += [module.build(on_grids) for scene, module in built if scene in scenes]
    if any(stored.method == "buckling" for stored in results.values()):
        sections.append(section_buckling.build(results, benchmarks.parent))
    if any(stored.method == "postbuckling" for stored in results.values()):
        sections.append(section_postbuckling.build(results, benchmarks.parent))
    if scenes & set(LADDER):
        sections.append(section_ladder.build(results))
    beside = benchmarks.parent.parent
    sections.append(section_cost.build(section_cost.read_costs(beside)))
    sections.append(section_growth.build(section_growth.read_growth(benchmarks.parent)))
    sections.append(section_peers.build(section_peers.read_peers(benchmarks.parent)))
    sections.append(section_estimates.build(section_estimates.read_coverage(benchmarks.parent)))
    sections.append(section_study.build(section_study.read_studies(beside)))
    sections.append(section_effects.build(results, benchmarks.parent))
    sections.append(section_other.verification(section_other.read_benchmarks(benchmarks)))
    peer = section_hard.read_peer(benchmarks.parent)
    sections.append(section_hard.build(read_hard(benchmarks.parent / "hard"), peer))
    sections.append(section_campaigns.build(benchmarks.parent))
    sections += [section_other.open_questions(), section_other.omissions(results)]
    return Report(
        "Wrinkled sheets: plate and tension field beside closed forms",
        "After Taylor, Bertoldi and Steigmann, Spatial resolution of wrinkle patterns in thin elastic "
        "sheets at finite strain, J. Mech. Phys. Solids 62 (2014) 163–180",
        sections,
        section_other.footer(results),
    )
