"""Verification runs: `pytest -m benchmark`. A test takes the fixture `verify`, see record.Verification:

def test_annulus(verify):
    solution = run(load_scene("annulus"), method="tension-field", out=verify.folder("annulus-20000"))
    verify.below("relative L2 error of the largest stretch", error, limit=1.2e-5, reason="...")
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from pathlib import Path

import pytest

from tests.benchmarks.record import Verification, save

HERE = Path(__file__).parent
# the longest verification run is a wrinkled sheet at the paper's node count
TIMEOUT_SECONDS = 3600
REPORT = pytest.StashKey[pytest.TestReport]()


@pytest.hookimpl(tryfirst=True)  # before -m selects
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if HERE in item.path.parents and "verify" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.benchmark)
            item.add_marker(pytest.mark.timeout(TIMEOUT_SECONDS))


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, object, object]:
    outcome = yield
    verification = pyfuncitem.funcargs.get("verify")
    if isinstance(verification, Verification):
        verification.conclude()
    return outcome


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.when == "call":
        item.stash[REPORT] = report
    return report


@pytest.fixture
def verify(request: pytest.FixtureRequest) -> Iterator[Verification]:
    """Recorder of one verification run; its entry in benchmarks.json is written when the test ends."""
    root = Path(request.config.getoption("--results")).absolute()
    root.mkdir(parents=True, exist_ok=True)  # for tables of a test that leaves no result folder
    title = (request.function.__doc__ or "").strip().split("\n")[0]
    verification = Verification(f"{request.path.stem}::{request.node.name}", title, root)
    yield verification
    report = request.node.stash.get(REPORT, None)
    message = "" if report is None or report.passed else report.longreprtext.strip().split("\n")[-1]
    if report is not None and report.failed and hasattr(report.longrepr, "reprcrash"):
        message = report.longrepr.reprcrash.message
    save(root, verification.entry(report.outcome if report else "failed", message))
