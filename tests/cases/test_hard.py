"""The verdict on hard cases: what counts as right, as refused, as silently wrong, as an end without a name."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from cases import hard_table
from cases.hard import (
    AS_EXPECTED,
    REFUSED,
    UNNAMED,
    WRONG,
    Finding,
    HardCase,
    about,
    at_least,
    at_most,
    energy_is_monotone,
    judged,
)
from cases.hard_meshes import STRETCH, affine_energy, affine_finding, skewed, uniform
from cases.hard_table import counts, hard_cases, read_hard, run_hard
from fdsolver.model import KOITER
from fdsolver.result import Solution, Status


@pytest.fixture(scope="module")
def finding() -> Finding:
    return affine_finding(uniform(9, 7), KOITER)


def case(finding: Finding, *expected: str) -> HardCase:
    return HardCase("affine", "mesh", "a sheet under an affine map", expected, "closed form", lambda: finding)


def ended(finding: Finding, status: Status) -> Finding:
    return dataclasses.replace(finding, solution=dataclasses.replace(finding.solution, status=status))


def test_a_right_answer_is_as_expected(finding: Finding) -> None:
    row = judged(case(finding, "converged"), finding)
    assert row.verdict == AS_EXPECTED
    assert row.steps > 0 and row.monotone is not None
    assert all(item["holds"] for item in row.requirements)


@pytest.mark.parametrize("value", [2.0, float("nan"), float("inf")])
def test_a_converged_answer_that_misses_a_requirement_is_silently_wrong(
    finding: Finding, value: float
) -> None:
    off = dataclasses.replace(finding, requirements=(about("energy", value, 1.0, 1e-3),))
    assert judged(case(off, "converged"), off).verdict == WRONG


def test_a_named_refusal_is_no_wrong_answer(finding: Finding) -> None:
    off = dataclasses.replace(finding, requirements=(about("energy", 2.0, 1.0, 1e-3),))
    stalled = ended(off, Status.STALLED)
    assert judged(case(stalled, "converged"), stalled).verdict == REFUSED
    assert judged(case(stalled, "stalled"), stalled).verdict == AS_EXPECTED
    insisting = dataclasses.replace(stalled, always=True)
    assert judged(case(insisting, "stalled"), insisting).verdict == WRONG


def test_to_converge_where_there_is_no_answer_is_wrong(finding: Finding) -> None:
    assert judged(case(finding, "outside_validity"), finding).verdict == WRONG


@pytest.mark.parametrize(
    ("requirement", "holds"),
    [
        (about("x", 1.0009, 1.0, 1e-3), True),
        (about("x", 1.0011, 1.0, 1e-3), False),
        (about("x", 1e-9, 0.0, 1e-3, absolute=1e-8), True),
        (at_most("x", -2.0, 1.0), False),
        (at_most("x", -0.5, 1.0), True),
        (at_least("x", 0.5, 1.0), False),
        (at_most("x", float("nan"), 1.0), False),
        (at_least("x", float("nan"), 1.0), False),
    ],
)
def test_requirements(requirement: object, holds: bool) -> None:
    assert requirement.holds is holds  # type: ignore[attr-defined]


def test_rising_energy_is_seen_and_a_finer_mesh_is_no_rise(finding: Finding) -> None:
    def with_energy(*total: float, level: tuple[float, ...] | None = None) -> Solution:
        history = {
            "step": np.arange(len(total)),
            "level": np.asarray(level or [0] * len(total)),
            "energy": np.asarray(total),
            "kinetic": np.zeros(len(total)),
        }
        return dataclasses.replace(finding.solution, history=history)

    assert energy_is_monotone(with_energy(3.0, 2.0, 2.0, 1.0)) is True
    assert energy_is_monotone(with_energy(3.0, 2.0, 2.1, 1.0)) is False
    assert energy_is_monotone(with_energy(3.0, 2.0, 2.1, 1.0, level=(0, 0, 1, 1))) is True
    assert energy_is_monotone(with_energy(3.0)) is None


def test_affine_energy_is_that_of_the_strain_tensor() -> None:
    # by the other form of MODEL section 1: c (tr E)^2 / 2 + mu E : E
    strain = np.diag([0.5 * (s**2 - 1.0) for s in STRETCH])
    young, nu = 3500.0, 0.31
    c, mu = young * nu / (1.0 - nu**2), young / (2.0 * (1.0 + nu))
    density = 0.5 * c * np.trace(strain) ** 2 + mu * np.sum(strain**2)
    assert affine_energy() == pytest.approx(density, rel=1e-13)


def test_skewed_cells_have_the_angle_they_are_said_to_have() -> None:
    u = skewed(15.0).u
    along, up = u[1, 0] - u[0, 0], u[0, 1] - u[0, 0]
    cosine = along @ up / np.linalg.norm(along) / np.linalg.norm(up)
    assert np.degrees(np.arccos(cosine)) == pytest.approx(15.0, abs=1e-9)


def test_at_least_sixty_cases_with_reasons_stated_beforehand() -> None:
    cases = hard_cases()
    assert len(cases) >= 60
    assert len({item.name for item in cases}) == len(cases)
    words = {status.value for status in Status}
    for item in cases:
        assert item.expected and set(item.expected) <= words, item.name
        assert item.reason and item.title and item.family


def broken() -> Finding:
    raise RuntimeError("a planted fault")


def test_the_table_survives_a_case_that_breaks_and_goes_on_where_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # unknown to the worker, which therefore breaks: an end without a name, and the other case still has its own
    lost = HardCase("not-in-the-registry", "mesh", "a case that breaks", ("converged",), "planted", broken)
    quick = next(item for item in hard_cases() if item.name == "skew-45-tension-field")
    monkeypatch.setattr(hard_table, "hard_cases", lambda: (lost, quick))
    table = run_hard(tmp_path)
    assert counts(table) == {UNNAMED: 1, AS_EXPECTED: 1}
    assert "StopIteration" in table["message"][0]
    rows = read_hard(tmp_path)
    assert [row["name"] for row in rows] == [lost.name, quick.name]
    # a second run keeps both rows: nothing is solved again
    monkeypatch.setattr(hard_table, "_in_process", lambda *_: pytest.fail("solved again"))
    assert counts(run_hard(tmp_path)) == {UNNAMED: 1, AS_EXPECTED: 1}
    # rows of other code are not kept
    document = json.loads((tmp_path / "hard.json").read_text())
    document["code"]["source_sha256"] = "other"
    (tmp_path / "hard.json").write_text(json.dumps(document))
    with pytest.raises(pytest.fail.Exception, match="solved again"):
        run_hard(tmp_path)
