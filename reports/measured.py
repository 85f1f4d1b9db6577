"""Documents that benchmarks and campaigns leave for the report."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def read_document(path: Path) -> Any:
    """What a JSON file says; None if there is none, or one that is damaged or still being written."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
