"""Result folders: everything that a solve leaves behind, and how it is read back."""

from __future__ import annotations

import json
import shutil
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cases.bicubic import sample_bicubic_section
from cases.checksums import check_files, document_is_damaged, sealed
from cases.errors import errors_of
from cases.files import (
    json_text,
    read_csv,
    read_fields,
    read_snapshots,
    write_csv,
    write_fields,
    write_snapshots,
    write_vtu,
)
from cases.folders import write_folder
from cases.machine import code, machine, peak_memory_MB, versions
from cases.probe import Columns, Section, measure_section, nodes_per_wrinkle, path_columns, sample_section
from cases.scene_text import scene_toml
from cases.schema import Line, Scene
from cases.unstructured import AnySolution, FiniteElementMesh, FiniteElementSolution
from cases.unstructured_files import read_cells, write_cells
from cases.unstructured_probe import path_columns as cell_path_columns
from cases.unstructured_probe import sample_section as sample_cell_section
from fdsolver.checkpoint import UNREADABLE
from fdsolver.grid import Grid, quality
from fdsolver.material import Sheet
from fdsolver.result import Reaction, Solution, Status

CHECKPOINT_NAME = "checkpoint.npz"


class ResultError(ValueError):
    """A folder that holds no result, or a damaged one; the message is one sentence."""


@dataclass(frozen=True)
class Probes:
    """What was measured along the lines of a scene.

    paths : name -> columns of paths/NAME.csv. sections : name -> profile. nodes_per_wrinkle : None for a flat
        sheet.
    """

    paths: Mapping[str, Columns]
    sections: Mapping[str, Section]
    nodes_per_wrinkle: float | None


def probe(solution: AnySolution, scene: Scene) -> Probes:
    """Measure a solution along the paths and sections of its scene; nothing if a position is not finite.

    Raises ProbeError for a line off the sheet.
    """
    if not np.isfinite(solution.r).all():
        return Probes({}, {}, None)
    lines = scene.sections.items()
    if isinstance(solution, FiniteElementSolution):
        paths = {name: cell_path_columns(solution, name, line) for name, line in scene.paths.items()}
        sections = {name: _cell_section(solution, line) for name, line in lines}
    else:
        paths = {name: path_columns(solution, name, line) for name, line in scene.paths.items()}
        sections = {name: sample_section(solution.grid, solution.r, line) for name, line in lines}
    return Probes(paths, sections, nodes_per_wrinkle(sections.values(), solution.sheet.thickness_mm))


def _cell_section(solution: FiniteElementSolution, line: Line) -> Section:
    """From the field inside the elements where the result has its derivatives, else between vertices."""
    if solution.derivatives is not None:
        return sample_bicubic_section(solution, line)
    return sample_cell_section(solution.grid, solution.r, line)


def result_document(
    solution: AnySolution, scene: Scene, probes: Probes, effects: Mapping[str, Any], scene_hash: str
) -> dict[str, Any]:
    """The contract's keys of result.json; `mesh` (counts and quality) and `levels` (nested meshes) are our
    additions, as are the checksums that `write_result` puts in.
    """
    grid, zone = solution.grid, solution.zone
    z = solution.r[..., 2]
    mean_square = float((grid.node_area * z**2).sum() / grid.node_area.sum())
    thickness = solution.sheet.thickness_mm
    return {
        "scene": scene.name,
        "method": solution.method,
        "status": solution.status.value,
        "message": solution.message,
        "nodes": grid.nodes,
        "zones": grid.zones,
        "steps": solution.steps,
        "force_evaluations": solution.force_evaluations,
        "residual": solution.residual,
        "seconds": solution.seconds,
        "cpu_seconds": solution.cpu_seconds,
        "seconds_compile": solution.seconds_compile,
        "peak_memory_MB": peak_memory_MB(),
        "energy_N_mm": {"total": None, "membrane": None, "bending": None, **solution.energy_N_mm},
        "reactions": {edge: asdict(reaction) for edge, reaction in solution.reactions.items()},
        "stretch": {
            "major_max": zone.stretch_major.max(),
            "major_min": zone.stretch_major.min(),
            "minor_min": zone.stretch_minor.min(),
        },
        "out_of_plane_mm": {"max_abs": np.abs(z).max(), "rms": np.sqrt(mean_square)},
        "hourglass": {part: solution.hourglass.get(part) for part in ("out_of_plane", "in_plane")},
        "nodes_per_wrinkle": probes.nodes_per_wrinkle,
        "stability": {part: solution.stability.get(part) for part in ("stable", "how", "lowest")},
        "effects": effects,
        "errors": _errors(solution, scene),
        "warnings": solution.warnings,
        "sections": {
            name: asdict(measure_section(section, thickness)) for name, section in probes.sections.items()
        },
        "buckling": {"critical": solution.critical if isinstance(solution, FiniteElementSolution) else []},
        "versions": versions(),
        "machine": machine(),
        "threads": solution.threads,
        "seed": solution.seed,
        "code": code(),
        "scene_hash": scene_hash,
        "mesh": _mesh_document(grid),
        "levels": solution.levels,
    }


