"""Scenes: load, check, write back, identify."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from cases.checks import check
from cases.lines import default_paths, default_sections
from cases.overrides import Overrides, apply, read_overrides
from cases.problems import Problem, SceneError
from cases.read import DEEPEST, read_document, scene_names, too_deep
from cases.scene_text import scene_hash, scene_toml
from cases.schema import Edge, Scene
from cases.validate import Reading, read_tables

__all__ = ["Problem", "Scene", "SceneError", "load_scene", "scene_hash", "scene_names", "scene_toml"]


def load_scene(name_or_path: str | Path, overrides: Overrides = ()) -> Scene:
    """A built-in scene or a TOML file, checked and complete.

    overrides : `KEY=VALUE` strings as of `--set`, or a mapping of dotted keys to values.

    Raises SceneError with every problem found.
    """
    values, problems = read_overrides(overrides)
    where, name, document = read_document(name_or_path)
    problems += apply(document, values)
    reading = Reading(where, frozenset(values))
    if too_deep(document):
        raise SceneError([*problems, Problem(where, "", None, f"nested deeper than {DEEPEST} levels")])
    read_tables(document, reading)
    check(reading)
    if problems or reading.problems:
        raise SceneError(problems + reading.problems)
    return _complete(name, document, reading.tables)


def _complete(name: str, document: dict[str, Any], tables: dict[str, Any]) -> Scene:
    """The scene with the defaults of its shape."""
    sheet, heading = tables["sheet"], tables["heading"]
    given = tables["edges"] or {}
    own_name = heading.name or re.sub(r"[^A-Za-z0-9_-]+", "-", name)[:64].strip("-") or "scene"
    return Scene(
        name=own_name,
        title=heading.title or own_name,
        sheet=sheet,
        material=tables["material"],
        edges={edge: given.get(edge, Edge()) for edge in sheet.edge_names},
        start=tables["start"],
        effects=tables["effects"],
        symmetry=tables["symmetry"],
        mesh=tables["mesh"],
        solver=tables["solver"],
        sections=default_sections(sheet) if tables["sections"] is None else tables["sections"],
        paths=default_paths(sheet) if tables["paths"] is None else tables["paths"],
        assumed=_assumed(document, sheet, tables["material"]),
    )


def _assumed(document: dict[str, Any], sheet: Any, material: Any) -> tuple[str, ...]:
    """Physical keys left to their defaults; a run names them, so that nobody takes them for given."""
    return tuple(
        f"{table}.{key}"
        for table, model in (("sheet", sheet), ("material", material))
        for key in type(model).model_fields
        if key not in document.get(table, {})
    )
