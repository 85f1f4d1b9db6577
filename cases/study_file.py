"""Study files: one scene, keys with lists of values, methods, meshes and seeds.

[study]
scene = "stretch"                  # a built-in scene, or a scene file seen from this file's folder
methods = ["koiter", "membrane"]   # default: all that fit the scene
nodes = [5000, 20000]              # default: the scene's
seeds = [0, 1]                     # default: [0]; methods without a random start run with the first alone

[vary]                             # every combination; or [[point]] tables of single values, one per point
sheet.thickness_mm = [0.05, 0.1]
edges.top.move_mm = [[0, 12.7, 0], [0, 25.4, 0]]
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from cases.problems import Problem, SceneError, did_you_mean, nearest, one_of, shown
from cases.read import file_bytes, parse
from cases.schema import LARGEST_NODES, SMALLEST_NODES, Table, Title
from cases.study_points import MOST_POINTS, Choices, Point, make_points, scene_source
from cases.validate import Reading, checked

TABLES = ("study", "vary", "point")
LONGEST_LIST = 1000


def _tuple_of(value: object) -> object:
    """A TOML array as the tuple that the model holds."""
    return tuple(value) if isinstance(value, list) else value


NodeCount = Annotated[int, Field(ge=SMALLEST_NODES, le=LARGEST_NODES)]
Seed = Annotated[int, Field(ge=0, lt=2**63)]


class StudyTable(Table):
    """The table [study]."""

    scene: str = Field(
        min_length=1, max_length=4096, description="a built-in scene or the path of a scene file"
    )
    title: Title = ""
    methods: Annotated[
        tuple[str, ...] | None,
        BeforeValidator(_tuple_of),
        Field(min_length=1, max_length=LONGEST_LIST, description="a list of methods"),
    ] = None
    nodes: Annotated[
        tuple[NodeCount, ...] | None,
        BeforeValidator(_tuple_of),
        Field(
            min_length=1,
            max_length=LONGEST_LIST,
            description=f"a list of whole numbers from {SMALLEST_NODES} to {LARGEST_NODES}",
        ),
    ] = None
    seeds: Annotated[
        tuple[Seed, ...],
        BeforeValidator(_tuple_of),
        Field(
            min_length=1,
            max_length=LONGEST_LIST,
            description=f"a list of whole numbers from 0 to {2**63 - 1}",
        ),
    ] = (0,)


@dataclass(frozen=True)
class Study:
    """A study, checked. keys : the dotted scene keys that vary. text : the file as it was."""

    name: str
    title: str
    scene: str
    keys: tuple[str, ...]
    points: tuple[Point, ...]
    text: bytes


@cache
def study_names() -> tuple[str, ...]:
    """Names of the built-in studies."""
    folder = resources.files("cases") / "data" / "studies"
    names = [entry.name for entry in folder.iterdir()]
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


def load_study(source: str | Path) -> Study:
    """A built-in study or a study file with all its points. Raises SceneError with every problem found."""
    where, name, folder, content = _content(source)
    document = parse(content, where)
    reading = Reading(where)
    for key, value in document.items():
        if key not in TABLES:
            message = f"unknown key; allowed are {', '.join(TABLES)}{did_you_mean(key, TABLES)}"
            reading.wrong((key,), shown(value), message)
    changes = _changes(document, reading)
    raw = document.get("study", {})
    table = checked(StudyTable, raw, ("study",), reading)
    # what is wrong with the table must not hide what is wrong with the scene or the methods
    rough = raw if isinstance(raw, dict) else {}
    scene, choices = _scene(rough, folder), _choices(table, rough)
    points: tuple[Point, ...] = ()
    try:
        points = make_points(scene, changes, choices, where) if scene else ()
    except SceneError as error:
        reading.problems += error.problems
    if reading.problems or not isinstance(table, StudyTable):
        raise SceneError(dict.fromkeys(reading.problems))
    keys = tuple(dict.fromkeys(key for change in changes for key in change))
    return Study(name, table.title or name, scene, keys, points, content)


def _scene(table: Mapping[str, Any], folder: Path | None) -> str:
    """The scene of a table [study], "" where there is none to look for."""
    scene = table.get("scene")
    return scene_source(scene, folder) if isinstance(scene, str) and scene else ""


def _choices(table: Table | None, rough: Mapping[str, Any]) -> Choices:
    """The choices of a table; of a wrong one, the methods that are words."""
    if isinstance(table, StudyTable):
        return Choices(table.methods, table.nodes, table.seeds)
    methods = rough.get("methods")
    return Choices([word for word in methods if isinstance(word, str)] if isinstance(methods, list) else None)


def _content(source: str | Path) -> tuple[str, str, Path | None, bytes]:
    """(where, name, folder, text) of a built-in study or a file."""
    if isinstance(source, str) and source in study_names():
        return (
            source,
            source,
            None,
            (resources.files("cases") / "data" / "studies" / f"{source}.toml").read_bytes(),
        )
    path = Path(source)
    where = str(source) if str(source).isprintable() else shown(str(source))
    try:
        there = path.exists()
    except (OSError, ValueError):  # a name too long, or with a zero byte
        there = False
    if not there:
        near = nearest(path.stem, study_names())
        hint = f'did you mean "{near}"?' if near else f"built-in are {one_of(study_names())}"
        raise SceneError([Problem(where, "", None, f"there is no study or file of this name; {hint}")])
    return where, path.stem, path.parent, file_bytes(path, where)


def _changes(document: Mapping[str, Any], reading: Reading) -> list[dict[str, object]]:
    """The sets of changed scene keys, one per point: a single empty one where nothing varies."""
    vary, listed = document.get("vary"), document.get("point")
    if vary is not None and listed is not None:
        reading.wrong(("vary",), None, "a study has [vary] or [[point]], not both")
    if listed is not None:
        if not isinstance(listed, list) or not all(isinstance(entry, dict) for entry in listed):
            reading.wrong(("point",), shown(listed), "must be tables, as in [[point]]")
            return []
        return [dict(_leaves(entry)) for entry in listed]
    if not isinstance(vary, dict | None):
        reading.wrong(("vary",), shown(vary), "must be a table, as in [vary]")
        return []
    lists: dict[str, list[object]] = {}
    for key, values in _leaves(vary or {}):
        if isinstance(values, list) and 0 < len(values) <= LONGEST_LIST:
            lists[key] = values
        else:
            message = f"must be a list of values, one to {LONGEST_LIST} of them"
            reading.wrong(("vary", *key.split(".")), shown(values), message)
    count = math.prod(len(values) for values in lists.values())
    if count > MOST_POINTS:
        reading.wrong(("vary",), None, f"has {count} combinations; at most {MOST_POINTS} are allowed")
        return []
    return [dict(zip(lists, combination, strict=True)) for combination in itertools.product(*lists.values())]


def _leaves(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, object]]:
    """Dotted keys and values: `a.b = 1` and `"a.b" = 1` are the same."""
    for key, value in table.items():
        dotted = f"{above}{key}"
        if isinstance(value, dict):
            yield from _leaves(value, f"{dotted}.")
        else:
            yield dotted, value
