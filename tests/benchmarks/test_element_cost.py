"""Seconds and memory of the finite elements against their unknowns, with every direct solver that is installed."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd

from femref.direct import installed

ROOT = Path(__file__).parents[2]
MESHES = {"buckling": (700, 1400, 2800), "postbuckling": (1300, 2600, 5300, 21000)}
LARGEST_WHOLE = 5300  # vertices; beyond, assembly and factorisation alone


def measured(method: str, solver: str, vertices: int) -> dict[str, object]:
    command = [sys.executable, "-m", "tests.benchmarks.element_cost", method, solver, str(vertices)]
    parts = ["parts"] if vertices > LARGEST_WHOLE else []
    output = subprocess.run([*command, *parts], cwd=ROOT, check=True, capture_output=True, text=True)
    return json.loads(output.stdout.splitlines()[-1])


def test_seconds_and_memory_against_unknowns(verify):
    """Finite elements: seconds and memory against unknowns, for assembly, factorisation and whole solves"""
    table = pd.DataFrame(
        [
            measured(method, solver, vertices)
            for method, meshes in MESHES.items()
            for vertices in meshes
            for solver in installed()
        ]
    )
    table.to_csv(verify.root / "finite-element-cost.csv", index=False)
    for (method, solver), rows in table.groupby(["method", "solver"]):
        last = rows.iloc[-1]
        for column in ("unknowns", "assemble_s", "factorise_s", "peak_MB"):
            verify.note(f"{method}, {solver}, finest mesh: {column}", float(last[column]))
        growth = np.polyfit(np.log(rows.unknowns), np.log(rows.factor_entries), 1)[0]
        verify.below(
            f"{method}, {solver}: exponent of the factors' entries in the unknowns",
            growth,
            limit=1.4,
            reason="n log n of nested dissection looks like 1.2; minimum degree is a little worse; a band has 1.5",
        )
    if len(installed()) > 1:
        for (method, vertices), rows in table.dropna().groupby(["method", "vertices"]):
            verify.below(
                f"{method}, {vertices} vertices: relative difference of the answers with both solvers",
                float(np.ptp(rows["value"]) / abs(rows["value"].mean())),
                limit=1e-6,
                reason="one discrete problem, solved to rounding by either; bending energy is 1e-5 of the total",
            )
