"""Hard cases: what each one tries, how it must end and why, and the verdict on how it did end.

A case states its outcome beforehand. Requirements compare with a closed form, an invariance or a second method, never
with an earlier result of the same code. A run may end converged to the required answer, or in a named refusal; a
converged run that misses a requirement is a silent wrong answer, the one thing that must not happen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np

from fdsolver.result import Solution, Status

AS_EXPECTED, REFUSED, WRONG, UNNAMED = "as expected", "refused instead", "silent wrong answer", "unnamed end"
VERDICTS = (AS_EXPECTED, REFUSED, WRONG, UNNAMED)
ROUNDING = (
    1e-9  # part of the total energy by which explicit central differences may let it rise between two looks
)


@dataclass(frozen=True)
class Requirement:
    """A quantity of the result and the range it must lie in; a NaN lies in no range."""

    quantity: str
    value: float
    low: float
    high: float

    @property
    def holds(self) -> bool:
        """Whether the value lies in its range."""
        return bool(self.low <= self.value <= self.high)


def about(quantity: str, value: float, wanted: float, relative: float, absolute: float = 0.0) -> Requirement:
    """Require value = wanted within `relative` of it or `absolute`, whichever is more."""
    slack = max(relative * abs(wanted), absolute)
    return Requirement(quantity, float(value), float(wanted - slack), float(wanted + slack))


def at_most(quantity: str, value: float, limit: float) -> Requirement:
    """Require |value| <= limit."""
    return Requirement(quantity, float(abs(value)), 0.0, float(limit))


def at_least(quantity: str, value: float, limit: float) -> Requirement:
    """Require value >= limit."""
    return Requirement(quantity, float(value), float(limit), float("inf"))


@dataclass(frozen=True)
class Finding:
    """What a case came to.

    requirements : what the solution must satisfy if it converged; always : also if it did not.
    """

    solution: Solution
    requirements: tuple[Requirement, ...]
    always: bool = False


@dataclass(frozen=True)
class HardCase:
    """One hard case.

    name : unique, names its row. family : what it belongs with. title : what is done. expected : the words of the
    statuses that are right ("converged", ...). reason : why, by a closed form, an invariance or a second method.
    find : solves, and states the requirements.
    """

    name: str
    family: str
    title: str
    expected: tuple[str, ...]
    reason: str
    find: Callable[[], Finding]


@dataclass(frozen=True)
class Row:
    """One row of the table of hard cases; `seconds` is process time, `energy` N mm."""

    name: str
    family: str
    title: str
    expected: str
    reason: str
    verdict: str
    status: str
    message: str
    steps: int
    seconds: float
    energy: float | None
    monotone: bool | None
    hourglass: float | None
    warnings: int
    requirements: tuple[dict[str, float | str | bool], ...]


def judged(case: HardCase, finding: Finding) -> Row:
    """The row of a case that came to an end of its own."""
    solution = finding.solution
    converged = solution.status is Status.CONVERGED
    broken = [item for item in finding.requirements if not item.holds]
    if broken and (converged or finding.always):
        verdict = WRONG
    elif solution.status.value in case.expected:
        verdict = AS_EXPECTED
    else:
        verdict = WRONG if converged else REFUSED  # to converge where there is no answer is wrong, too
    shares = [share for share in solution.hourglass.values() if share is not None]
    return Row(
        **_stated(case),
        verdict=verdict,
        status=solution.status.value,
        message=solution.message,
        steps=solution.steps,
        seconds=solution.cpu_seconds,
        energy=solution.energy_N_mm["total"],
        monotone=energy_is_monotone(solution),
        hourglass=max(shares, default=None),
        warnings=len(solution.warnings),
        requirements=tuple({**asdict(item), "holds": item.holds} for item in finding.requirements),
    )


def unnamed(case: HardCase, message: str, seconds: float) -> Row:
    """The row of a case whose process died, broke or overran its time."""
    return Row(
        **_stated(case),
        verdict=UNNAMED,
        status="",
        message=message,
        steps=0,
        seconds=seconds,
        energy=None,
        monotone=None,
        hourglass=None,
        warnings=0,
        requirements=(),
    )


def _stated(case: HardCase) -> dict[str, str]:
    return {
        "name": case.name,
        "family": case.family,
        "title": case.title,
        "expected": " or ".join(case.expected),
        "reason": case.reason,
    }


def energy_is_monotone(solution: Solution) -> bool | None:
    """Whether strain plus kinetic energy never rose between two looks on one mesh; None without a history.

    A kick and a taken-back step count as rises: they are.
    """
    if len(solution.history.get("step", ())) < 2:
        return None
    total = solution.history["energy"] + solution.history["kinetic"]
    same_mesh = np.diff(solution.history["level"]) == 0
    allowed = ROUNDING * np.abs(total).max()
    return bool(np.all(np.diff(total)[same_mesh] <= allowed))
