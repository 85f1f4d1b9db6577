"""Roads to equilibrium: the strip at 10 % to a residual of 1e-8 on three meshes, a factor of four apart."""

from __future__ import annotations

import pytest

from tests.benchmarks.growth import exponent, foreseen, solved, store

NODES = (15_000, 60_000, 240_000)
MOST_SECONDS = 240.0  # CPU time of one solve: what would take longer is left out, and said so
ROADS = {
    "relaxation": {"solver.levels": 1, "solver.finish": "off"},
    "nested relaxation": {"solver.finish": "off"},
    "nested, then finished": {"solver.finish": "on"},
}


@pytest.mark.parametrize("road", ROADS)
def test_steps_to_equilibrium(verify, road):
    """Steps and time of the strip at 10 % to 1e-8, by one road on three meshes"""
    rows = []
    for count in NODES:
        if (seconds := foreseen(rows, count)) > MOST_SECONDS:
            verify.note(f"{count} nodes: left out, for it would take", seconds, "s")
            rows.append({"method": "koiter", "asked": count, "status": "left out", "cpu_seconds": seconds})
            break
        changes = {"solver.tolerance": 1e-8, **ROADS[road]}
        row = solved(
            verify, f"road-{road.replace(' ', '-').replace(',', '')}-{count}", "koiter", count, changes
        )
        rows.append(row)
        verify.equal(f"{count} nodes: status", str(row["status"]), "converged", "each road is to arrive")
        verify.note(f"{count} nodes: steps", float(row["steps"]))
        verify.note(f"{count} nodes: CPU time", float(row["cpu_seconds"]), "s")
    done = [row for row in rows if row["status"] == "converged"]
    nodes = [row["nodes"] for row in done]
    fits = {
        f"{name}_exponent": exponent(nodes, [row[key] for row in done])[0]
        for name, key in (("steps", "steps"), ("time", "cpu_seconds"))
    }
    store(verify, f"road-{road}", {"rows": rows, "fits": fits})
    verify.note("exponent of the time", fits["time_exponent"])
    verify.below(
        "exponent of the steps",
        fits["steps_exponent"],
        0.65 if road == "relaxation" else 0.4,
        "explicit steps go with the square root of the nodes; nested meshes leave little of that",
    )
