"""Words of the command line and of files, between backticks in the report's texts: as code, or without the marks."""

from __future__ import annotations

import re

_CODE = re.compile(r"`([^`\n]+)`")


def plain(text: str) -> str:
    """The text without the marks; a single backtick is none."""
    return _CODE.sub(r"\1", text)


def pieces(text: str) -> list[tuple[str, bool]]:
    """The text in pieces, each with whether it is code; no piece is empty."""
    parts = _CODE.split(text)
    return [(part, k % 2 == 1) for k, part in enumerate(parts) if part]
