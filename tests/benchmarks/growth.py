"""Solves on ever finer meshes, each in a process of its own, and how their costs grow."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cases.study_points import Choices, make_points
from cases.study_pool import solve_here
from cases.study_table import result_of

SECONDS = 1500.0  # of one solve, by the clock
KEPT = (
    *("status", "message", "nodes", "steps", "force_evaluations", "residual", "seconds", "cpu_seconds"),
    *("seconds_compile", "peak_memory_MB"),
)


def solved(
    verify, name: str, method: str, nodes: int, changes: Mapping[str, object], threads: int = 1
) -> dict[str, Any]:
    """What `result.json` says of one solve of the stretched sheet; its memory is the solve's alone."""
    every = {**changes, "solver.max_seconds": SECONDS}
    (point,) = make_points("stretch", [every], Choices([method], [nodes]), "growth")
    point = replace(point, name=name, threads=threads)
    verify.folder(name)
    solve_here([point], verify.root, 1, False, lambda _: None)
    document = result_of(point, verify.root)
    return {"method": method, "threads": threads, "asked": nodes, **{key: document.get(key) for key in KEPT}}


def exponent(nodes: Sequence[float], cost: Sequence[float]) -> tuple[float, float]:
    """(p, c) of cost = c nodes^p by least squares of the logarithms."""
    slope, intercept = np.polyfit(np.log(nodes), np.log(cost), 1)
    return float(slope), float(np.exp(intercept))


def foreseen(rows: Sequence[Mapping[str, Any]], nodes: int) -> float:
    """CPU seconds of the next solve, from the growth between the last two; 0 where there are not two."""
    last = [row for row in rows if row["status"] == "converged"][-2:]
    if len(last) < 2:
        return 0.0
    power, size = exponent([row["nodes"] for row in last], [row["cpu_seconds"] for row in last])
    return size * nodes**power


def store(verify, name: str, found: Mapping[str, Any]) -> None:
    """Put the rows and fits under a key of growth.json, for the report."""
    target = verify.root / "growth.json"
    content = json.loads(target.read_text(encoding="utf-8")) if target.exists() else {}
    content[name] = found
    unfinished = target.with_suffix(".part")
    unfinished.write_text(json.dumps(content, indent=1), encoding="utf-8")
    unfinished.replace(target)
