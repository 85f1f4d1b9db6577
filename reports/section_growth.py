"""The report's section on how costs grow: the roads to equilibrium, and time and memory against nodes."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from reports import figures_growth as figures
from reports.content import Block, Drawing, Section, Table, Text
from reports.measured import read_document
from reports.style import method_name, number, whole

FILE = "growth.json"
Found = Mapping[str, Mapping[str, Any]]


def read_growth(folder: Path) -> Found:
    """What the benchmarks of scaling and of the roads left; empty if they were not run."""
    return read_document(folder / FILE) or {}


def build(found: Found) -> Section:
    """Assemble the section; without measurements it says how to make them."""
    blocks: list[Block] = []
    if roads := _under(found, "road-"):
        blocks += [_road_drawing(roads), _road_table(roads)]
    if methods := _under(found, "scaling-"):
        blocks += [_scaling_drawing(methods), _scaling_table(methods), _next_table(methods)]
    if threads := _under(found, "threads-"):
        blocks.append(_threads_table(threads))
    if not blocks:
        blocks = [Text("Nothing was measured yet: `pytest -m benchmark` does, and the next report shows it.")]
    return Section("growth", "How costs grow with the mesh", blocks)


def _under(found: Found, prefix: str) -> Found:
    return {key.removeprefix(prefix): value for key, value in found.items() if key.startswith(prefix)}


def _road_drawing(roads: Found) -> Drawing:
    return Drawing(
        "growth-roads",
        "Roads to equilibrium",
        "The stretched sheet at 10 %, plate, to a residual of 1e-8: steps on all meshes of a run and CPU time without"
        " compilation. A step of the finisher is one iteration with a factorised tangent, which costs many others.",
        "Steps and time growing with the nodes, for relaxation on one mesh, on nested meshes and with a finisher.",
        partial(figures.roads, found={road: one["rows"] for road, one in roads.items()}),
        2.9,
    )


def _road_table(roads: Found) -> Table:
    rows = []
    for road, one in roads.items():
        for row in one["rows"]:
            done = row["status"] == "converged"
            rows.append(
                (
                    road,
                    whole(row["nodes"] if done else row["asked"]),
                    str(row["status"]).replace("_", " "),
                    whole(row["steps"]) if done else "–",
                    whole(row["force_evaluations"]) if done else "–",
                    number(float(row["cpu_seconds"] or 0.0), 3) + ("" if done else " (foreseen)"),
                    number(one["fits"]["steps_exponent"], 2),
                    number(one["fits"]["time_exponent"], 2),
                )
            )
    columns = (
        *("road", "nodes", "status", "steps", "force evaluations", "CPU (s)"),
        *("exponent of steps", "exponent of time"),
    )
    caption = (
        "Steps and CPU time to a residual of 1e-8; exponents by least squares over the converged meshes."
    )
    return Table(caption, columns, tuple(rows), wide=(0,))


def _scaling_drawing(methods: Found) -> Drawing:
    return Drawing(
        "growth-scaling",
        "Time and memory against nodes",
        "The stretched sheet, each method to its own default tolerance, one thread, each run in a process of its own."
        " Finite elements count vertices.",
        "Time and memory growing with the nodes for each method.",
        partial(figures.scaling, methods={method: one["rows"] for method, one in methods.items()}),
        2.9,
    )


def _scaling_table(methods: Found) -> Table:
    rows = []
    for method, one in methods.items():
        for row in one["rows"]:
            done = row.get("nodes") is not None
            rows.append(
                (
                    method_name(method),
                    whole(row["nodes"] if done else row["asked"]),
                    str(row["status"]).replace("_", " "),
                    number(float(row["cpu_seconds"] or 0.0), 3) + ("" if done else " (foreseen)"),
                    whole(row["steps"]) if done and row["steps"] is not None else "–",
                    number(float(row["peak_memory_MB"]), 3) if done else "–",
                )
            )
    columns = ("method", "nodes", "status", "CPU (s)", "steps", "peak memory (MB)")
    return Table("Time and memory on ever finer meshes.", columns, tuple(rows), wide=(0,))


def _next_table(methods: Found) -> Table:
    rows = tuple(
        (
            method_name(method),
            number(one["fits"]["time_exponent"], 3),
            number(one["fits"]["memory_exponent"], 3),
            whole(one["fits"]["next_nodes"]),
            number(one["fits"]["next_cpu_seconds"] / 3600.0, 2),
            number(one["fits"]["next_memory_MB"] / 1000.0, 2),
        )
        for method, one in methods.items()
    )
    columns = (
        *("method", "exponent of time", "exponent of memory", "ten times more nodes"),
        *("CPU time (h)", "memory (GB)"),
    )
    return Table(
        "Fitted exponents, and what ten times more nodes would cost by them.", columns, rows, wide=(0,)
    )


def _threads_table(threads: Found) -> Table:
    rows = []
    for method, one in threads.items():
        first, second = one["rows"]
        gain = float(first["seconds"]) / float(second["seconds"])
        rows.append(
            (
                method_name(method),
                whole(first["nodes"]),
                number(first["seconds"], 3),
                number(second["seconds"], 3),
                number(gain, 3),
            )
        )
    columns = ("method", "nodes", "one thread, wall (s)", "two threads, wall (s)", "one over two")
    return Table("One thread and two; the steps are the same, bit for bit.", columns, tuple(rows), wide=(0,))
