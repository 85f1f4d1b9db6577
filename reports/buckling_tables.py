"""Tables of buckling factors: scene by scene with their errors, and what every run took."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from reports.content import Table
from reports.stored import Stored
from reports.style import number, whole

NAMES = {"stretch": "pulled strip", "shear": "sheared sheet", "hole": "pulled sheet with a hole"}
IMAGES = {"mirror_x": "the reflection of X", "mirror_y": "the reflection of Y", "half_turn": "the half turn"}


def critical(run: Stored) -> list[Mapping[str, object]]:
    """The entries of `buckling.critical`, none where a run was refused."""
    part = run.result.get("buckling")
    entries = part.get("critical") if isinstance(part, Mapping) else None
    return list(entries) if isinstance(entries, list) else []


def finest(runs: Sequence[Stored]) -> Stored | None:
    """The triangles with the most vertices among the runs with factors: quintics have the smaller error."""
    there = [run for run in runs if critical(run)]
    return max(
        there, key=lambda s: (not s.run.overrides.get("solver.element"), s.value("nodes")), default=None
    )


def partners_of(run: Stored, runs: Sequence[Stored]) -> list[Stored]:
    """The other runs of the scene that found factors: coarser meshes, then the other element."""
    others = [s for s in runs if critical(s) and s is not run]
    return sorted(others, key=lambda s: bool(s.run.overrides.get("solver.element")))


def factor_table(run: Stored, others: Sequence[Stored]) -> Table:
    """The first factors of a scene, as displacement and strain, and how far other meshes and elements are away."""
    entries, errors = critical(run), _errors(run)
    rows = []
    for k, entry in enumerate(entries):
        factor = to_float(entry.get("factor"))
        row = [
            str(k + 1),
            number(factor, 5),
            number(to_float(entry.get("displacement_mm")), 4),
            number(to_float(entry.get("strain")), 4),
            str(entry.get("parity") or "–"),
            str(entry.get("pair") or "–"),
            number(100.0 * errors.get(k, math.nan) / factor, 2),
        ]
        for other in others:
            same = counterpart(entries, k, critical(other))
            row.append(number(100.0 * (same / factor - 1.0), 2))
        rows.append(tuple(row))
    columns = ("mode", "factor (–)", "displacement (mm)", "strain (–)", "parity", "pair", "error (%)")
    away = tuple(f"{_mesh_words(other)} (%)" for other in others)
    caption = (
        f"{NAMES[run.run.scene].capitalize()}, {_mesh_words(run)}: the first {len(entries)} factors of the scene's own "
        f"load.{_parity_words(entries)} Error: change from a mesh of a quarter of the vertices."
    )
    if others:
        caption += " Last: how far the same mode of other meshes is away."
    return Table(caption, (*columns, *away), tuple(rows))


def counterpart(
    entries: Sequence[Mapping[str, object]], k: int, others: Sequence[Mapping[str, object]]
) -> float:
    """Another mesh's factor of the same rank among those of mode k's parity: within pairs the order is by chance."""
    parity = entries[k].get("parity")
    rank = sum(entry.get("parity") == parity for entry in entries[:k])
    alike = [to_float(entry.get("factor")) for entry in others if entry.get("parity") == parity]
    return alike[rank] if rank < len(alike) else math.nan


def _mesh_words(run: Stored) -> str:
    return f"{whole(run.value('nodes'))} vertices, {cells_of(run)}"


def cells_of(run: Stored) -> str:
    """Shape of the run's elements."""
    return "rectangles" if run.run.overrides.get("solver.element") else "triangles"


def _parity_words(entries: Sequence[Mapping[str, object]]) -> str:
    about = IMAGES.get(str(entries[0].get("about")))
    return f" Parity under {about}." if about else ""


def _errors(run: Stored) -> dict[int, float]:
    """Absolute error of each factor by its place."""
    errors = run.result.get("errors")
    found = {}
    for entry in errors if isinstance(errors, list) else ():
        words = str(entry.get("quantity", "")).split()
        if words[:2] == ["buckling", "factor"]:
            found[int(words[2]) - 1] = to_float(entry.get("discretisation"))
    return found


def to_float(value: object) -> float:
    """A stored number, NaN for anything else."""
    return float(value) if isinstance(value, int | float) else math.nan


def run_table(runs: Sequence[Stored]) -> Table:
    """Size, cost and end of every run, and whether the inertia vouches for its count of modes."""
    rows = []
    for run in runs:
        level = _last_level(run)
        rows.append(
            (
                run.run.scene,
                cells_of(run),
                whole(run.value("nodes")),
                whole(to_float(level.get("unknowns"))),
                whole(to_float(level.get("factor_entries"))),
                run.status.replace("_", " "),
                number(run.value("residual"), 2),
                certified(run),
                number(run.value("cpu_seconds"), 3),
                number(run.value("peak_memory_MB"), 3),
            )
        )
    columns = (
        "scene",
        "cells",
        "vertices",
        "unknowns",
        "entries of L and D",
        "status",
        "residual (–)",
        "count certified",
        "CPU (s)",
        "peak memory (MB)",
    )
    caption = (
        "Runs of the buckling factors; CPU of both meshes of each. Residual: bound on the relative distance of the "
        "factors from those of the assembled matrices."
    )
    return Table(caption, columns, tuple(rows))


def certified(run: Stored) -> str:
    """Whether the result says that the inertia certifies its count; a run whose count is in doubt has no factors."""
    stability = run.result.get("stability")
    how = str(stability.get("how", "")) if isinstance(stability, Mapping) else ""
    return "yes" if critical(run) and "inertia" in how else "–"


def _last_level(run: Stored) -> Mapping[str, object]:
    levels = run.result.get("levels")
    return levels[-1] if isinstance(levels, list) and levels else {}
