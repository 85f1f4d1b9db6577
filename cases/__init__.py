"""Scenes, runs and result folders.

`from cases import load_scene, run, load_result, compare`; each is imported when it is first used, so that the
command line starts at once.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cases.compare import compare
    from cases.results import load_result
    from cases.runner import run
    from cases.scene import Scene, SceneError, load_scene

_HOME = {
    "Scene": "cases.scene",
    "SceneError": "cases.scene",
    "compare": "cases.compare",
    "load_result": "cases.results",
    "load_scene": "cases.scene",
    "run": "cases.runner",
}
__all__ = ["Scene", "SceneError", "compare", "load_result", "load_scene", "run"]


class _Package(ModuleType):
    """This package; its name `compare` is the function, whoever imports the module `cases.compare`, and
    when.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'cases' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])


sys.modules[__name__].__class__ = _Package
