"""Result folders as the report reads them: whatever a folder holds, complete, partial or refused."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from cases.files import read_csv, read_snapshots
from reports.run import ReportRun

Columns = Mapping[str, np.ndarray]
FINITE_ELEMENTS = ("buckling", "postbuckling")


def refusal_path(folder: Path) -> Path:
    """Where it is noted why a run has no result folder: beside the folder's place."""
    return folder.with_name(f"{folder.name}.refused.json")


@dataclass(frozen=True)
class Stored:
    """One result folder, read piece by piece when asked for.

    run : what was to be solved.  folder : where its result is.
    """

    run: ReportRun
    folder: Path

    @cached_property
    def result(self) -> Mapping[str, object]:
        """The content of `result.json`; of the note of a refusal; or of neither, as status "not run"."""
        for path in (self.folder / "result.json", refusal_path(self.folder)):
            if path.is_file():
                return json.loads(path.read_text(encoding="utf-8"))
        return {"status": "not run", "message": "No result folder was found for this run."}

    @cached_property
    def scene(self) -> Mapping[str, object]:
        """The resolved scene, empty if the run was refused."""
        path = self.folder / "scene.toml"
        return tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}

    @cached_property
    def fields(self) -> Mapping[str, np.ndarray]:
        """Arrays of `fields.npz`, mm and MPa; empty if there are none."""
        path = self.folder / "fields.npz"
        if not path.is_file():
            return {}
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}

    @cached_property
    def snapshots(self) -> Mapping[str, np.ndarray]:
        """Shapes on the way to equilibrium: `step`, `level`, `kinetic_N_mm` (m,) and `r` (m, ni, nj, 3) mm."""
        return read_snapshots(self.folder / "snapshots.npz")

    @cached_property
    def history(self) -> Columns:
        """Columns of `history.csv`."""
        return read_columns(self.folder / "history.csv")

    def path(self, name: str) -> Columns:
        """Columns of `paths/NAME.csv`; empty if there is none."""
        return read_columns(self.folder / "paths" / f"{name}.csv")

    def section(self, name: str) -> Columns:
        """Columns of `sections/NAME.csv`; empty if there is none."""
        return read_columns(self.folder / "sections" / f"{name}.csv")

    @property
    def section_names(self) -> list[str]:
        """Names of all stored sections, sorted."""
        return sorted(path.stem for path in (self.folder / "sections").glob("*.csv"))

    @property
    def method(self) -> str:
        """Name of the method."""
        return self.run.method

    @property
    def finite_elements(self) -> bool:
        """Whether the fields are on vertices and cells instead of the rows of a grid."""
        return self.method in FINITE_ELEMENTS

    @property
    def status(self) -> str:
        """The contract's status word, "refused" or "not run"."""
        return str(self.result.get("status", "not run"))

    @property
    def message(self) -> str:
        """The sentence that goes with the status."""
        return str(self.result.get("message", ""))

    @property
    def converged(self) -> bool:
        """Whether the run ended as it should."""
        return self.status == "converged"

    @property
    def drawable(self) -> bool:
        """Whether there is a deformed mesh with finite positions to draw."""
        r = self.fields.get("r")
        return r is not None and r.ndim == 3 and bool(np.isfinite(r).all())

    def value(self, *keys: str) -> float:
        """A number of `result.json`, such as value("energy_N_mm", "total"); NaN if absent or null."""
        found: object = self.result
        for key in keys:
            found = found.get(key) if isinstance(found, Mapping) else None
        return float(found) if isinstance(found, int | float) else float("nan")

    @property
    def closed(self) -> bool:
        """Whether the first mesh direction is closed (annulus and O-mesh)."""
        u = self.fields["u"]
        return bool(self.fields["stretch_major"].shape[0] == u.shape[0])


def read_columns(path: Path) -> Columns:
    """Return the columns of a CSV file with a header; {} if there is none."""
    return read_csv(path) if path.is_file() else {}
