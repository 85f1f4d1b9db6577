"""From a parsed document to typed tables: every wrong key becomes one sentence, and none hides another."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, Field, ValidationError
from pydantic.fields import FieldInfo

from cases.problems import Problem, did_you_mean, nearest, one_of, shown, shown_key
from cases.schema import (
    NAME_ALLOWED,
    NAME_PATTERN,
    SHAPES,
    AnnulusSheet,
    Edge,
    Effects,
    HoleSheet,
    Line,
    Material,
    Mesh,
    Name,
    RectangleSheet,
    Solver,
    Start,
    Symmetry,
    Table,
    Title,
)


class Heading(Table):
    """The keys above the first table."""

    name: Name | None = Field(default=None, description=NAME_ALLOWED)
    title: Title = ""


class AnySheetKeys(AnnulusSheet, HoleSheet, RectangleSheet):
    """The keys of all shapes, to check the rest of a sheet whose shape is wrong."""

    shape: Any = None


SINGLE: dict[str, type[Table]] = {
    "material": Material,
    "start": Start,
    "effects": Effects,
    "symmetry": Symmetry,
    "mesh": Mesh,
    "solver": Solver,
}
NAMED: dict[str, type[Table]] = {"edges": Edge, "sections": Line, "paths": Line}
HEADING = ("title", "name")
TOP_LEVEL = (*HEADING, "sheet", *SINGLE, *NAMED)


@dataclass
class Reading:
    """What has been understood of a document, and what is wrong with it.

    where : the file or built-in scene; keys in `changed` came from the command line instead.
    tables : key of the scene -> its checked model (or mapping of models); None where something was wrong.
    shape : model of the sheet, known even if one of its numbers is wrong.
    """

    where: str
    changed: frozenset[str] = frozenset()
    tables: dict[str, Any] = field(default_factory=dict)
    shape: type[RectangleSheet] | type[HoleSheet] | type[AnnulusSheet] | None = None
    problems: list[Problem] = field(default_factory=list)

    def wrong(self, parts: tuple[object, ...], value: str | None, message: str) -> None:
        """Record a problem at a key, with the place where the key was given."""
        words = [str(part) for part in parts]
        above = {".".join(words[:count]) for count in range(1, len(words) + 1)}
        below = ".".join(words) + "."
        given = any(key in above or key.startswith(below) for key in self.changed)
        self.problems.append(Problem("--set" if given else self.where, shown_key(words), value, message))


def read_tables(document: Mapping[str, Any], reading: Reading) -> None:
    """Check all tables of a document; results and problems go into `reading`."""
    for key, value in document.items():
        if key not in TOP_LEVEL:
            reading.wrong((key,), shown(value), _unknown(key, TOP_LEVEL, ()))
    heading = {key: document[key] for key in HEADING if key in document}
    reading.tables["heading"] = checked(Heading, heading, (), reading)
    reading.tables["sheet"] = _checked_sheet(document.get("sheet", {}), reading)
    for key, model in SINGLE.items():
        reading.tables[key] = checked(model, document.get(key, {}), (key,), reading)
    for key, model in NAMED.items():
        reading.tables[key] = _checked_named(model, document.get(key), key, reading)


def _checked_sheet(table: Any, reading: Reading) -> Table | None:
    shape = table.get("shape", "rectangle") if isinstance(table, dict) else "rectangle"
    if isinstance(shape, str) and shape in SHAPES:
        reading.shape = SHAPES[shape]
        return checked(SHAPES[shape], table, ("sheet",), reading)
    guess = did_you_mean(shape, tuple(SHAPES)) if isinstance(shape, str) else ""
    reading.wrong(("sheet", "shape"), shown(shape), f"must be {one_of(tuple(SHAPES))}{guess}")
    checked(AnySheetKeys, table, ("sheet",), reading)
    return None


def _checked_named(model: type[Table], table: Any, key: str, reading: Reading) -> dict[str, Any] | None:
    """A table of tables with free names, `[edges.NAME]`; None if it is absent or wrong as a whole."""
    if table is None:
        return None
    if not isinstance(table, dict):
        reading.wrong((key,), shown(table), f"must be tables, as in [{key}.NAME]")
        return None
    entries = {}
    for name, entry in table.items():
        if not NAME_PATTERN.fullmatch(name):
            reading.wrong((key, name), shown(entry), f"the name must be of {NAME_ALLOWED}")
        entries[name] = checked(model, entry, (key, name), reading)
    return entries


def checked(model: type[Table], table: Any, place: tuple[str, ...], reading: Reading) -> Table | None:
    """The table as its model, or None with the problems recorded."""
    if not isinstance(table, dict):
        reading.wrong(place, shown(table), f"must be a table, as in [{shown_key(place)}]")
        return None
    try:
        return model.model_validate(table)
    except ValidationError as error:
        keys = dict.fromkeys(
            str(item["loc"][0]) for item in error.errors(include_url=False, include_context=False)
        )
        for key in keys:
            _record(model, key, table, place, error, reading)
        return None


def _record(
    model: type[Table],
    key: str,
    table: Mapping[str, Any],
    place: tuple[str, ...],
    error: ValidationError,
    reading: Reading,
) -> None:
    """One problem for a key, however many errors its value has."""
    fields = fields_of(model)
    value = shown(table[key]) if key in table else None
    if key not in fields:
        reading.wrong((*place, key), value, _unknown(key, tuple(fields), place))
        return
    reading.wrong(
        (*place, key), value, f"must be {allowed(fields[key])}{_nearest_value(fields[key], table.get(key))}"
    )


def fields_of(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """The keys of a table as files spell them."""
    return {info.alias or name: info for name, info in model.model_fields.items()}


def choices_of(info: FieldInfo) -> tuple[str, ...]:
    """The words that a key may have, empty for a key that is not a choice."""
    if get_origin(info.annotation) is Literal:
        return tuple(str(choice) for choice in get_args(info.annotation))
    extra = info.json_schema_extra
    words = extra.get("choices") if isinstance(extra, dict) else None
    return tuple(str(word) for word in words) if isinstance(words, list) else ()


def allowed(info: FieldInfo) -> str:
    """What a key may be, completing "must be ..."."""
    if info.annotation is bool:
        return "true or false"
    return info.description or one_of(choices_of(info))


def _nearest_value(info: FieldInfo, value: Any) -> str:
    """The nearest word of a choice, or the nearest end of a range that contains its ends."""
    if isinstance(value, str):
        return did_you_mean(value, choices_of(info))
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value != value:
        return ""
    if value in (math.inf, -math.inf):
        return ""
    for limit in info.metadata:
        low, high = getattr(limit, "ge", None), getattr(limit, "le", None)
        if low is not None and value < low:
            return f"; the nearest is {shown(low)}"
        if high is not None and value > high:
            return f"; the nearest is {shown(high)}"
    return ""


def _unknown(key: str, keys: tuple[str, ...], place: tuple[str, ...]) -> str:
    """The sentence for an unknown key: the nearest one here, or where it belongs, or what is allowed."""
    at_home = [home for home in _homes(key) if home.rpartition(".")[0] != ".".join(place)]
    if at_home and nearest(key, keys) is None:
        return f"unknown key here; did you mean {one_of(at_home)}?"
    if nearest(key, keys) is not None:
        return f"unknown key{did_you_mean(key, keys)}"
    return f"unknown key; allowed are {', '.join(keys)}"


def _homes(key: str) -> list[str]:
    """Dotted keys of a scene whose last word is `key`."""
    models: dict[tuple[str, ...], type[Table]] = {
        ("sheet",): AnySheetKeys,
        **{(name,): SINGLE[name] for name in SINGLE},
    }
    homes = [".".join((*place, key)) for place, model in models.items() if key in fields_of(model)]
    return homes + [f"{name}.NAME.{key}" for name, model in NAMED.items() if key in fields_of(model)]
