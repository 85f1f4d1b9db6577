"""Studies on a real Slurm controller, where one answers; everything else about them is tested without it."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from cases.study import run_study
from cases.study_file import load_study

pytest.importorskip("submitit", reason="the extra `cluster` is not installed")
if (
    shutil.which("sinfo") is None
    or subprocess.run(["sinfo"], capture_output=True, timeout=60).returncode != 0
):
    pytest.skip("there is no Slurm controller", allow_module_level=True)


def test_points_are_solved_as_an_array_of_jobs(tmp_path):
    path = tmp_path / "made.toml"
    path.write_text(
        '[study]\nscene = "annulus"\nmethods = ["exact"]\nnodes = [900]\n[vary]\nedges.inner.rotate_deg = [60, 90]\n',
        encoding="utf-8",
    )
    lines = []
    table = run_study(load_study(path), tmp_path / "out", cluster="slurm", say=lines.append)
    assert list(table["status"]) == ["converged", "converged"]
    assert len(lines) == 2
    # more twist takes more torque: the two folders hold two different solves
    torque = table["reactions.inner.moment_N_mm.z"]
    assert 0.0 < torque[0] < torque[1]


def test_a_cancelled_job_is_noted(tmp_path):
    path = tmp_path / "made.toml"
    path.write_text('[study]\nscene = "stretch"\nmethods = ["koiter"]\nnodes = [400000]\n', encoding="utf-8")

    class Cancel:
        """Takes the jobs off the cluster as soon as they are in its queue."""

        def check(self):
            subprocess.run(["scancel", "--name=wrinkle", "--me"], check=True)

    table = run_study(load_study(path), tmp_path / "out", cluster="slurm", interruption=Cancel())
    assert list(table["status"]) == ["died"]
    assert "left the queue without a result" in table["message"][0]
