"""Speed of the kernels, as `wrinkle doctor --bench` prints it."""

from __future__ import annotations

from fdsolver.bench import RATE, throughput
from fdsolver.model import KOITER, MEMBRANE
from tensionfield.relaxed import TENSION_FIELD

# million node-steps per second and thread that plainly written loops reached on one core of a common server
PLAIN_LOOPS = {"membrane": 34.0, "koiter": 8.0}


def test_kernels_are_faster_than_plain_loops(verify):
    """Throughput of the kernels in million node-steps per second"""
    rows = throughput((MEMBRANE, TENSION_FIELD, KOITER), seconds=2.0)
    for row in rows:
        name = f"{row['model']}, {row['mesh']}, {row['threads']} thread(s), {row['nodes']} nodes"
        if row["threads"] == 1 and row["mesh"] == "rectangle" and row["model"] in PLAIN_LOOPS:
            verify.above(
                name,
                row[RATE],
                limit=PLAIN_LOOPS[row["model"]],
                reason="below the plain loops' rate the compiler has not vectorised the kernel",
                unit=RATE,
            )
        else:
            verify.note(name, row[RATE], RATE)
