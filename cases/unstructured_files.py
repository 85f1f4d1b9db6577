"""fields.npz of a finite-element result: u, r, cells, modes and one value of each zone field per cell."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cases.unstructured import FiniteElementMesh, FiniteElementSolution
from fdsolver.result import ZoneFields

_ZONE_ARRAYS = tuple(ZoneFields.__dataclass_fields__)


@dataclass(frozen=True)
class Stored:
    """What fields.npz holds: mesh, r (n, 3) mm, zone fields (m,), modes (k, n), derivatives (n, 3, 3) or None."""

    grid: FiniteElementMesh
    r: np.ndarray
    zone: ZoneFields
    modes: np.ndarray
    derivatives: np.ndarray | None


def write_cells(path: Path, solution: FiniteElementSolution) -> None:
    """The contract's arrays u, r, cells and modes; beside them the zone fields and the sheet's shape."""
    grid = solution.grid
    arrays = {"u": grid.u, "r": solution.r, "cells": grid.cells, "modes": solution.modes}
    arrays |= {name: getattr(solution.zone, name) for name in _ZONE_ARRAYS}
    if solution.derivatives is not None:
        arrays["derivatives"] = solution.derivatives
    # Any: numpy's stub would read the keyword arrays as its own options.
    np.savez_compressed(path, shape=np.asarray(grid.shape), **arrays)  # type: ignore[arg-type]


def read_cells(path: Path) -> Stored:
    """What `write_cells` wrote.

    Raises KeyError, ValueError, OSError or zipfile.BadZipFile for a file that is not one.
    """
    with open(path, "rb") as file, np.load(file, allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    grid = FiniteElementMesh(str(arrays["shape"]), arrays["u"], arrays["cells"])
    wanted = {"r": (grid.nodes, 3)} | dict.fromkeys(_ZONE_ARRAYS, (grid.zones,))
    for name, shape in wanted.items():
        if arrays[name].shape != shape:
            raise ValueError(f"{path}: {name} has the shape {arrays[name].shape}, not {shape}")
    if arrays["modes"].ndim != 2 or arrays["modes"].shape[1] != grid.nodes:
        raise ValueError(f"{path}: modes have the shape {arrays['modes'].shape}, not (k, {grid.nodes})")
    derivatives = arrays.get("derivatives")
    if derivatives is not None and derivatives.shape != (grid.nodes, 3, 3):
        raise ValueError(f"{path}: derivatives have the shape {derivatives.shape}, not ({grid.nodes}, 3, 3)")
    zone = ZoneFields(**{name: arrays[name] for name in _ZONE_ARRAYS})
    return Stored(grid, arrays["r"], zone, arrays["modes"], derivatives)
