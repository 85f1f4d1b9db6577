"""The mutants of the campaign still fit the code, and the campaign tells a caught one from a survivor."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.mutation import campaign
from tests.mutation.campaign import Mutant, mutants, planted, try_mutant


@pytest.mark.parametrize("mutant", mutants(), ids=lambda mutant: mutant.name)
def test_every_mutant_changes_its_file_once_and_names_tests_that_exist(mutant: Mutant, project: Path) -> None:
    text = (project / mutant.file).read_text(encoding="utf-8")
    changed = planted(mutant, text)
    compile(changed, mutant.file, "exec")
    assert changed != text
    assert mutant.tests and all((project / test).is_file() for test in mutant.tests)


def test_at_least_twenty_five_of_different_names() -> None:
    assert len({mutant.name for mutant in mutants()}) == len(mutants()) >= 25


@pytest.mark.parametrize("count", [0, 2])
def test_a_change_that_does_not_fit_is_refused(count: int) -> None:
    with pytest.raises(ValueError, match=f"occurs {count} times"):
        planted(Mutant("m", "f.py", "x = 1", "x = 2", ("t.py",)), "x = 1\n" * count)


@pytest.mark.parametrize(
    ("code", "printed", "caught"),
    [
        (1, "FAILED tests/a.py::test_b - assert 1 == 2\n", True),
        (0, "3 passed\n", False),
        (5, "no tests ran\n", False),
        (4, "ERROR: file not found\n", False),
    ],
)
def test_only_a_failed_test_is_a_catch(
    monkeypatch: pytest.MonkeyPatch, code: int, printed: str, caught: bool
) -> None:
    ended = subprocess.CompletedProcess([], code, printed, "")
    monkeypatch.setattr(campaign, "_run_tests", lambda *_: ended)
    outcome = try_mutant(mutants()[0])
    assert outcome.caught is caught
