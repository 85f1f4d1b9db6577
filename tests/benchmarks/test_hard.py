"""The table of hard cases: no silent wrong answer, no end without a name."""

from __future__ import annotations

import os

import pytest

from cases.hard import AS_EXPECTED, REFUSED, UNNAMED, WRONG
from cases.hard_table import counts, hard_cases, run_hard
from tests.benchmarks import hard_peer
from tests.benchmarks.record import Verification

PEER = "FELUPE_PYTHON"  # in the environment: a Python that has FElupe


def test_hard_cases(verify: Verification) -> None:
    """Ninety hard cases of material, load, mesh, start, step and units, each in a process of its own."""
    before = sum(os.times()[:4])
    table = run_hard(verify.root / "hard")
    found = counts(table)
    verify.above("cases", len(table), 60, "asked for: at least 60")
    verify.equal("silent wrong answers", found.get(WRONG, 0), 0, "never a silent wrong answer")
    verify.equal("ends without a name", found.get(UNNAMED, 0), 0, "each ends converged or in a named refusal")
    verify.equal("refused instead", found.get(REFUSED, 0), 0, "a case that fails is to be cured")
    verify.note("as expected", found.get(AS_EXPECTED, 0))
    verify.note("process seconds of solving", float(table["seconds"].sum()), "s")
    verify.note(
        "process seconds of this call, start-up and compilation included", sum(os.times()[:4]) - before, "s"
    )


@pytest.mark.skipif(PEER not in os.environ, reason=f"{PEER} names no Python that has FElupe")
def test_hard_cases_by_another_code(verify: Verification) -> None:
    """The same hard cases given to FElupe, a finite-element code."""
    rows = hard_peer.campaign(verify.root, os.environ[PEER])
    asked = sum(case.family != hard_peer.NO_TIME_STEP for case in hard_cases())
    verify.equal("cases with an end", len(rows), asked, "all that mean something to Newton's method")
    for outcome in hard_peer.OUTCOMES:
        verify.note(outcome, sum(row["outcome"] == outcome for row in rows))
