from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from reports.bands import Banded, banded
from reports.run import ReportRun
from reports.stored import Stored

NODES = (4000, 8000, 16000)


def stored(folder: Path, nodes: int, value: float, status: str = "converged") -> Stored:
    run = ReportRun(f"run-{nodes}", "stretch", "koiter", nodes, nodes)
    (folder / run.name).mkdir(parents=True)
    document = {"status": status, "nodes": nodes, "value": None if math.isnan(value) else value}
    (folder / run.name / "result.json").write_text(json.dumps(document), encoding="utf-8")
    return Stored(run, folder / run.name)


def value_of(run: Stored) -> float:
    return run.value("value")


def test_second_order_sequence_has_its_limit_within_its_band(tmp_path):
    found = banded([stored(tmp_path, n, 0.4 + 120.0 / n) for n in NODES], value_of)
    # an error of C / nodes is one of second order in the mesh width: exactly extrapolated
    assert found.value == pytest.approx(0.4, rel=1e-9)
    assert found.order == pytest.approx(2.0, rel=1e-9)
    assert found.finest == 0.4 + 120.0 / 16000
    assert found.band >= abs(found.finest - 0.4)
    assert found.error >= abs(found.finest - 0.4)


def test_order_of_the_runs_does_not_matter(tmp_path):
    runs = [stored(tmp_path, n, 0.4 + 120.0 / n) for n in NODES]
    assert banded(runs[::-1], value_of) == banded(runs, value_of)


def test_oscillating_sequence_keeps_its_finest_value_and_range(tmp_path):
    runs = [stored(tmp_path, n, v) for n, v in zip(NODES, (1.0, 3.0, 2.0), strict=True)]
    found = banded(runs, value_of)
    assert (found.value, found.band) == (2.0, 2.0)
    assert math.isnan(found.order)


def test_failed_run_takes_no_part(tmp_path):
    runs = [stored(tmp_path, n, 0.4 + 120.0 / n) for n in NODES]
    runs.append(stored(tmp_path, 32000, 9.9, "stalled"))
    assert banded(runs, value_of).value == pytest.approx(0.4, rel=1e-9)


def test_too_few_meshes_have_a_value_and_no_band(tmp_path):
    runs = [stored(tmp_path, n, 1.0) for n in NODES[:2]]
    found = banded(runs, value_of)
    assert found.finest == 1.0
    assert math.isnan(found.band)
    assert found.text() == "1.00"


def test_nothing_converged_has_nothing(tmp_path):
    found = banded([stored(tmp_path, 4000, 1.0, "diverged")], value_of)
    assert math.isnan(found.finest)
    assert found.text() == "–"


def test_meshes_that_differ_in_kind_make_no_sequence(tmp_path):
    runs = [stored(tmp_path, n, v) for n, v in zip(NODES, (0.3, 0.2, 0.0), strict=True)]
    found = banded(runs, value_of, alike=lambda s: value_of(s) > 0.1)
    assert found.finest == 0.0
    assert math.isnan(found.band)


def test_absent_value_on_the_finest_mesh_is_not_replaced_by_a_coarser_one(tmp_path):
    runs = [stored(tmp_path, n, v) for n, v in zip(NODES, (5.0, 5.1, math.nan), strict=True)]
    assert math.isnan(banded(runs, value_of).finest)


def test_text_has_value_and_band():
    assert Banded(1.1, 1.234, 0.056).text() == "1.23 ± 0.056"
