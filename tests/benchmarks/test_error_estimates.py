"""Are the estimated errors true? Coverage over runs whose answer is known."""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from tests.benchmarks.error_cases import Case, annulus_cases, homogeneous_cases, manufactured_cases

ROUNDING = 1e-12  # relative: truths and values have 16 digits, sums of 1e4 zones lose a few
FEWEST_RUNS = 200
FILE = "error-coverage.json"  # beside the other results, for the report


@dataclass
class Coverage:
    """What became of the estimates of one quantity.

    ratios : estimate over true error. limits : error of the limit over that of the value. reasons : of refusals.
    """

    estimates: int = 0
    refused: int = 0
    inside: int = 0
    ratios: list[float] = field(default_factory=list)
    limits: list[float] = field(default_factory=list)
    reasons: Counter[str] = field(default_factory=Counter)

    def add(self, other: Coverage) -> None:
        """Count another's estimates too."""
        self.estimates += other.estimates
        self.refused += other.refused
        self.inside += other.inside
        self.ratios += other.ratios
        self.limits += other.limits
        self.reasons += other.reasons

    @property
    def judged(self) -> int:
        return self.estimates - self.refused


def covered(cases: Iterable[Case]) -> tuple[int, dict[str, Coverage]]:
    """Number of runs, and the coverage of every quantity whose truth is known."""
    found: dict[str, Coverage] = defaultdict(Coverage)
    runs = 0
    for case in cases:
        runs += 1
        for estimate in case.estimates:
            if estimate.quantity not in case.truth:
                continue
            truth = case.truth[estimate.quantity]
            one = found[estimate.quantity]
            one.estimates += 1
            if estimate.total is None:
                one.refused += 1
                one.reasons[estimate.how.removeprefix("refused: ")] += 1
                continue
            error, rounding = abs(estimate.value - truth), ROUNDING * abs(truth)
            one.inside += int(error <= estimate.total + rounding)
            if error > rounding:
                one.ratios.append(float(estimate.total / error))
                one.limits.append(abs(float(estimate.limit - truth)) / error)
    return runs, found


def record(verify, found: dict[str, Coverage]) -> Coverage:
    """Note every quantity; return them all together."""
    everything = Coverage()
    for name, one in sorted(found.items()):
        everything.add(one)
        verify.note(f"{name}: estimates", one.estimates)
        verify.note(f"{name}: refused", one.refused)
        verify.note(f"{name}: true error inside", one.inside / max(one.judged, 1))
        if one.ratios:
            verify.note(f"{name}: median estimate over true error", float(np.median(one.ratios)))
    return everything


def test_estimated_errors_contain_the_true_ones(verify):
    """Error estimates against known truths: closed-form annuli, homogeneous strips, given shapes"""
    runs, found = 0, defaultdict(Coverage)
    for cases in (annulus_cases(160, seed=1), manufactured_cases(60, seed=2), homogeneous_cases()):
        more, coverage = covered(cases)
        runs += more
        for name, one in coverage.items():
            found[name].add(one)
    stored = {"runs": runs, "quantities": {name: vars(one) for name, one in sorted(found.items())}}
    verify.root.mkdir(parents=True, exist_ok=True)
    (verify.root / FILE).write_text(json.dumps(stored, indent=1), encoding="utf-8")
    everything = record(verify, found)
    verify.above("runs", runs, FEWEST_RUNS, "so that a share of 90 % is known to about 2 %")
    verify.above(
        "share of true errors inside the estimate",
        everything.inside / everything.judged,
        0.9,
        "what an error bar of nine in ten promises",
    )
    verify.below(
        "median estimate over true error",
        float(np.median(everything.ratios)),
        5.0,
        "a bound far above the error would be true and useless",
    )
    verify.below(
        "median error of the limit over that of the value",
        float(np.median(everything.limits)),
        0.5,
        "else it were not worth giving",
    )
    verify.below(
        "share of refused estimates",
        everything.refused / everything.estimates,
        0.2,
        "an estimate that is mostly refused is none",
    )
    for name, one in sorted(found.items()):
        if one.judged >= 20:
            verify.above(
                f"{name}: share inside",
                one.inside / one.judged,
                0.8,
                "no quantity may hide behind the others",
            )
