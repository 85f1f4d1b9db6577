"""Files that are cut short, changed in a few bits, emptied or exchanged for others: refused, or harmless."""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterator
from pathlib import Path

from cases import load_result, load_scene, run
from cases.results import CHECKPOINT_NAME, ResultError
from cases.runner import FolderRefused
from fdsolver.checkpoint import CheckpointError
from fdsolver.result import Solution
from tests.cases.made import assert_same

FOLDER_FILES = ("result.json", "scene.toml", "fields.npz", "history.csv", "snapshots.npz", CHECKPOINT_NAME)
REFUSED, HARMLESS, WRONG = "refused with a sentence", "without effect", "wrong"
CHANGES = {"solver.snapshots": 3, "solver.max_steps": 100}


def solve(folder: Path, resume: bool = False, seed: int = 1) -> Solution:
    """A small run that ends at its step limit, with its checkpoint."""
    return run(load_scene("hole", CHANGES), "koiter", nodes=400, seed=seed, out=folder, resume=resume)


def damages(name: str, times: int, folder: Path, draw: random.Random) -> Iterator[str]:
    """Damage one file of a result folder in many ways; how each ended."""
    whole, other = folder / "whole", folder / "other"
    for place, seed in ((whole, 1), (other, 2)):
        if not place.exists():
            solve(place, seed=seed)
    sound, resumed = load_result(whole), None
    if name == CHECKPOINT_NAME:
        shutil.copytree(whole, folder / "resumed", dirs_exist_ok=True)
        resumed = solve(folder / "resumed", resume=True)
    content = (whole / name).read_bytes()
    kinds = (cut, flipped, flipped, emptied, (other / name).read_bytes)
    for k in range(times):
        kind = kinds[k % len(kinds)]
        changed = kind() if kind is kinds[-1] else kind(content, draw)
        hurt = folder / "hurt"
        shutil.rmtree(hurt, ignore_errors=True)
        shutil.copytree(whole, hurt)
        (hurt / name).write_bytes(changed)
        yield _end(hurt, resumed or sound, resumed is not None)


def _end(folder: Path, expected: Solution, resume: bool) -> str:
    try:
        found = solve(folder, resume=True) if resume else load_result(folder)
    except (ResultError, CheckpointError, FolderRefused) as refusal:
        sentence = str(refusal)
        return REFUSED if sentence.endswith(".") and "\n" not in sentence else f"{WRONG}: says {sentence!r}"
    except Exception as other:
        return f"{WRONG}: {type(other).__name__}: {other}"
    try:
        assert_same(found, expected)
    except AssertionError:
        return f"{WRONG}: read as if nothing had happened"
    return HARMLESS


def cut(content: bytes, draw: random.Random) -> bytes:
    """The file up to a random place."""
    return content[: draw.randrange(len(content))]


def flipped(content: bytes, draw: random.Random) -> bytes:
    """One to four bits changed."""
    changed = bytearray(content)
    for _ in range(draw.randint(1, 4)):
        changed[draw.randrange(len(changed))] ^= 1 << draw.randrange(8)
    return bytes(changed)


def emptied(content: bytes, draw: random.Random) -> bytes:
    """Nothing, or as many zero bytes: what some systems leave after a crash."""
    return draw.choice((b"", bytes(len(content))))
