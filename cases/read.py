"""Find and parse scene files: built-in names or paths, with everything that can be wrong with a file."""

from __future__ import annotations

import re
import stat
import tomllib
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from cases.problems import Problem, SceneError, nearest, one_of, shown

LARGEST_FILE = 1_000_000
DEEPEST = 8
# Found before parsing: the time of the parser grows with the square of the number of parts of a dotted key.
TOO_DEEP_KEY = re.compile(rf"""[\w"'-](?:[ \t]*\.[ \t]*[\w"'-]+){{{DEEPEST + 1},}}""")


@cache
def scene_names() -> tuple[str, ...]:
    """Names of the built-in scenes, in the order of `wrinkle list`: the paper's, then the ladder."""
    first = ("stretch", "shear", "hole", "annulus")
    found = {
        entry.name.removesuffix(".toml")
        for entry in (resources.files("cases") / "data").iterdir()
        if entry.name.endswith(".toml")
    }
    return tuple(name for name in first if name in found) + tuple(sorted(found - set(first)))


def read_document(source: str | Path) -> tuple[str, str, dict[str, Any]]:
    """(where, name, parsed document) of a built-in scene or a file. Raises SceneError."""
    if isinstance(source, str) and source in scene_names():
        text = (resources.files("cases") / "data" / f"{source}.toml").read_bytes()
        return source, source, parse(text, source)
    where = _place(str(source))
    return where, Path(source).stem, parse(file_bytes(source, where), where)


def _place(source: str) -> str:
    """The source as it stands in messages: as typed, with anything unprintable quoted."""
    return source if source.isascii() and source.isprintable() and 0 < len(source) <= 200 else shown(source)


def file_bytes(source: str | Path, where: str) -> bytes:
    """The content of a regular file of a sensible size. Raises SceneError."""
    path = Path(source)
    try:
        mode = path.stat().st_mode
        content = _read_regular(path) if stat.S_ISREG(mode) else b""
    except (FileNotFoundError, NotADirectoryError):
        raise _refused(where, _missing(str(source))) from None
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the name
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise _refused(where, f"cannot be read: {reason}") from None
    if stat.S_ISDIR(mode):
        inside = " (it contains scene.toml)" if (path / "scene.toml").exists() else ""
        raise _refused(where, f"is a folder; give the scene file in it{inside}")
    if not stat.S_ISREG(mode):
        raise _refused(where, "is not a regular file")
    if len(content) > LARGEST_FILE:
        raise _refused(where, f"is larger than {LARGEST_FILE} bytes; a scene file is a few lines of text")
    return content


def _read_regular(path: Path) -> bytes:
    """The content, at most one byte more than is allowed."""
    with path.open("rb") as file:
        return file.read(LARGEST_FILE + 1)


def _missing(source: str) -> str:
    names = scene_names()
    if source.endswith(".toml") or "/" in source:
        name = nearest(Path(source).stem, names)
        hint = f'; the nearest built-in scene is "{name}"' if name else ""
        return f"there is no such file{hint}"
    name = nearest(source, names)
    hint = f'; did you mean "{name}"?' if name else ""
    return f"there is no scene or file of this name{hint}{'' if name else f'; built-in are {one_of(names)}'}"


def parse(content: bytes, where: str) -> dict[str, Any]:
    """TOML bytes as nested dictionaries. Raises SceneError for anything but shallow TOML."""
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise _refused(where, f"is not a text file: line {line} is not UTF-8") from None
    if "\0" in text:
        raise _refused(where, "is not a text file: it contains zero bytes")
    too_deep_here = f"is nested too deeply; at most {DEEPEST} levels are allowed"
    if TOO_DEEP_KEY.search(text):
        raise _refused(where, too_deep_here)
    try:
        document = tomllib.loads(text)
    except RecursionError:
        raise _refused(where, too_deep_here) from None
    except ValueError as error:  # TOMLDecodeError, and whole numbers of thousands of digits
        raise _refused(where, f"is not valid TOML: {_printable(str(error))}") from None
    if too_deep(document):
        raise _refused(where, too_deep_here)
    return document


def too_deep(document: object) -> bool:
    """Whether tables and arrays nest deeper than any scene needs; walks level by level, without recursion."""
    level = [document]
    for _ in range(DEEPEST + 1):
        inner: list[object] = []
        for value in level:
            if isinstance(value, dict):
                inner.extend(value.values())
            elif isinstance(value, list):
                inner.extend(value)
        if not inner:
            return False
        level = inner
    return True


def _printable(text: str) -> str:
    return "".join(character if character.isprintable() else " " for character in text)[:200]


def _refused(where: str, message: str) -> SceneError:
    return SceneError([Problem(where, "", None, message)])