def _mesh_document(grid: Grid | FiniteElementMesh) -> dict[str, Any]:
    """Counts and quality of a mesh; `cells` tells a finite-element mesh from a grid."""
    if isinstance(grid, FiniteElementMesh):
        kind = "triangles" if grid.cells.shape[1] == 3 else "quadrilaterals"
        return {"cells": kind, "smallest_zone_area_mm2": grid.zone_area.min()}
    return {"ni": grid.ni, "nj": grid.nj, **asdict(quality(grid))}


def _errors(solution: AnySolution, scene: Scene) -> Sequence[Mapping[str, Any]]:
    """The estimated errors of a solution, in the form of result.json."""
    if isinstance(solution, FiniteElementSolution):
        return solution.errors
    return [asdict(error) for error in errors_of(solution, scene)]


def write_result(
    folder: Path,
    solution: AnySolution,
    scene: Scene,
    probes: Probes,
    effects: Mapping[str, Any],
    scene_hash: str,
    keep_checkpoint: bool = False,
) -> None:
    """Write a whole result folder in place of what is there.

    keep_checkpoint : carry the folder's checkpoint over (a run that can go on).

    Raises StorageError; the old folder is then unchanged.
    """
    document = result_document(solution, scene, probes, effects, scene_hash)

    def fill(new: Path) -> None:
        (new / "scene.toml").write_text(scene_toml(scene), encoding="utf-8")
        if isinstance(solution, FiniteElementSolution):
            write_cells(new / "fields.npz", solution)
        else:
            write_fields(new / "fields.npz", solution)
        write_csv(new / "history.csv", solution.history)
        write_vtu(new / "sheet.vtu", solution)
        if solution.snapshots:
            write_snapshots(new / "snapshots.npz", solution.snapshots)
        for kind in ("paths", "sections"):
            (new / kind).mkdir()
        for name, columns in probes.paths.items():
            write_csv(new / "paths" / f"{name}.csv", columns)
        for name, section in probes.sections.items():
            write_csv(new / "sections" / f"{name}.csv", section.columns())
        (new / "result.json").write_text(json_text(sealed(document, new)), encoding="utf-8")
        if keep_checkpoint and (folder / CHECKPOINT_NAME).exists():
            shutil.copy2(folder / CHECKPOINT_NAME, new / CHECKPOINT_NAME)

    write_folder(folder, fill)


def read_document(folder: Path | str) -> dict[str, Any]:
    """The result.json of a result folder. Raises ResultError if there is none or it is damaged."""
    path = Path(folder) / "result.json"
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ResultError(f"{folder} holds no result: there is no result.json.") from None
    except (OSError, ValueError, RecursionError) as reason:
        raise ResultError(f"{path} cannot be read: {reason}.") from reason
    if not isinstance(document, dict) or "status" not in document:
        raise ResultError(f"{path} is not the result.json of a result folder.")
    if document_is_damaged(document):
        raise ResultError(f"{path} is damaged: it is not what was written.")
    return document


def load_result(folder: Path | str) -> AnySolution:
    """The Solution (of a finite-element method: FiniteElementSolution) that a result folder stores.

    Raises ResultError for a folder that holds no result, or a damaged one.
    """
    folder = Path(folder)
    document = read_document(folder)
    try:
        check_files(folder, document)
        return _solution(folder, document)
    except (*UNREADABLE, TypeError) as reason:
        text = f"{reason} is missing" if isinstance(reason, KeyError) else str(reason)
        raise ResultError(f"The result folder {folder} is damaged: {text}.") from reason


def _solution(folder: Path, document: dict[str, Any]) -> AnySolution:
    scene = tomllib.loads((folder / "scene.toml").read_text(encoding="utf-8"))
    material = scene["material"]
    reactions = {
        edge: Reaction(np.array(part["force_N"], dtype=float), np.array(part["moment_N_mm"], dtype=float))
        for edge, part in document["reactions"].items()
    }
    common: dict[str, Any] = {
        "method": document["method"],
        "status": _status(document["status"]),
        "message": document["message"],
        "sheet": Sheet(material["young_MPa"], material["poisson"], scene["sheet"]["thickness_mm"]),
        "residual": _number(document["residual"]),
        "energy_N_mm": {part: _number(value) for part, value in document["energy_N_mm"].items()},
        "reactions": reactions,
        "history": read_csv(folder / "history.csv"),
        "warnings": tuple(document["warnings"]),
        "levels": tuple(document["levels"]),
        "snapshots": read_snapshots(folder / "snapshots.npz"),
        **{key: document[key] for key in _UNCHANGED},
    }
    if "cells" in document["mesh"]:
        stored = read_cells(folder / "fields.npz")
        critical, errors = document["buckling"]["critical"], document["errors"]
        return FiniteElementSolution(**common, **vars(stored), critical=tuple(critical), errors=tuple(errors))
    grid, r, zone = read_fields(folder / "fields.npz")
    return Solution(**common, grid=grid, r=r, zone=zone)


_UNCHANGED = (
    "steps",
    "force_evaluations",
    "seconds",
    "cpu_seconds",
    "seconds_compile",
    "hourglass",
    "stability",
    "threads",
    "seed",
)


def _status(word: str) -> Status:
    """The Status of this value."""
    for status in Status:
        if status.value == word:
            return status
    raise ValueError(f"there is no status {word!r}")


def _number(value: float | None) -> float:
    """What JSON stores as null was not finite."""
    return float("nan") if value is None else float(value)
