"""The recorder itself: limits are judged, a broken one fails its test, entries replace their earlier ones."""

from __future__ import annotations

import json

import pytest

from tests.benchmarks.record import FILE, Verification, save

pytest_plugins = ["pytester"]

INNER_TEST = """
from tests.benchmarks.conftest import *

def pytest_addoption(parser):
    parser.addoption("--results", default="out")
"""


@pytest.fixture
def verification(tmp_path):
    return Verification("file::test", "Title", tmp_path)


@pytest.mark.parametrize(
    ("method", "limits", "good", "bad"),
    [
        ("below", (1.0,), 1.0, 1.0 + 1e-12),
        ("above", (1.0,), 1.0, 1.0 - 1e-12),
        ("within", (1.0, 2.0), 1.5, 2.5),
        ("within", (1.0, 2.0), 1.0, float("nan")),
        ("below", (1.0,), 0.0, float("nan")),
        ("equal", ("converged",), "converged", "stalled"),
    ],
)
def test_limits(verification, method, limits, good, bad):
    getattr(verification, method)("q", good, *limits, reason="why")
    verification.conclude()
    getattr(verification, method)("q", bad, *limits, reason="why")
    with pytest.raises(AssertionError, match="q: .* required: "):
        verification.conclude()


def test_nothing_required_fails(verification):
    verification.note("seconds", 1.0, "s")
    with pytest.raises(AssertionError, match="require something"):
        verification.conclude()


def test_limit_without_a_reason_is_refused(verification):
    with pytest.raises(ValueError, match="needs a reason"):
        verification.below("q", 0.0, 1.0, reason=" ")


def test_entries_replace_their_earlier_ones_and_keep_others(tmp_path):
    for name, status in [("b", "failed"), ("a", "passed"), ("b", "passed")]:
        save(tmp_path, Verification(name, "", tmp_path).entry(status, ""))
    runs = json.loads((tmp_path / FILE).read_text(encoding="utf-8"))["runs"]
    assert [(run["name"], run["status"]) for run in runs] == [("a", "passed"), ("b", "passed")]
    assert [path.name for path in tmp_path.iterdir()] == [FILE]


def test_only_result_folders_are_removed(verification, tmp_path):
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError):
        verification.folder("kept")
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "result.json").write_text("{}")
    assert not verification.folder("old").exists()
    assert (tmp_path / "kept" / "notes.txt").exists()


def test_a_run_beyond_its_limit_fails_and_is_recorded(pytester):
    pytester.makeconftest(INNER_TEST)
    pytester.makepyfile(
        """
        def test_good(verify):
            verify.below("error", 0.5, 1.0, reason="why")
        def test_bad(verify):
            verify.below("error", 2.0, 1.0, reason="why")
            verify.note("afterwards", 3.0)
        def test_broken(verify):
            raise OSError("no such mesh")
        """
    )
    result = pytester.runpytest_inprocess("-p", "no:cacheprovider")
    result.assert_outcomes(passed=1, failed=2)
    runs = json.loads((pytester.path / "out" / FILE).read_text(encoding="utf-8"))["runs"]
    bad, broken, good = runs
    assert [run["status"] for run in runs] == ["failed", "failed", "passed"]
    assert [q["holds"] for q in bad["quantities"]] == [False, None]
    assert "error: 2.0" in bad["message"] and "no such mesh" in broken["message"]
    assert good["message"] == "" and good["seconds"] >= 0.0
