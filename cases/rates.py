"""How fast this machine steps: node-steps per CPU second of a kernel, measured once and kept in the user's cache."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

from fdsolver.checkpoint import StorageError, make_folder, write_atomically
from fdsolver.meshes import annulus
from fdsolver.model import Model

NODES = 10_000  # of the mesh that is stepped
SECONDS = 0.5  # spent on it


def rate(model: Model) -> float:
    """Node-steps per CPU second of a model's kernel on this machine, from the user's cache or measured now."""
    kind = "plate" if model.bending else "membrane"
    key = f"{model.law.__name__} {kind} {model.components} {model.curvature}"
    key += " moderate" if model.moderate else " finite"
    path = _cache_file()
    known = _read(path)
    if key not in known:
        from fdsolver.bench import node_steps_per_second

        known[key] = node_steps_per_second(model, annulus(62.5, 250.0, NODES), 1, SECONDS, time.process_time)
        _write(path, known)
    return known[key]


def _cache_file() -> Path:
    from fdsolver.compile_cache import folder

    return Path(os.environ.get("NUMBA_CACHE_DIR") or folder()) / "rates.json"


def _read(path: Path) -> dict[str, float]:
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        return {str(name): float(value) for name, value in stored.items() if float(value) > 0.0}
    except (OSError, ValueError, AttributeError, TypeError):
        return {}


def _write(path: Path, rates: dict[str, float]) -> None:
    """Keep the rates; a cache that cannot be written is measured again next time."""
    try:
        make_folder(path.parent)
        write_atomically(path, lambda file: file.write(json.dumps(rates).encode()))
    except StorageError:
        return
