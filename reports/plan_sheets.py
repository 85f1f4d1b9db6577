"""The runs of the pulled and of the sheared rectangle: Fig. 3 to 6 of the paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from reports.run import ReportRun

STRIP_LENGTH_MM = 254.0

PULLS = (2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0, 13.0, 16.0, 20.0, 22.0, 24.0, 30.0)  # % of the length
SHOWN_PULLS = (5.0, 10.0, 20.0, 30.0)  # those of Fig. 4
PAPER_NODES, PAPER_NODES_ABOVE = 60_000, 120_000  # up to and above a pull of 10 %
STRIP_MESHES_QUICK, STRIP_MESHES_FULL = (3000, 6000, 12000), (15000, 30000, 60000)
SEED_NODES_QUICK, SEEDS = 6000, tuple(range(1, 11))  # ten, as in Fig. 5

# pull (%), which mesh of the sweep, variants of the published scheme
PUBLISHED = (
    (10.0, 1, ("printed", "filtered", "stabilised")),
    (10.0, 2, ("filtered", "stabilised")),
    (20.0, 1, ("filtered", "stabilised")),
)

# Where the scheme without hourglass stiffness ends in a checkerboard: pull (%), nodes, further keys. On square cells
# that takes one mesh and a start about as high as the sheet is thick: from lower ones it wrinkles.
HIGH_START: dict[str, object] = {"start.perturbation": 1e-3, "solver.levels": 1}
UNHEALTHY: dict[str, tuple[float, int, dict[str, object]]] = {
    "long-cells": (10.0, 6000, {"mesh.cell_ratio": 3.0}),
    "square-cells": (20.0, 8000, {"mesh.bias": 0.0, **HIGH_START}),
}

SHEARS_MM = (0.05, 0.5, 3.0)  # the caption's, the text's, the larger one
PRE_STRETCHES_MM = (0.0, 0.05)
SHEAR_MESHES_QUICK, SHEAR_MESHES_FULL = (3000, 6000, 12000), (20000, 40000, 80000)
SCAN_SHEAR_MM, SCAN_NODES = 0.5, (6000, 20000)
SCAN_HALF_WAVELENGTHS_MM = (8.0, 10.0, 14.0, 20.0)
SHEAR_SEEDS, SHEAR_SEED_NODES = (1, 2), (6000, 40000)  # besides seed 0; quick and full


def pull(percent: float) -> dict[str, object]:
    """Overrides that pull the strip by a part of its length, %."""
    return {"edges.top.move_mm": [0.0, round(STRIP_LENGTH_MM * percent / 100.0, 6), 0.0]}


def shear(move_mm: float, pre_stretch_mm: float) -> dict[str, object]:
    """Overrides that move the upper edge of the sheared sheet sideways and up, mm."""
    return {"edges.top.move_mm": [move_mm, pre_stretch_mm, 0.0]}


def _scan() -> list[ReportRun]:
    """The energy against the half-wavelength that the start imposes, at the text's displacement."""
    quick, full = SCAN_NODES
    changes = shear(SCAN_SHEAR_MM, 0.0)
    return [
        ReportRun(
            f"shear-scan-{half:g}", "shear", "koiter", quick, full, changes, part="scan", imposed_mm=half
        )
        for half in SCAN_HALF_WAVELENGTHS_MM
    ]


def kept_flat(run: ReportRun) -> ReportRun:
    """The run of the same load and mesh whose sheet is kept in its plane."""
    return replace(run, name=f"{run.name}-flat", part="flat", kept_flat=True)


def whole_plate(run: ReportRun) -> ReportRun:
    """The run with out-of-plane motion on, so that all pulls are solved by one model: left to itself a plate that is
    found to stay flat is solved in its plane, without what is left of the random start.
    """
    if run.method != "koiter":
        return run
    return replace(run, overrides={**run.overrides, "effects.out_of_plane": "on"})


def stretch_runs() -> list[ReportRun]:
    """The runs of the strip; those of the comparison of methods at 10 % have no part."""
    runs = [
        ReportRun("stretch-koiter", "stretch", "koiter", 24000, PAPER_NODES, max_seconds=60.0),
        ReportRun("stretch-tension-field", "stretch", "tension-field", 6000, 36000),
        ReportRun("stretch-membrane", "stretch", "membrane", 6000, 36000),
        _progress(),
        *_sweep(),
        *_seeds(),
        *published_runs(),
    ]
    return [whole_plate(run) for run in runs]


