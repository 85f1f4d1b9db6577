"""What is wrong with an input: one `Problem` per key, all of them in one `SceneError`."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

LONGEST_SHOWN = 60
DEEPEST_SHOWN = 8


@dataclass(frozen=True)
class Problem:
    """One thing wrong with an input.

    where : the file, the built-in scene or the option that holds the key.
    key : dotted key, empty for the file as a whole.
    value : the value as text, None for a key that is missing.
    message : what is allowed, with the nearest valid choice.
    """

    where: str
    key: str
    value: str | None
    message: str

    def __str__(self) -> str:
        key = self.key if self.value is None else f"{self.key} = {self.value}"
        return ": ".join(part for part in (self.where, key, self.message) if part)


class SceneError(ValueError):
    """A scene that cannot be used; `problems` has every reason.

    str() gives one line per problem.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


def shown(value: object) -> str:
    """A value as one short line of printable ASCII, whatever it is.

    Files come from anywhere: control characters would reach the terminal, and a long value would bury the
    message.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        text = json.dumps(value[: LONGEST_SHOWN + 1])
    elif isinstance(value, int) and value.bit_length() > 128:
        text = f"a whole number of about {int(value.bit_length() * 0.30103) + 1} digits"
    elif isinstance(value, dict):
        text = "a table"
    elif isinstance(value, (list, tuple)):
        text = "[" + ", ".join(shown(item) for item in value[:8]) + (", ...]" if len(value) > 8 else "]")
    else:
        text = ascii(value) if isinstance(value, (int, float)) else ascii(str(value))
    return text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "..."


def shown_key(parts: Iterable[object]) -> str:
    """A dotted key; parts that are not plain words are quoted."""
    words = [str(part) for part in parts]
    text = ".".join(word if _is_plain(word) else shown(word) for word in words[:DEEPEST_SHOWN])
    return text if len(words) <= DEEPEST_SHOWN else text + "..."


def _is_plain(word: str) -> bool:
    return (
        0 < len(word) <= LONGEST_SHOWN and word.isascii() and word.replace("-", "").replace("_", "").isalnum()
    )


def nearest(word: str, choices: Sequence[str]) -> str | None:
    """The choice most like `word`, ignoring case and the kind of dash; None if none is alike."""
    plain = {_folded(choice): choice for choice in choices}
    alike = difflib.get_close_matches(_folded(word[:80]), list(plain), n=1, cutoff=0.5)
    return plain[alike[0]] if alike else None


def _folded(word: str) -> str:
    return word.lower().replace("-", "_").replace(" ", "_")


def did_you_mean(word: str, choices: Sequence[str]) -> str:
    """The clause `; did you mean "x"?`, empty when nothing is alike."""
    choice = nearest(word, choices)
    return f'; did you mean "{choice}"?' if choice else ""


def one_of(choices: Sequence[str]) -> str:
    """The choices as `"a", "b" or "c"`."""
    quoted = [f'"{choice}"' for choice in choices]
    return quoted[0] if len(quoted) == 1 else ", ".join(quoted[:-1]) + " or " + quoted[-1]
