"""Tables of effects left out, from what the verification runs and the report's own runs left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from reports.content import Table
from reports.stored import Stored
from reports.style import number, whole

Row = Mapping[str, Any]
EFFECTS = {
    "out_of_plane": "out of plane",
    "bending": "bending",
    "strain_gradient": "strain gradient",
    "kinematics": "finite strain",
    "symmetry": "symmetry",
}
GROUPS = {
    "energy": ("energy_N_mm.",),
    "forces": (".force_N.",),
    "moments": (".moment_N_mm.",),
    "stretches": ("stretch.",),
    "heights": ("out_of_plane_mm.", "amplitude_mm", "rms_mm"),
    "wavelengths": ("wavelength_mm",),
}


def words(quantity: str) -> str:
    """A quantity of result.json in words: the part after its table."""
    plain = quantity.replace("_N_mm", "").replace("_mm", "").replace("_N", "")
    return plain.replace("_", " ").replace(".", " ").removeprefix("sections ").removeprefix("reactions ")


def left_out(effects: Mapping[str, Row]) -> str:
    """The effects that were judged, with the audit's sizes."""
    parts = [
        f"{EFFECTS.get(name, name)} ({_size(effect)})"
        for name, effect in effects.items()
        if effect.get("justified") is not None
    ]
    return ", ".join(parts) or "nothing"


def _size(effect: Row) -> str:
    size = effect.get("size")
    return number(float(size), 2) if isinstance(size, int | float) else "–"


def chosen(rows: Sequence[Row]) -> Table:
    """What `auto` chose, what the audit said, and what it cost, beside everything on."""
    cells = tuple(
        (
            row["what"],
            row["method"],
            whole(row["nodes"]),
            left_out(row["effects"]),
            row["verdict"],
            number(row["cpu_seconds"], 2),
            number(row["cpu_seconds_full"], 2),
            number(row["cpu_seconds_full"] / row["cpu_seconds"], 2),
            number(row["less_work"], 2),
        )
        for row in rows
    )
    columns = (
        "problem",
        "method",
        "nodes",
        "left out (audit's size)",
        "verdict",
        "auto (CPU s)",
        "all on (CPU s)",
        "times less time",
        "times less work",
    )
    caption = (
        "Ten problems by `auto` and with everything on. Work is node-steps times operations per node, counted in the"
        " generated code; the times of one run on a machine that may have been busy, the examination of stability"
        " included."
    )
    return Table(caption, columns, cells, wide=(0, 3, 4))


def by_quantity(rows: Sequence[Row]) -> Table:
    """The largest differences of every kind of reported quantity."""
    cells = tuple(
        (row["what"], row["verdict"], *(_largest(row["differences"], keys) for keys in GROUPS.values()))
        for row in rows
    )
    columns = ("problem", "verdict", *GROUPS)
    caption = "Largest relative difference of the reported quantities of each kind, as in the figure."
    return Table(caption, columns, cells, wide=(0, 1))


def _largest(differences: Mapping[str, float], parts: Sequence[str]) -> str:
    found = [value for key, value in differences.items() if any(part in key for part in parts)]
    return number(max(found), 2) if found else "–"


def random(rows: Sequence[Row]) -> Table:
    """Every random scene: what was left out, the verdict, and the largest difference."""
    cells = tuple(
        (
            str(k),
            row["what"],
            left_out(row["effects"]),
            row["verdict"] + ("" if row["comparable"] else " (no full run at rest)"),
            words(row["largest"]["quantity"]),
            number(row["largest"]["difference"], 2),
            "WRONG" if row["wrong"] else "",
        )
        for k, row in enumerate(rows, start=1)
    )
    columns = ("", "scene", "left out (audit's size)", "verdict", "differs most", "by", "")
    caption = (
        "Random scenes, drawn by a seed: what the program left out by itself (where that is nothing: the strain"
        " gradient, if it lets itself be left out), the audit's verdict, and the largest difference from full runs."
    )
    return Table(caption, columns, cells, wide=(1, 2, 3, 4))


def quarters(rows: Sequence[Row]) -> Table:
    """Quarter models against whole sheets."""
    cells = tuple(
        (
            row["what"],
            row["verdict"],
            number(row["cpu_seconds"], 2),
            number(row["cpu_seconds_full"], 2),
            number(row["cpu_seconds"] / row["cpu_seconds_full"], 2),
            number(1.0 / row["less_work"], 2),
            words(row["largest"]["quantity"]),
            number(row["largest"]["difference"], 2),
        )
        for row in rows
    )
    columns = (
        "model",
        "symmetry",
        "quarter (CPU s)",
        "whole (CPU s)",
        "time",
        "node-steps",
        "differs most",
        "by",
    )
    caption = (
        "A quarter of the sheet against the whole: times and node-steps as parts of those of the whole sheet."
    )
    return Table(caption, columns, cells, wide=(0, 1, 6))


def cost(rows: Sequence[Row]) -> Table:
    """What a step of one node costs with every combination of effects."""
    cells = tuple(
        (row["what"], whole(row["operations"]), whole(row["bytes"]), number(row["nanoseconds"], 2))
        for row in rows
    )
    columns = ("model", "operations per node", "bytes per node", "CPU time of a step (ns)")
    caption = (
        "What is left out costs nothing: operations in the generated code of the rows that compute stresses and"
        " moments, bytes of all fields and constants, and time of a step of one node of a rectangle, on one thread of"
        " a machine that may have been busy."
    )
    return Table(caption, columns, cells, wide=(0,))


def plans(rows: Sequence[Row]) -> Table:
    """Every plan beside its outcome."""
    cells = tuple(
        (
            row["what"],
            row["method"],
            whole(row["nodes"]),
            str(row["status"]).replace("_", " "),
            number(row["plan_cpu_seconds"], 2),
            *(_pair(row[key]) for key in ("steps", "cpu_seconds", "memory_MB", "nodes_per_wrinkle")),
        )
        for row in rows
    )
    columns = (
        "scene",
        "method",
        "nodes",
        "ended",
        "plan (CPU s)",
        "steps",
        "CPU (s)",
        "memory (MB)",
        "nodes per wrinkle",
    )
    return Table("Plans and outcomes: foretold / found.", columns, cells, wide=(0,))


def _pair(pair: Sequence[float | None]) -> str:
    return " / ".join(
        "–" if value is None or value == float("inf") else number(float(value), 3) for value in pair
    )


def judged(stored: Stored) -> list[tuple[str, Row]]:
    """The effects of a run that the audit judged."""
    effects = stored.result.get("effects")
    if not isinstance(effects, Mapping):
        return []
    return [(name, effect) for name, effect in effects.items() if effect.get("justified") is not None]


def audits(runs: Sequence[Stored]) -> Table:
    """The audit's words on the runs of this report."""
    cells = tuple(
        (
            stored.run.name if k == 0 else "",
            EFFECTS.get(name, name),
            str(effect["justified"]),
            _size(effect),
            str(effect["why"]),
        )
        for stored in runs
        for k, (name, effect) in enumerate(judged(stored))
    )
    columns = ("run", "left out", "verdict", "size", "why")
    return Table("What the audit said of the runs of this report.", columns, cells, wide=(0, 4))
