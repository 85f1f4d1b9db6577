"""How time and memory grow with the mesh: 2 000 to 1 000 000 nodes, one thread and two."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from cases.study_points import Choices, Point, make_points
from cases.study_pool import solve_here
from cases.study_table import result_of

NODES = (2000, 8000, 32_000, 128_000, 500_000, 1_000_000)
SECONDS = 1500.0  # of one solve; what meets the limit is noted and left out of the fit
FITTED_FROM = 8000  # below, start-up and the coarsest mesh outweigh the solve
NEXT = 10_000_000
ENGINE = ("tension-field", "membrane", "koiter")


def solved(verify, method: str, nodes: int, threads: int) -> Mapping[str, object]:
    """The result.json of one solve in a process of its own, whose memory is the solve's alone."""
    change = {"solver.max_seconds": SECONDS}
    (point,) = make_points("stretch", [change], Choices([method], [nodes]), "scaling")
    point: Point = replace(point, name=f"scaling-{method}-{nodes}-threads-{threads}", threads=threads)
    verify.folder(point.name)
    solve_here([point], verify.root, 1, False, lambda _: None)
    return result_of(point, verify.root)


def exponent(nodes: list[int], cost: list[float]) -> tuple[float, float]:
    """(p, c) of cost = c nodes^p by least squares of the logarithms."""
    slope, intercept = np.polyfit(np.log(nodes), np.log(cost), 1)
    return float(slope), float(np.exp(intercept))


@pytest.mark.parametrize("method", ENGINE)
def test_growth_with_the_mesh(verify, method):
    """Time and memory of the stretched sheet against nodes, one thread"""
    nodes, seconds, memory, base = [], [], [], 0.0
    for count in NODES:
        result = solved(verify, method, count, threads=1)
        verify.note(f"{count} nodes: status", str(result["status"]))
        if result["status"] != "converged":
            continue
        verify.note(f"{count} nodes: CPU time", float(result["cpu_seconds"]), "s")
        verify.note(f"{count} nodes: steps", float(result["steps"]))
        verify.note(f"{count} nodes: memory", float(result["peak_memory_MB"]), "MB")
        base = base or float(result["peak_memory_MB"])
        if count >= FITTED_FROM:
            nodes.append(int(result["nodes"]))
            seconds.append(float(result["cpu_seconds"]))
            memory.append(float(result["peak_memory_MB"]) - base)
    time_power, time_size = exponent(nodes, seconds)
    memory_power, memory_size = exponent(nodes, memory)
    verify.below(
        "exponent of the CPU time",
        time_power,
        1.8,
        "explicit steps grow with the square root of the nodes, so 1.5; the finest meshes leave the caches",
    )
    verify.below(
        "exponent of the memory above that of the smallest mesh",
        memory_power,
        1.15,
        "every array has a fixed number of entries per node; the smallest meshes reuse what compilation has left",
    )
    verify.note(f"{NEXT} nodes, extrapolated: CPU time", time_size * NEXT**time_power / 3600.0, "h")
    verify.note(
        f"{NEXT} nodes, extrapolated: memory", (base + memory_size * NEXT**memory_power) / 1000.0, "GB"
    )


@pytest.mark.parametrize("method", ENGINE)
def test_two_threads(verify, method):
    """Wall time of the stretched sheet on 128 000 nodes by two threads"""
    one, two = (solved(verify, method, 128_000, threads) for threads in (1, 2))
    verify.equal("status, two threads", str(two["status"]), str(one["status"]), "threads change no answer")
    # the same sums in the same order: the count of steps may not differ
    verify.equal(
        "steps, two threads", float(two["steps"]), float(one["steps"]), "sums are made row by row, in order"
    )
    verify.note("wall time of one thread over two", float(one["seconds"]) / float(two["seconds"]))
