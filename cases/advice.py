"""What to do about a run that ended at a limit or in a checkerboard."""

from __future__ import annotations

from fdsolver.result import Status

FEWEST_NODES_PER_WRINKLE = 6
LIMITS = {Status.STEP_LIMIT: "solver.max_steps", Status.TIME_LIMIT: "solver.max_seconds"}


def advice(status: Status, nodes: int, per_wrinkle: float | None) -> str:
    """A sentence to go after the status's own, with a blank before it; "" where there is nothing to say.

    per_wrinkle : nodes of the shortest wrinkle; None without wrinkles.
    """
    if status in LIMITS:
        return (
            f" In its folder it goes on with --resume, which allows as much again; or raise {LIMITS[status]}."
        )
    if status is Status.HOURGLASS and per_wrinkle is not None and per_wrinkle < FEWEST_NODES_PER_WRINKLE:
        finer = float(f"{nodes * (FEWEST_NODES_PER_WRINKLE / per_wrinkle) ** 2:.1g}")
        return f" Its wrinkles are too short for this mesh: they need at least some {finer:.0f} nodes."
    return ""
