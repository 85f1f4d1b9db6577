"""Settings of every test run: no display, and where the verification runs write."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

# before anything imports matplotlib
os.environ.setdefault("MPLBACKEND", "Agg")

# a shell starts background jobs with SIGINT ignored; the tests of interruption need Python's own answer to it
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--results",
        metavar="DIR",
        default=os.environ.get("WRINKLE_BENCHMARK_OUT", "runs/benchmark"),
        help="folder of the verification runs' results (default: $WRINKLE_BENCHMARK_OUT or runs/benchmark)",
    )


@pytest.fixture(scope="session")
def project() -> Path:
    """The top folder of the checkout."""
    return Path(__file__).resolve().parents[1]
