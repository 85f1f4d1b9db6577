"""A peer on a hard case is judged by the case's own requirements, whatever it says of itself."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from cases.hard import AS_EXPECTED, Requirement
from cases.hard_table import hard_cases
from tests.benchmarks import hard_peer

CASE = next(case for case in hard_cases() if case.name == "strip-poisson-0-membrane")
# The strip's start is its answer: stretched uniformly, without Poisson effect. Energy Y h A E^2 / 2.
SCRIPT = """
import json, sys
import numpy as np
asked = np.load(sys.argv[1])
u, r = asked["u"], asked["r"]
assert asked["model"] == "membrane" and asked["fixed"].any() and not asked["closed"]
width, height = np.ptp(u[..., 0]), np.ptp(u[..., 1])
strain = 0.5 * ((np.ptp(r[..., 0]) / width) ** 2 - 1.0)
energy = 0.5 * asked["young"] * asked["thickness"] * width * height * strain**2
found = {"status": "converged", "message": "", "iterations": 3, "cpu_seconds": 0.1, "versions": {"felupe": "0"}}
found["energy"] = float(energy)
CHANGE
np.savez(sys.argv[2], r=r, found=json.dumps(found))
"""


@pytest.mark.parametrize(
    ("change", "outcome", "message"),
    [
        ("", hard_peer.RIGHT, ""),
        ('found["energy"] *= 1.005', hard_peer.RIGHT, ""),  # within the margin of another discretisation
        ('found["energy"] *= 1.05', hard_peer.WRONG, "energy, N mm"),
        ('found.update(status="not converged", message="40 steps")', hard_peer.FAILED, "40 steps"),
        ('raise ArithmeticError("no pivot")', hard_peer.CRASHED, "ArithmeticError: no pivot"),
        ("import os; os.kill(os.getpid(), 11)", hard_peer.CRASHED, "ended by SIGSEGV"),
        ("import os; os.kill(os.getpid(), 24)", hard_peer.CRASHED, "no end within its CPU time"),
    ],
    ids=["right", "nearly", "wrong", "gave-up", "crashed", "killed", "no-end"],
)
def test_the_end_of_a_peer_is_named_by_what_it_found(
    change: str, outcome: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = tmp_path / "peer.py"
    script.write_text(SCRIPT.replace("CHANGE", change))
    monkeypatch.setattr(hard_peer, "SCRIPT", script)
    row = hard_peer.tried(CASE, None, sys.executable)
    assert row["outcome"] == outcome
    assert row["message"].startswith(message)
    if outcome == hard_peer.RIGHT:
        assert (row["iterations"], row["versions"]) == (3, {"felupe": "0"})


def test_an_answer_that_differs_from_ours_is_wrong_where_ours_is_right(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = tmp_path / "peer.py"
    script.write_text(SCRIPT.replace("CHANGE", ""))
    monkeypatch.setattr(hard_peer, "SCRIPT", script)
    ours = {"verdict": AS_EXPECTED, "status": "converged", "energy": 1.0}
    row = hard_peer.tried(CASE, ours, sys.executable)
    assert row["outcome"] == hard_peer.WRONG and "as here" in row["message"]
    assert hard_peer.tried(CASE, {**ours, "status": "stalled"}, sys.executable)["outcome"] == hard_peer.RIGHT


def test_the_engine_is_itself_again_afterwards() -> None:
    solution = CASE.find().solution
    assert solution.residual < 1e-8 and solution.force_evaluations > 0


@pytest.mark.parametrize(
    ("low", "high", "wanted"),
    [
        (100.0, 100.0, (99.0, 101.0)),
        (0.0, 0.5, (-0.00501, 0.50501)),
        (0.5, float("inf"), (0.49499, float("inf"))),
    ],
)
def test_requirements_are_widened_by_one_percent(
    low: float, high: float, wanted: tuple[float, float]
) -> None:
    wide = hard_peer.widened(Requirement("q", 0.0, low, high))
    assert (wide.low, wide.high) == pytest.approx(wanted, rel=1e-12)


def test_the_affine_map_may_be_missed_by_what_newtons_method_leaves() -> None:
    (affine,) = (case for case in hard_cases() if case.name == "few-cells-tension-field")
    names = {item.quantity for item in affine.find().requirements}
    assert hard_peer.AFFINE in names
    wide = hard_peer.widened(Requirement(hard_peer.AFFINE, 0.0, 0.0, 1e-7))
    assert wide.high == pytest.approx(1e-4, rel=1e-2)
