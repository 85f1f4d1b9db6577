"""The progress display."""

from __future__ import annotations

import pytest

from cases.progress import display, fraction_done, orders, time_left
from fdsolver.relax import Progress


def test_no_progress_is_shown_where_nobody_watches(capsys):
    with display() as progress:
        assert progress is None


def test_progress_is_shown_on_a_terminal(monkeypatch, capsys):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    with display() as progress:
        progress(report(0, 1e-2, 0.0))
        progress(report(100, 1e-4, 2.0))
        task = progress._bars.tasks[0]
        assert task.completed == pytest.approx(1 / 3)  # two of six orders of magnitude
        assert task.fields["left"] == "4 s left on this mesh"


def report(step: int, residual: float, seconds: float) -> Progress:
    return Progress(1, 2, 1000, step, residual, 1e-8, 50.0, seconds)


def test_progress_is_measured_in_orders_of_magnitude():
    first = report(0, 1e-2, 0.0)
    assert fraction_done(first, report(1, 1e-5, 1.0)) == pytest.approx(0.5)
    assert fraction_done(first, report(1, 1.0, 1.0)) == 0.0
    assert fraction_done(first, report(1, 1e-9, 1.0)) == 1.0
    assert fraction_done(report(0, 1e-9, 0.0), report(1, 1e-9, 1.0)) == 1.0
    assert time_left(first, report(1, 1e-5, 3.0)) == "3 s left on this mesh"
    assert time_left(first, report(1, 1e-5, 300.0)) == "5 min left on this mesh"
    assert time_left(first, report(1, 0.9e-2, 3.0)) == "time left unknown"
    assert orders(float("nan"), 1.0) == orders(0.0, 1.0) == 0.0
