"""Changes of single keys: `--set edges.inner.move_mm=[0,0,80]`, or a mapping of dotted keys in Python."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from cases.problems import Problem, shown, shown_key

WHERE = "--set"
BARE_WORD = re.compile(r"[A-Za-z0-9_./:+~%-][A-Za-z0-9_./:+~% -]*")
Overrides = Mapping[str, object] | Sequence[str]


def read_overrides(overrides: Overrides) -> tuple[dict[str, object], list[Problem]]:
    """Dotted keys and their values, and what could not be read; a later one of the same key wins."""
    if isinstance(overrides, Mapping):
        return {str(key): plain(value) for key, value in overrides.items()}, []
    values: dict[str, object] = {}
    problems = []
    for text in [overrides] if isinstance(overrides, str) else overrides:
        key, equals, word = text.partition("=")
        if not equals or not key.strip():
            problems.append(
                Problem(WHERE, "", None, f"{shown(text)} must be KEY=VALUE, as in mesh.nodes=20000")
            )
            continue
        try:
            values[key.strip()] = toml_value(word)
        except ValueError:
            allowed = 'must be a TOML value (80, [0, 0, 80], "text") or one bare word'
            problems.append(Problem(WHERE, shown_key(key.strip().split(".")), shown(word), allowed))
    return values, problems


def toml_value(text: str) -> object:
    """A TOML value, or a bare word as a string. Raises ValueError for anything else."""
    text = text.strip()
    if "\n" in text or "\r" in text or len(text) > 100_000:
        raise ValueError("more than one line")
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        if BARE_WORD.fullmatch(text):
            return text
        raise ValueError("not a TOML value") from None
    return parsed["value"]


def plain(value: object) -> object:
    """A Python value as TOML has it: numpy scalars, arrays and tuples become numbers and lists."""
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    return value


def apply(document: dict[str, Any], values: Mapping[str, object]) -> list[Problem]:
    """Set dotted keys in a parsed scene, in place; tables are made as needed."""
    problems = []
    for dotted, value in values.items():
        parts = [part.strip() for part in dotted.split(".")]
        if not all(parts) or len(parts) > 8:
            message = "must be a dotted key of words, as in edges.top.move_mm"
            problems.append(Problem(WHERE, shown_key(parts), shown(value), message))
            continue
        table: Any = document
        for part in parts[:-1]:
            table = table.setdefault(part, {}) if isinstance(table, dict) else None
        if isinstance(table, dict):
            table[parts[-1]] = value
        else:
            message = f"{shown_key(parts[:-1])} is a value, not a table"
            problems.append(Problem(WHERE, shown_key(parts), shown(value), message))
    return problems
