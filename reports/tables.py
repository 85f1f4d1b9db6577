"""Tables of the report, as text cells: runs, differences, wrinkles, verification."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from reports.content import Table, Text
from reports.stored import Columns, Stored
from reports.style import method_name, number, whole

SLACK = 0
SAID_ELSEWHERE = (
    "move_mm",
    "tolerance",
    "snapshots",
    "out_of_plane",
)  # in captions, as a residual, as figures
COARSER = 0.9  # of the planned nodes; a mesh has them within 5 %


def run_table(stored: Sequence[Stored], caption: str) -> Table:
    """How each run went: status, residual, steps, time, resolution, hourglass, stability."""
    columns = (
        "method",
        "nodes",
        "status",
        "residual (–)",
        "steps",
        "time (s)",
        "CPU (s)",
        "nodes per wrinkle",
        "hourglass out / in (–)",
        "stable",
        "warnings",
    )
    rows = tuple(
        (
            _label(run),
            whole(run.value("nodes")),
            run.status.replace("_", " "),
            number(run.value("residual"), 2),
            whole(run.value("steps")),
            number(run.value("seconds"), 3),
            number(run.value("cpu_seconds"), 3),
            number(run.value("nodes_per_wrinkle"), 2),
            hourglass(run),
            stable(run),
            str(len(warnings_of(run))),
        )
        for run in stored
    )
    return Table(caption, columns, rows)


def _label(run: Stored) -> str:
    """Method, and the overrides that make this run differ from the built-in scene."""
    changed = {key.split(".")[-1]: value for key, value in run.run.overrides.items()}
    return ", ".join([run.method, *(f"{k} = {v}" for k, v in changed.items() if k not in SAID_ELSEWHERE)])


def hourglass(run: Stored) -> str:
    """Checkerboard share out of plane and in plane."""
    shares = (run.value("hourglass", part) for part in ("out_of_plane", "in_plane"))
    return " / ".join(number(share, 2) for share in shares)


def stable(run: Stored) -> str:
    """yes, no, or an en dash where stability was not tested."""
    stability = run.result.get("stability")
    value = stability.get("stable") if isinstance(stability, Mapping) else None
    return {True: "yes", False: "no"}.get(value, "–") if isinstance(value, bool) else "–"


def warnings_of(run: Stored) -> list[str]:
    """Warnings stored with a result."""
    warnings = run.result.get("warnings")
    return [str(w) for w in warnings] if isinstance(warnings, list) else []


def remarks(stored: Iterable[Stored], heading: str = "Remarks of the solvers:") -> Text | None:
    """What a reader must know of these runs, equal remarks together; None if there is nothing.

    Why a run did not converge, whether it ended on a coarser mesh than planned, and every warning.
    """
    items: dict[str, list[str]] = {}
    for run in stored:
        name = f"{run.run.name if run.run.part else _label(run)}"
        name += f", {whole(run.value('nodes'))} nodes" if "nodes" in run.result else ""
        for remark in (*shortfalls(run), *(f"Warning: {warning}" for warning in warnings_of(run))):
            items.setdefault(remark, []).append(name if run.run.part else f"{run.run.scene}: {name}")
    texts = tuple(f"{'; '.join(names)}. {text}" for text, names in items.items())
    return Text(heading, texts) if texts else None


def shortfalls(run: Stored) -> list[str]:
    """Why a run did not converge, and whether it ended on a coarser mesh than planned."""
    found = []
    if not run.converged:
        status = run.status.replace("_", " ")
        found.append(run.message if run.message.lower().startswith(status) else f"{status}: {run.message}")
    mesh = run.scene.get("mesh")
    count = "vertices" if run.finite_elements else "nodes"
    planned = float(mesh.get(count, 0)) if isinstance(mesh, Mapping) else 0.0
    if run.value("nodes") < COARSER * planned:
        found.append(f"It ended on a coarser mesh than the {whole(planned)} {count} planned.")
    return found


def at_radii(path: Columns, radii: np.ndarray, field: str) -> np.ndarray:
    """A column of `paths/radius.csv` at given radii (mm); the rows themselves where they are the same."""
    own = path["R_mm"]
    if own.shape == radii.shape and np.allclose(own, radii, rtol=1e-9, atol=0.0):
        return path[field]
    return np.interp(radii, own, path[field])


def relative_error(path: Columns, exact: Columns, field: str, low: float, high: float) -> float:
    """Relative L2 error of a stretch over the rows between two radii (mm); NaN without rows."""
    if not path or not exact:
        return math.nan
    rows = (path["R_mm"] >= low) & (path["R_mm"] <= high)
    if not rows.any():
        return math.nan
    reference = at_radii(exact, path["R_mm"], field)[rows]
    return float(np.linalg.norm(path[field][rows] - reference) / np.linalg.norm(reference))


def difference_table(
    runs: Mapping[str, Stored | None], reference: str, names: Sequence[str], caption: str
) -> Table | None:
    """Distances of both stretches from a reference method along paths; None if there is nothing to compare.

    Rows where the reference is slack are left out: its stretch is not unique there.
    """
    rows = []
    base = runs.get(reference)
    for method, stored in runs.items():
        for name in names:
            if method == reference or stored is None or base is None:
                continue
            ours, theirs = stored.path(name), base.path(name)
            if ours and theirs:
                rows.append((method, name.replace("_", " "), *_distances(ours, theirs)))
    heads = [f"{letter}, {how} (–)" for letter in ("λ₁", "λ₂") for how in ("relative L2", "largest")]
    return Table(caption, ("method", "path", *heads), tuple(rows)) if rows else None


def _distances(ours: Columns, theirs: Columns) -> list[str]:
    """Relative L2 and largest distance, of the major and of the minor stretch."""
    along = "R_mm" if "R_mm" in theirs else "s_mm"
    keep = np.rint(theirs["state"]) != SLACK
    cells = []
    for field in ("stretch_major", "stretch_minor"):
        reference = theirs[field][keep]
        gap = np.interp(theirs[along], ours[along], ours[field])[keep] - reference
        if not gap.size:
            return ["–"] * 4
        relative = np.linalg.norm(gap) / np.linalg.norm(reference)
        cells += [number(float(relative), 2), number(float(np.abs(gap).max()), 2)]
    return cells


def quantity_table(
    stored: Sequence[Stored],
    caption: str,
    quantities: Mapping[str, tuple[str, ...]],
    reference: Stored | None,
) -> Table:
    """Quantities of each run, each followed by its relative difference from a reference run.

    quantities : column head with unit -> keys of `result.json`; the last may be an index such as "#2".
    """
    columns = ["method", "nodes"]
    for name in quantities:
        columns.append(name)
        if reference is not None:
            columns.append("difference (%)")
    rows = []
    for run in stored:
        row = [_label(run), whole(run.value("nodes"))]
        for keys in quantities.values():
            value = find(run, keys)
            row.append(number(value, 5))
            if reference is not None:
                row.append("" if run is reference else percent(value, find(reference, keys)))
        rows.append(tuple(row))
    return Table(caption, tuple(columns), tuple(rows))


def find(run: Stored, keys: tuple[str, ...]) -> float:
    """A number in `result.json`; a key "#k" takes entry k of a list."""
    if not keys[-1].startswith("#"):
        return run.value(*keys)
    found: object = run.result
    for key in keys[:-1]:
        found = found.get(key) if isinstance(found, Mapping) else None
    index = int(keys[-1][1:])
    return float(found[index]) if isinstance(found, list) and len(found) > index else math.nan


def percent(value: float, reference: float) -> str:
    """Relative difference in per cent, with sign; an en dash where it has no meaning."""
    if not (math.isfinite(value) and math.isfinite(reference)) or reference == 0.0:
        return "–"
    difference = 100.0 * (value - reference) / abs(reference)
    text = number(difference, 2)
    return f"+{text}" if difference > 0.0 else text


def wrinkle_table(stored: Sequence[Stored], caption: str) -> Table | None:
    """Number, wavelength and size of the wrinkles on every stored section; None if there is no section."""
    rows = []
    for run in stored:
        sections = run.result.get("sections")
        for name, measures in sorted(sections.items()) if isinstance(sections, Mapping) else ():
            rows.append(
                (
                    _label(run),
                    whole(run.value("nodes")),
                    str(name).replace("_", " "),
                    *(
                        number(_float(measures.get(key)), 3)
                        for key in ("amplitude_mm", "rms_mm", "wavelength_mm")
                    ),
                    whole(_float(measures.get("half_waves"))),
                )
            )
    columns = (
        "method",
        "nodes",
        "section",
        "largest |z| (mm)",
        "rms z (mm)",
        "wavelength (mm)",
        "half waves",
    )
    return Table(caption, columns, tuple(rows)) if rows else None


def _float(value: object) -> float:
    return float(value) if isinstance(value, int | float) else math.nan


def method_list(stored: Iterable[Stored]) -> str:
    """The methods of some runs in words."""
    return ", ".join(dict.fromkeys(method_name(run.method) for run in stored))
