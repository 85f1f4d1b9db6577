"""Scenes, runs and result folders.

`from cases import load_scene, run, load_result, compare`; each is imported when it is first used, so that the
command line starts at once.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cases.comparison import compare
    from cases.results import load_result
    from cases.runner import run
    from cases.scene import Scene, SceneError, load_scene

# `compare` lives in `cases.comparison`: a module of its own name would take its place here.
_HOME = {
    "Scene": "cases.scene",
    "SceneError": "cases.scene",
    "compare": "cases.comparison",
    "load_result": "cases.results",
    "load_scene": "cases.scene",
    "run": "cases.runner",
}
__all__ = ["Scene", "SceneError", "compare", "load_result", "load_scene", "run"]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'cases' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