def _progress() -> ReportRun:
    """Fig. 3: one mesh and kinetic damping, as in the paper."""
    way = {"solver.damping": "kinetic", "solver.levels": 1, "solver.snapshots": 6}
    return ReportRun("stretch-progress", "stretch", "koiter", 6000, PAPER_NODES, way, part="progress")


def _sweep() -> list[ReportRun]:
    """Fig. 4 and the curves against the pull: every pull on a sequence of meshes, wrinkled and kept flat."""
    runs = []
    for percent in PULLS:
        for quick, full in _meshes(STRIP_MESHES_QUICK, STRIP_MESHES_FULL):
            changes = {**pull(percent)}
            name = f"stretch-pull-{percent:g}-{quick}"
            runs.append(ReportRun(name, "stretch", "koiter", quick, full, changes, part="sweep"))
            runs.append(kept_flat(runs[-1]))
    for percent in SHOWN_PULLS:
        if percent > 10.0:  # up to there the finest mesh of the sequence is the paper's
            name = f"stretch-pull-{percent:g}-paper"
            runs.append(
                ReportRun(name, "stretch", "koiter", None, PAPER_NODES_ABOVE, pull(percent), part="sweep")
            )
            runs.append(kept_flat(runs[-1]))
    return runs


def _seeds() -> list[ReportRun]:
    """Fig. 5.  One mesh: nested runs leave the flat state along its lowest mode, whatever the seed."""
    changes = {"solver.levels": 1}
    return [
        ReportRun(
            f"stretch-seed-{seed}",
            "stretch",
            "koiter",
            SEED_NODES_QUICK,
            PAPER_NODES,
            changes,
            part="seeds",
            seed=seed,
        )
        for seed in SEEDS
    ]


def published_runs() -> list[ReportRun]:
    """The paper's own scheme on meshes of the sweep, and on cells that it cannot bear, with their partner."""
    runs = []
    for percent, k, variants in PUBLISHED:
        mesh = STRIP_MESHES_QUICK[k], STRIP_MESHES_FULL[k]
        for variant in variants:
            changes = {**pull(percent), "solver.published": variant}
            name = f"published-{variant}-{percent:g}-{mesh[0]}"
            runs.append(ReportRun(name, "stretch", "koiter-published", *mesh, changes, 40.0, "published"))
    for name, (percent, nodes, keys) in UNHEALTHY.items():
        changes, mesh = {**pull(percent), **keys}, (nodes, nodes)
        for variant in ("filtered", "stabilised"):
            ours = {**changes, "solver.published": variant}
            full_name = f"published-{variant}-{name}"
            runs.append(ReportRun(full_name, "stretch", "koiter-published", *mesh, ours, 40.0, "published"))
        partner = f"published-partner-{name}"
        runs.append(ReportRun(partner, "stretch", "koiter", *mesh, changes, 40.0, "published"))
    return runs


def shear_runs() -> list[ReportRun]:
    """Fig. 6: every load on a sequence of meshes, and the two large ones from further seeds too."""
    runs = []
    for move in SHEARS_MM:
        for rise in PRE_STRETCHES_MM:
            name = f"shear-{move:g}-{rise:g}"
            changes = shear(move, rise)
            for quick, full in _meshes(SHEAR_MESHES_QUICK, SHEAR_MESHES_FULL):
                small = move < 0.1 and quick != SHEAR_MESHES_QUICK[1]  # one mesh says whether it wrinkles
                few = None if small else quick
                runs.append(ReportRun(f"{name}-{quick}", "shear", "koiter", few, full, changes, part="mesh"))
                runs.append(kept_flat(runs[-1]))
            runs += _shear_seeds(name, changes) if move > 0.1 else []
    return [whole_plate(run) for run in (*runs, *_scan())]


def _shear_seeds(name: str, changes: dict[str, object]) -> Iterable[ReportRun]:
    for seed in SHEAR_SEEDS:
        quick, full = SHEAR_SEED_NODES
        yield ReportRun(
            f"{name}-seed-{seed}", "shear", "koiter", quick, full, changes, part="seeds", seed=seed
        )


def _meshes(quick: Sequence[int], full: Sequence[int]) -> list[tuple[int, int]]:
    """The meshes of the quick and the full report, from coarse to fine."""
    return list(zip(quick, full, strict=True))
