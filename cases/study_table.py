"""The table of a study: one row per point, its choices first, then every number of its result."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cases.files import read_csv
from cases.results import ResultError, read_document
from cases.study_points import Point
from cases.study_worker import note_path
from fdsolver.checkpoint import write_atomically

if TYPE_CHECKING:
    import pandas as pd

TABLE = "study.csv"
# parts of result.json that are no number of the answer, or stand in the row under another name
LEFT_OUT = frozenset(
    ("scene", "method", "status", "message", "seed", "versions", "machine", "code", "scene_hash", "mesh")
    + ("levels", "errors", "warnings", "effects", "buckling", "threads", "sha256")
)
WRINKLED = 1


def row(point: Point, out: Path) -> dict[str, Any]:
    """One row: the choices of a point, how it ended, and the numbers of its result (none if there is none)."""
    chosen = {"point": point.name, "method": point.method, "seed": point.seed}
    chosen |= {key: _cell(value) for key, value in point.changes.items()}
    document = result_of(point, out)
    ended = {"status": document["status"], "message": document["message"]}
    if "scene_hash" not in document:
        return {**chosen, **ended}
    numbers = flat({key: value for key, value in document.items() if key not in LEFT_OUT})
    return {**chosen, **ended, **numbers, **wrinkled_bands(out / point.name), **_errors(document)}


def result_of(point: Point, out: Path) -> Mapping[str, Any]:
    """The result.json of a point; of a point without one, `status` and `message` alone."""
    if point.refused:
        return {"status": "refused", "message": point.refused}
    note = _note(out, point)
    if note is not None:
        return note
    try:
        return read_document(out / point.name)
    except ResultError:
        return {"status": "not run", "message": "There is no result yet."}


def _note(out: Path, point: Point) -> Mapping[str, Any] | None:
    """Why a point has no result; None if nothing was noted, or nothing that can be read."""
    try:
        note = json.loads(note_path(out, point.name).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    return note if isinstance(note, dict) and {"status", "message"} <= set(note) else None


def flat(document: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    """Dotted keys and plain values; a vector gives one number per axis, as `force_N.x`."""
    cells: dict[str, Any] = {}
    for key, value in document.items():
        dotted = f"{above}{key}"
        if isinstance(value, list) and len(value) == 3:
            value = dict(zip("xyz", value, strict=True))
        if isinstance(value, Mapping):
            cells |= flat(value, f"{dotted}.")
        elif isinstance(value, bool | int | float | str) or value is None:
            cells[dotted] = value
    return cells


def wrinkled_bands(folder: Path) -> dict[str, float | None]:
    """Per path of a result: where its wrinkled part begins and ends, mm (`R_mm` or `s_mm`), and its share of rows.

    The ends are places of rows, so known to one zone. None where nothing is wrinkled.
    """
    cells: dict[str, float | None] = {}
    for path in sorted((folder / "paths").glob("*.csv")):
        columns = read_csv(path)
        place = columns.get("R_mm", columns.get("s_mm"))
        if place is None or "state" not in columns:
            continue
        wrinkled = place[columns["state"] == WRINKLED]
        above = f"paths.{path.stem}.wrinkled"
        cells[f"{above}_from_mm"] = float(wrinkled.min()) if len(wrinkled) else None
        cells[f"{above}_to_mm"] = float(wrinkled.max()) if len(wrinkled) else None
        cells[f"{above}_share"] = len(wrinkled) / len(place)
    return cells


def _errors(document: Mapping[str, Any]) -> dict[str, Any]:
    """The estimated discretisation error of each quantity."""
    return {f"errors.{error['quantity']}": error["discretisation"] for error in document.get("errors", [])}


def _cell(value: object) -> object:
    """A value of a scene key in a table: lists as text."""
    return json.dumps(value) if isinstance(value, list | dict) else value


def table(points: Sequence[Point], out: Path) -> pd.DataFrame:
    """One row per point, in the order of the study."""
    import pandas as pd

    return pd.DataFrame([row(point, out) for point in points])


def write_table(points: Sequence[Point], out: Path) -> pd.DataFrame:
    """Write study.csv, whole or not at all, and return the table. Raises StorageError."""
    found = table(points, out)
    text = found.to_csv(index=False)
    write_atomically(out / TABLE, lambda file: file.write(text.encode("utf-8")))
    return found
