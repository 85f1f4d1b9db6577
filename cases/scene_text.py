"""A resolved scene as text that runs again, and its identity."""

from __future__ import annotations

import hashlib
import json
from typing import Any

from pydantic import BaseModel

from cases.schema import Scene

TABLES = ("sheet", "material", "start", "effects", "symmetry", "mesh", "solver")
NAMED = ("edges", "sections", "paths")
# Limits of a run do not change its answer: a run that hit one may be resumed with a larger one.
NOT_IDENTITY = {"solver": ("max_steps", "max_seconds")}


def scene_document(scene: Scene) -> dict[str, Any]:
    """The scene as nested dictionaries of TOML values, every key with its value, as a file spells them."""
    document: dict[str, Any] = {"name": scene.name, "title": scene.title}
    for key in TABLES:
        document[key] = _plain(getattr(scene, key))
    for key in NAMED:
        document[key] = {name: _plain(entry) for name, entry in getattr(scene, key).items()}
    return document


def _plain(table: BaseModel) -> dict[str, Any]:
    return table.model_dump(mode="json", by_alias=True, exclude_none=True)


def scene_toml(scene: Scene) -> str:
    """The resolved scene as TOML; loading it gives the same scene."""
    document = scene_document(scene)
    lines = [f"{key} = {_value(document.pop(key))}" for key in ("name", "title")]
    for key, table in document.items():
        if key not in NAMED:
            lines += ["", f"[{key}]", *_items(table)]
            continue
        if not table:
            lines += ["", f"[{key}]"]
        for name, entry in table.items():
            lines += ["", f"[{key}.{name}]", *_items(entry)]
    return "\n".join(lines) + "\n"


def _items(table: dict[str, Any]) -> list[str]:
    return [f"{key} = {_value(value)}" for key, value in table.items()]


def _value(value: Any) -> str:
    """A TOML value; JSON's strings, numbers and arrays are TOML's too (17 digits keep floats exactly)."""
    return json.dumps(value, ensure_ascii=True, allow_nan=False)


def scene_hash(scene: Scene, method: str, nodes: int | None = None, seed: int = 0, **more: object) -> str:
    """Identity of a solve: 64 hexadecimal digits of everything that its answer depends on.

    nodes : the node count, None for the scene's. more : further settings that change the answer.
    Names, titles, time and step limits and the number of threads do not enter.
    """
    document = scene_document(scene)
    for table, keys in NOT_IDENTITY.items():
        for key in keys:
            document[table].pop(key, None)
    del document["name"], document["title"]
    document["mesh"]["nodes"] = scene.mesh.nodes if nodes is None else nodes
    given = {key: value for key, value in more.items() if value is not None}
    identity = {"scene": document, "method": method, "seed": seed, **given}
    text = json.dumps(identity, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
