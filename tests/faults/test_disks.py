"""Disks that are full or may not be written: one sentence, exit code 1, and what was there before is unchanged."""

from __future__ import annotations

import errno
import os
import resource
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import pytest

from cases.__main__ import main
from fdsolver import checkpoint
from fdsolver.checkpoint import StorageError
from reports.content import Report, Section, Text
from reports.pdf import write_pdf
from tests.cases.made import Fake

WORDS = ["run", "annulus", "--method", "tension-field", "--nodes", "400", "--quiet", "--out", "out"]
REPORT = ["report", "--scenes", "strip-tension", "--quiet", "--out", "report"]
STUDY = ["study", "made.toml", "--jobs", "1", "--quiet", "--out", "study"]


def never(_: object) -> None:
    raise AssertionError("this must not be solved")


@contextmanager
def no_file_longer_than(size: int) -> Iterator[None]:
    """Let the system refuse whatever makes a file longer than `size` bytes, in processes that are started, too."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, hidden ones too."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def results(study: Path) -> dict[str, bytes]:
    """The files of all finished results of a study."""
    return {
        f"{finished.parent.name}/{name}": content
        for finished in study.glob("*/result.json")
        for name, content in contents(finished.parent).items()
    }


# Runs


LIMITED = """
import resource, sys
from cases.__main__ import main
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]),) * 2)
sys.exit(main(sys.argv[2:]))
"""


@pytest.mark.parametrize("limit", [100, 10_000])  # the scene file, the arrays of the result
def test_a_disk_that_takes_no_more_is_one_sentence_and_the_run_can_be_repeated(
    limit: int, tmp_path: Path, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A real refusal of the system, of the compile cache too, which must not end the run."""
    environment = {**os.environ, "PYTHONPATH": str(project)}
    command = [sys.executable, "-c", LIMITED, str(limit), *WORDS]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 1
    (sentence,) = done.stderr.splitlines()
    assert (
        sentence.startswith("wrinkle: Could not write ")
        and "File too large. What was there before" in sentence
    )
    assert not (tmp_path / "out" / "result.json").exists()
    assert list(tmp_path.glob(".*")) == []
    monkeypatch.chdir(tmp_path)
    assert main(WORDS) == 0


def test_a_read_only_disk_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, faked: Fake
) -> None:
    def refuse(path: Path, _: str) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    faked(never)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(checkpoint, "open", refuse, raising=False)
    assert main(WORDS) == 1
    (sentence,) = capsys.readouterr().err.splitlines()
    assert sentence.startswith("wrinkle: Could not write out/scene.toml: Read-only file system.")


# Studies


def make_study(nodes: str) -> None:
    Path("made.toml").write_text(
        f'[study]\nscene = "annulus"\nmethods = ["tension-field"]\nnodes = {nodes}\n'
    )


def test_a_study_on_a_full_disk_keeps_its_results_names_the_disk_and_goes_on_when_there_is_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    make_study("[400]")
    assert main(STUDY) == 0
    before = results(tmp_path / "study")
    assert len(before) > 5
    make_study("[400, 900]")
    capsys.readouterr()
    with no_file_longer_than(10_000):  # enough for notes and the table, not for the arrays of a result
        assert main(STUDY) == 1
    said = capsys.readouterr()
    assert "2 points; 1 converged, 1 failed" in said.out
    (sentence,) = said.err.splitlines()
    assert "Could not write" in sentence and "study/tension-field-n900" in sentence
    assert sentence.endswith("File too large. What was there before is unchanged.")
    assert results(tmp_path / "study") == before
    assert list(pd.read_csv("study/study.csv")["status"]) == ["converged", "failed"]
    assert main(STUDY) == 0
    after = results(tmp_path / "study")
    assert len(after) == 2 * len(before) and {name: after[name] for name in before} == before


def test_a_table_that_cannot_be_written_ends_the_study_in_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    make_study("[400]")
    assert main(STUDY) == 0
    table = Path("study/study.csv").read_bytes()
    capsys.readouterr()
    with no_file_longer_than(200):
        assert main(STUDY) == 1
    assert capsys.readouterr().err == (
        "wrinkle: Could not write study/study.csv: File too large. What was there before is unchanged.\n"
    )
    assert Path("study/study.csv").read_bytes() == table
    assert not list(tmp_path.rglob("*.partial"))


# Reports


def test_a_report_on_a_full_disk_keeps_the_old_page_and_the_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    with no_file_longer_than(10_000):
        assert main(REPORT) == 1
    folder = tmp_path / "report/results/quick/strip-tension-exact"
    assert capsys.readouterr().err.splitlines()[-1] == (
        f"wrinkle: Could not write {folder}: File too large. What was there before is unchanged."
    )
    assert main(REPORT) == 0
    before = contents(tmp_path)
    assert {"report/index.html", "report/report.pdf"} < set(before)
    capsys.readouterr()
    with no_file_longer_than(len(before["report/index.html"]) // 2):
        assert main(REPORT) == 1
    assert capsys.readouterr().err.splitlines()[-1] == (
        "wrinkle: Could not write report/index.html: File too large. What was there before is unchanged."
    )
    assert contents(tmp_path) == before


def test_a_pdf_that_cannot_be_written_leaves_the_old_one(tmp_path: Path) -> None:
    report = Report("Title", "Subtitle", [Section("one", "One", [Text("A sentence.")])], [])
    (tmp_path / "report.pdf").write_bytes(b"old")
    with (
        no_file_longer_than(100),
        pytest.raises(StorageError, match=r"report.pdf: File too large. What was there before is unchanged."),
    ):
        write_pdf(report, tmp_path / "report.pdf")
    assert contents(tmp_path) == {"report.pdf": b"old"}


# Folders that may not be written


@pytest.mark.parametrize(
    ("words", "target"),
    [(WORDS, "out"), (STUDY, "study"), (REPORT, "report/results/quick/strip-tension-exact")],
    ids=["run", "study", "report"],
)
def test_a_folder_that_cannot_be_made_is_one_sentence(
    words: list[str],
    target: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
    faked: Fake,
) -> None:
    def refuse(path: Path, *_: object, **__: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    faked(never)
    monkeypatch.chdir(tmp_path)
    make_study("[400]")
    before = contents(tmp_path)
    monkeypatch.setattr(Path, "mkdir", refuse)
    assert main(words) == 1
    assert capsys.readouterr().err.splitlines()[-1] == (
        f"wrinkle: Could not write {target}: Read-only file system. What was there before is unchanged."
    )
    assert contents(tmp_path) == before
