"""Checksums of a result folder: what a disk or an editor changed in it is noticed, not taken for a result.

`result.json` holds them under `sha256`, its own among them. A folder of a version that wrote none is not checked.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cases.files import json_text

KEY = "sha256"
DOCUMENT = "result.json"


def sealed(document: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The document with the checksums of itself and of the files that are in `folder`; names with / as separator."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    sums = {path.relative_to(folder).as_posix(): _sum(path.read_bytes()) for path in files}
    return {**document, KEY: {**sums, DOCUMENT: _own(document)}}


def document_is_damaged(document: Mapping[str, Any]) -> bool:
    """Whether a document that was read has another checksum than the one that is in it."""
    sums = document.get(KEY)
    return sums is not None and (not isinstance(sums, dict) or sums.get(DOCUMENT) != _own(document))


def check_files(folder: Path, document: Mapping[str, Any]) -> None:
    """Raise ValueError or OSError for a file of a result folder that is not what was written."""
    for name, expected in document.get(KEY, {}).items():
        if name != DOCUMENT and _sum((folder / name).read_bytes()) != expected:
            raise ValueError(f"{name} is not what was written")


def _own(document: Mapping[str, Any]) -> str:
    return _sum(json_text({key: value for key, value in document.items() if key != KEY}).encode())


def _sum(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
