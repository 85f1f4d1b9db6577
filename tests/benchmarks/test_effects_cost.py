"""What every combination of effects costs: operations, bytes and time of a step of one node."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from fdsolver import meshes
from fdsolver.bench import SHEET, node_steps_per_second
from fdsolver.effects import build_force
from fdsolver.model import KOITER, MEMBRANE, Model
from tensionfield.relaxed import TENSION_FIELD
from tests.benchmarks.effects_runs import write_rows
from tests.benchmarks.record import Verification
from tests.generated_code import operations_per_node

NODES = 10_000
MODELS = {
    "relaxed membrane in its plane": replace(TENSION_FIELD, out_of_plane=False),
    "relaxed membrane": TENSION_FIELD,
    "membrane in its plane": replace(MEMBRANE, out_of_plane=False),
    "membrane": MEMBRANE,
    "plate in its plane": replace(KOITER, out_of_plane=False),
    "plate, moderate rotations": replace(KOITER, moderate=True),
    "plate without strain gradient": replace(KOITER, strain_gradient=False),
    "plate with everything": KOITER,
}


def bytes_per_node(model: Model) -> float:
    """Of positions, velocities, two forces, masses and their inverses, and the constants of the mesh."""
    grid = meshes.rectangle(100.0, 100.0, NODES)
    force = build_force(grid, SHEET, model, {})
    constants = sum(
        part.nbytes for part in (force.zone, force.node, force.twist, force.bound) if part is not None
    )
    fields = 4 * model.components + 2 * model.components * (model.components + 1) // 2
    return fields * np.dtype(float).itemsize + constants / grid.nodes


def test_what_is_left_out_costs_nothing(verify: Verification) -> None:
    """Operations, bytes and time per node of every sensible combination of effects"""
    grid = meshes.rectangle(100.0, 100.0, NODES)
    rows = []
    for name, model in MODELS.items():
        rate = node_steps_per_second(model, grid, 1, 0.3, time.process_time)
        rows.append(
            {
                "what": name,
                "operations": operations_per_node(model),
                "bytes": bytes_per_node(model),
                "nanoseconds": 1e9 / rate,
            }
        )
        verify.note(f"{name}: time of a step of one node", rows[-1]["nanoseconds"], "ns")
    write_rows(verify.root, "cost", rows)
    found = {row["what"]: row for row in rows}
    full, why = found["plate with everything"], "what an effect needs is not there when it is off"
    stored = "it stores its stiffness bounds, which with everything on depend on the state"
    for name in ("plate in its plane", "plate, moderate rotations", "membrane", "membrane in its plane"):
        limits = {"operations": (0.99, why), "bytes": (0.99, why)}
        if name == "plate, moderate rotations":
            limits["bytes"] = (1.0, stored)
        for part, (limit, reason) in limits.items():
            verify.below(
                f"{name}: {part} over those of the plate", found[name][part] / full[part], limit, reason
            )
