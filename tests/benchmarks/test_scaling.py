"""How time and memory grow with the mesh: 2 000 to 1 000 000 nodes, one thread and two."""

from __future__ import annotations

import pytest

from tests.benchmarks.growth import exponent, foreseen, solved, store

NODES = (2000, 8000, 32_000, 128_000, 500_000, 1_000_000)
VERTICES = (400, 1600, 6400, 25_600)  # of finite elements, which cost a hundred times as much each
MOST_SECONDS = 180.0  # CPU time of one solve: what would take longer is left out, and said so
FITTED_FROM = 8000  # below, start-up and the coarsest mesh outweigh the solve
ENGINE = ("tension-field", "membrane", "koiter")
ELEMENTS = ("buckling", "postbuckling")


@pytest.mark.parametrize("method", [*ENGINE, *ELEMENTS])
def test_growth_with_the_mesh(verify, method):
    """Time and memory of the stretched sheet against nodes, one thread"""
    rows, counts = [], NODES if method in ENGINE else VERTICES
    solved(
        verify, f"scaling-{method}-first", method, counts[0], {}
    )  # compiles, which takes memory of its own
    for count in counts:
        if (seconds := foreseen(rows, count)) > MOST_SECONDS:
            verify.note(f"{count} nodes: left out, for it would take", seconds, "s")
            rows.append({"method": method, "asked": count, "status": "left out", "cpu_seconds": seconds})
            break
        rows.append(solved(verify, f"scaling-{method}-{count}", method, count, {}))
        verify.note(f"{count} nodes: status", str(rows[-1]["status"]))
    done = [row for row in rows if row["status"] == "converged"]
    fitted = [row for row in done if method in ELEMENTS or row["nodes"] >= FITTED_FROM]
    nodes = [row["nodes"] for row in fitted]
    base = float(done[0]["peak_memory_MB"])
    above = [max(float(row["peak_memory_MB"]) - base, 1.0) for row in fitted]
    time_power, time_size = exponent(nodes, [row["cpu_seconds"] for row in fitted])
    memory_power, memory_size = exponent(nodes[1:], above[1:]) if len(fitted) > 2 else exponent(nodes, above)
    ten = 10.0 * nodes[-1]
    fits = {
        "time_exponent": time_power,
        "memory_exponent": memory_power,
        "next_nodes": ten,
        "next_cpu_seconds": time_size * ten**time_power,
        "next_memory_MB": base + memory_size * ten**memory_power,
    }
    store(verify, f"scaling-{method}", {"rows": rows, "fits": fits})
    verify.below(
        "exponent of the CPU time",
        time_power,
        1.8,
        "explicit steps grow with the square root of the nodes, and so do factors of plane meshes: 1.5; the finest"
        " meshes leave the caches",
    )
    verify.below(
        "exponent of the memory above that of the smallest mesh",
        memory_power,
        1.15 if method in ENGINE else 1.4,
        "arrays have a fixed number of entries per node, factors n log n; small meshes reuse what compilation left",
    )
    for name, value in fits.items():
        verify.note(name.replace("_", " "), value)


@pytest.mark.parametrize("method", ENGINE)
def test_two_threads(verify, method):
    """Wall time of the stretched sheet on 128 000 nodes by two threads"""
    one, two = (
        solved(verify, f"threads-{method}-{threads}", method, 128_000, {}, threads) for threads in (1, 2)
    )
    verify.equal("status, two threads", str(two["status"]), str(one["status"]), "threads change no answer")
    # the same sums in the same order: the count of steps may not differ
    verify.equal(
        "steps, two threads", float(two["steps"]), float(one["steps"]), "sums are made row by row, in order"
    )
    verify.note("wall time of one thread over two", float(one["seconds"]) / float(two["seconds"]))
    store(verify, f"threads-{method}", {"rows": [one, two]})
