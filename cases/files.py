"""File formats of a result folder: JSON, CSV, NPZ and VTU (the only use of meshio)."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cases.unstructured import AnySolution, FiniteElementSolution
from fdsolver.grid import Grid
from fdsolver.result import Solution, ZoneFields

ZONE_ARRAYS = ("stretch_major", "stretch_minor", "stress_major", "stress_minor", "state")
_EDGE_PREFIX = "edge_"


def json_text(document: Mapping[str, Any]) -> str:
    """Indented JSON; numpy numbers and arrays become numbers and lists, what is not finite becomes null."""
    return json.dumps(_plain(document), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value


def write_csv(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    """Columns of equal length with a header line; numbers in their shortest form that reads back exactly."""
    lists = [np.asarray(column).tolist() for column in columns.values()]
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*lists, strict=True))


def read_csv(path: Path) -> dict[str, np.ndarray]:
    """Columns of a CSV file: int64 where every value is a whole number without a point, else float64.

    Raises ValueError for rows of unequal length or entries that are no numbers.
    """
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = list(csv.reader(file)) or [[]]
    if any(len(row) != len(header) for row in rows):
        raise ValueError(f"{path}: a row has not as many entries as the header")
    return {name: _numbers([row[k] for row in rows]) for k, name in enumerate(header)}


def _numbers(words: list[str]) -> np.ndarray:
    try:
        return np.array([int(word) for word in words], dtype=np.int64)
    except ValueError:
        return np.array([float(word) for word in words], dtype=np.float64)


def write_fields(path: Path, solution: Solution) -> None:
    """The contract's arrays u, r and the zone fields; beside them what rebuilds the mesh without its scene.

    Those are `shape`, `closed`, `xi`, `eta`, `length_mm`, `breaks` and one `edge_NAME` per edge.
    """
    grid = solution.grid
    arrays = {"u": grid.u, "r": solution.r}
    arrays |= {name: getattr(solution.zone, name) for name in ZONE_ARRAYS}
    arrays |= {
        "shape": np.asarray(grid.shape),
        "closed": np.asarray(grid.closed),
        "xi": grid.xi,
        "eta": grid.eta,
        "length_mm": np.asarray(grid.length_mm),
        "breaks": np.asarray(grid.breaks, dtype=np.float64),
    }
    arrays |= {_EDGE_PREFIX + name: nodes for name, nodes in grid.edges.items()}
    # Any: numpy's stub would read the keyword arrays as its own options.
    np.savez_compressed(path, **arrays)  # type: ignore[arg-type]


def write_snapshots(path: Path, snapshots: Mapping[str, np.ndarray]) -> None:
    """The arrays `step` (m,), `level` (m,), `kinetic_N_mm` (m,) and `r` (m, ni, nj, 3) mm of the way to the end."""
    np.savez_compressed(path, **snapshots)  # type: ignore[arg-type]


def read_snapshots(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a snapshots.npz; none where the run kept none and there is no file.

    Raises ValueError, OSError or zipfile.BadZipFile for a damaged file.
    """
    if not path.exists():
        return {}
    with open(path, "rb") as file, np.load(file, allow_pickle=False) as stored:
        return {name: stored[name] for name in stored.files}


def read_fields(path: Path) -> tuple[Grid, np.ndarray, ZoneFields]:
    """Mesh, deformed positions (ni, nj, 3) mm and zone fields of a fields.npz.

    Raises KeyError, ValueError, OSError or zipfile.BadZipFile for a file that is not one.
    """
    # numpy does not close a file of its own that turns out to be damaged.
    with open(path, "rb") as file, np.load(file, allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    edges = {
        name.removeprefix(_EDGE_PREFIX): nodes
        for name, nodes in arrays.items()
        if name.startswith(_EDGE_PREFIX)
    }
    grid = Grid(
        str(arrays["shape"]),
        arrays["u"],
        bool(arrays["closed"]),
        edges,
        arrays["xi"],
        arrays["eta"],
        float(arrays["length_mm"]),
        tuple(arrays["breaks"].tolist()),
    )
    r = arrays["r"]
    if r.shape != (grid.ni, grid.nj, 3):
        raise ValueError(f"{path}: r has the shape {r.shape}, not {(grid.ni, grid.nj, 3)}")
    zone = ZoneFields(**{name: arrays[name] for name in ZONE_ARRAYS})
    for name in ZONE_ARRAYS:
        if getattr(zone, name).shape != grid.zone_area.shape:
            raise ValueError(f"{path}: {name} has the shape {getattr(zone, name).shape}")
    return grid, r, zone


def quadrilaterals(grid: Grid) -> np.ndarray:
    """(zones, 4) int64: numbers i nj + j of each zone's corners a, b, c, d, zones in row order."""
    number = np.arange(grid.nodes).reshape(grid.ni, grid.nj)
    if grid.closed:
        number = np.concatenate([number, number[:1]])
    corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    return np.stack(corners, axis=-1).reshape(-1, 4)


def write_vtu(path: Path, solution: AnySolution) -> None:
    """The deformed sheet as an unstructured grid for ParaView: reference positions, displacement, zone
    fields, buckling modes.
    """
    import meshio

    grid = solution.grid
    modes: dict[str, np.ndarray] = {}
    if isinstance(solution, FiniteElementSolution):
        cells = solution.grid.cells
        modes = {f"mode_{k + 1}": mode for k, mode in enumerate(solution.modes)}
    else:
        cells = quadrilaterals(solution.grid)
    deformed = solution.r.reshape(-1, 3)
    reference = np.zeros_like(deformed)
    reference[:, :2] = grid.u.reshape(-1, 2)
    fields = {name: getattr(solution.zone, name).ravel() for name in ZONE_ARRAYS}
    # VTK readers disagree on 8-bit integers.
    fields["state"] = fields["state"].astype(np.int32)
    mesh = meshio.Mesh(
        deformed,
        [("quad" if cells.shape[1] == 4 else "triangle", cells)],
        point_data={"reference_mm": reference, "displacement_mm": deformed - reference, **modes},
        cell_data={name: [values] for name, values in fields.items()},
    )
    mesh.write(path, file_format="vtu")
