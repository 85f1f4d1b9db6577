"""A small campaign survives, and the campaign sees what it looks for."""

from __future__ import annotations

import json
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cases.results import read_document
from tests.faults import campaign, damaged, planted
from tests.faults.damaged import HARMLESS, REFUSED, WRONG
from tests.faults.kills import Job, differences, timeless


def test_a_small_campaign_survives(tmp_path: Path, project: Path) -> None:
    """Killed runs resume bit by bit; planted values are noticed within twenty steps; damaged files are refused."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.faults.campaign", "--quick", "--out", str(tmp_path)],
        cwd=project,
        env={**os.environ, "PYTHONPATH": str(project)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    rows = json.loads((tmp_path / "faults.json").read_text())
    assert {row["outcome"] for row in rows} == {campaign.SURVIVED}
    kills = [row for row in rows if row["fault"] == "killed"]
    assert sum(row["moments"] for row in kills) == campaign.QUICK.run
    assert {row["what"] for row in rows} >= {*planted.ARRAYS, *damaged.FOLDER_FILES, "scene files"}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result folder of a small run, with its checkpoint."""
    folder = tmp_path_factory.mktemp("faults") / "whole"
    damaged.solve(folder)
    return folder


def test_the_comparison_sees_one_changed_bit_and_not_the_clock(whole: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    shutil.copytree(whole, other)
    assert differences(whole, other) == []
    document = json.loads((whole / "result.json").read_text())
    (other / "result.json").write_text(json.dumps(document | {"seconds": 1e9}))
    assert differences(whole, other) == []
    (other / "result.json").write_text(
        json.dumps(document | {"residual": np.nextafter(document["residual"], 1.0)})
    )
    assert differences(whole, other) == [f"{other}: result.json differs"]
    shutil.copy(whole / "result.json", other / "result.json")
    with np.load(whole / "fields.npz") as stored:
        fields = {name: stored[name] for name in stored.files}
    fields["r"] = np.nextafter(fields["r"], np.inf)
    np.savez(other / "fields.npz", **fields)
    (other / "extra").touch()
    assert differences(whole, other) == [f"{other}: extra is there only once", f"{other}: fields.npz differs"]


def test_only_times_and_machine_are_left_out_of_the_comparison(whole: Path) -> None:
    left = timeless(read_document(whole))
    assert {"residual", "steps", "energy_N_mm", "reactions", "levels", "stability", "warnings"} <= set(left)


@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")  # of newer Pythons, about fork
def test_a_job_that_forgets_its_results_is_found_out(tmp_path: Path) -> None:
    """Work that begins anew each time, with another result: lost, solved again, not equal."""

    def forgetful(folder: Path) -> None:
        (folder / "result").mkdir(parents=True, exist_ok=True)
        (folder / "result" / "result.json").write_text(json.dumps({"process": os.getpid()}))
        sum(range(10**7))  # time to be killed in

    job = Job("forgetful", forgetful, ("result",), lambda folder: None)
    row = campaign.killed(job, 2, tmp_path)
    assert (row.outcome, row.moments) == (campaign.FAILED, 2)
    assert "was solved again" in row.detail and "result.json differs" in row.detail


def test_a_result_that_is_read_although_it_was_changed_is_found_out(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cases.results.check_files", lambda *_: None)  # as if nothing were sealed
    shutil.copytree(whole, tmp_path / "whole")
    ends = set(damaged.damages("fields.npz", 5, tmp_path, random.Random(1)))
    assert f"{WRONG}: read as if nothing had happened" in ends and ends & {REFUSED, HARMLESS}


def test_a_wrong_scene_that_is_taken_is_found_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert campaign.wrong_scenes(tmp_path / "wrong.toml").outcome == campaign.SURVIVED
    monkeypatch.setattr(campaign, "load_scene", lambda _: None)
    row = campaign.wrong_scenes(tmp_path / "wrong.toml")
    assert row.outcome == campaign.FAILED and row.moments >= 50 and "empty file: []" in row.detail


def test_a_value_that_is_never_noticed_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planted, "WITHIN", 0)
    assert "noticed after" in planted.planting("v", random.Random(0)).fault
