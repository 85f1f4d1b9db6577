"""The table of hard cases: no silent wrong answer, no end without a name."""

from __future__ import annotations

from cases.hard import AS_EXPECTED, REFUSED, UNNAMED, WRONG
from cases.hard_table import counts, run_hard
from tests.benchmarks.record import Verification


def test_hard_cases(verify: Verification) -> None:
    """Ninety hard cases of material, load, mesh, start, step and units, each in a process of its own."""
    table = run_hard(verify.root / "hard")
    found = counts(table)
    verify.above("cases", len(table), 60, "asked for: at least 60")
    verify.equal("silent wrong answers", found.get(WRONG, 0), 0, "never a silent wrong answer")
    verify.equal("ends without a name", found.get(UNNAMED, 0), 0, "each ends converged or in a named refusal")
    verify.note("refused instead: failing until cured", found.get(REFUSED, 0))
    verify.note("as expected", found.get(AS_EXPECTED, 0))
    verify.note("process seconds of solving", float(table["seconds"].sum()), "s")
