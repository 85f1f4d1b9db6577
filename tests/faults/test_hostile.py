"""Scene files, names, texts and archives that mean harm: data that is refused or shown, never obeyed."""

from __future__ import annotations

import os
import re
import shutil
import time
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from cases import SceneError, load_result, load_scene, run
from cases.results import ResultError
from cases.study_file import load_study
from fdsolver.checkpoint import Checkpoint, CheckpointError
from reports.content import Report, Section, Table, Text
from reports.page import write_page
from reports.pdf import write_pdf
from reports.run import ReportRun
from reports.stored import Stored
from tests.faults import damaged

SECONDS = 1.0  # of CPU: what a file may cost before it is refused
HARM = "<script>alert(1)</script>\"'&]]> $\\frac{1$ {{7*7}} {0.__class__} %s ) Tj (\\ /Launch"
SCENE = 'sheet.shape = "annulus"\nedges.inner.support = "pinned"\n'


@pytest.mark.parametrize("read", [load_scene, load_study])
@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (None, "is larger than 1000000 bytes"),
        ("a = " + "[" * 900_000, "is nested too deeply"),
        ("a = " + "{b = " * 150_000, "is nested too deeply"),
        ("[" + "a." * 400_000 + "a]", "is nested too deeply"),
        ("[" + "a . " * 200_000 + "a]", "is nested too deeply"),
        ("\n".join(f"[{'a.' * 12}b{k}]" for k in range(20_000)), "is nested too deeply"),
    ],
    ids=["100-MB", "arrays", "inline-tables", "table", "spaced-table", "many-tables"],
)
def test_large_and_deep_files_are_refused_within_a_second(read, content, sentence, tmp_path: Path) -> None:
    file = tmp_path / "hostile.toml"
    with file.open("w") as stream:
        if content is None:
            os.truncate(stream.fileno(), 100_000_000)
        else:
            stream.write(content)
    started = time.process_time()
    with pytest.raises(SceneError, match=sentence):
        read(file)
    assert time.process_time() - started < SECONDS


@pytest.mark.parametrize("kind", ["paths", "sections"])
@pytest.mark.parametrize(
    "name", ["../up", "/etc/x", "..", ".", "a/b", "a\\\\b", "C:x", "~", "a\\u0000", "x" * 65, ""]
)
def test_names_that_would_leave_the_folder_are_refused(kind: str, name: str, tmp_path: Path) -> None:
    file = tmp_path / "hostile.toml"
    file.write_text(f'{SCENE}[{kind}."{name}"]\nradius_mm = 100.0\n')
    with pytest.raises(SceneError, match="the name must be of letters, digits, - and _"):
        load_scene(file)


@pytest.mark.parametrize("name", ["../up", "/etc/x", "..", "a/b", ""])
def test_a_scene_that_calls_itself_a_place_elsewhere_is_refused(name: str, tmp_path: Path) -> None:
    file = tmp_path / "hostile.toml"
    file.write_text(f'name = "{name}"\n{SCENE}')
    with pytest.raises(SceneError, match="name"):
        load_scene(file)


@pytest.mark.parametrize("value", ["../../up", "/etc/x", "..", "mode:1/../../../x"])
def test_points_of_a_study_stay_in_its_folder(value: str, tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(
        '[study]\nscene = "annulus"\nmethods = ["tension-field"]\n[vary]\n'
        f'"start.from" = ["{value}"]\n"title" = ["{value}"]\n'
    )
    try:
        points = load_study(file).points
    except SceneError:
        return
    for point in points:
        assert (tmp_path / point.name).resolve().parent == tmp_path
        assert not point.name.startswith(".")


def test_a_title_is_data_in_every_file_of_a_result(tmp_path: Path) -> None:
    scene = load_scene("strip-tension", {"title": HARM})
    out = tmp_path / "out"
    run(scene, "exact", out=out)
    assert load_scene(out / "scene.toml").title == HARM
    assert load_result(out).method == "exact"
    names = {element.get("Name") for element in ElementTree.parse(out / "sheet.vtu").iter("DataArray")}
    assert {"displacement_mm", "stretch_major"} <= names
    assert "script" not in (out / "sheet.vtu").read_text()


def test_texts_are_shown_and_not_obeyed_in_page_and_pdf(tmp_path: Path) -> None:
    table = Table(HARM, (HARM, "number"), ((HARM, "1"),))
    report = Report(HARM, HARM, [Section("hostile", HARM, [Text(HARM), table])], [HARM])
    write_page(report, tmp_path / "index.html")
    write_pdf(report, tmp_path / "report.pdf")
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "<script>alert" not in page and "&lt;script&gt;alert" in page
    assert "{{7*7}}" in page  # not 49
    pdf = (tmp_path / "report.pdf").read_bytes()
    assert pdf.startswith(b"%PDF-") and b"/Launch" in pdf  # in the document's title, a string with escapes
    assert b"/Launch" not in re.sub(rb"\((?:\\.|[^\\()])*\)", b"", pdf, flags=re.DOTALL)


class Bomb:
    """An object that makes a file when it is unpickled."""

    def __init__(self, place: Path) -> None:
        self.place = place

    def __reduce__(self) -> tuple:
        return (Path.touch, (self.place,))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result folder of a small run, with its checkpoint, without checksums: as a stranger would make one."""
    folder = tmp_path_factory.mktemp("hostile") / "whole"
    damaged.solve(folder)
    text = (folder / "result.json").read_text()
    (folder / "result.json").write_text(text.replace('"sha256"', '"none"'))
    load_result(folder)
    return folder


@pytest.mark.parametrize("name", ["fields.npz", "snapshots.npz"])
def test_a_pickle_in_an_archive_is_not_executed(name: str, whole: Path, tmp_path: Path) -> None:
    out, made = tmp_path / "out", tmp_path / "made"
    shutil.copytree(whole, out)
    np.savez(out / name, r=np.array([Bomb(made)], dtype=object))
    with pytest.raises(ResultError, match="damaged"):
        load_result(out)
    stored = Stored(ReportRun("hole", "hole", "koiter", 400, 400), out)
    with pytest.raises(ValueError, match="allow_pickle"):
        stored.fields if name == "fields.npz" else stored.snapshots  # noqa: B018
    assert not made.exists()


def test_an_archive_that_claims_more_numbers_than_there_is_memory_is_refused(
    whole: Path, tmp_path: Path
) -> None:
    """The header of an array says 8e15 bytes; its file has a hundred."""
    import zipfile

    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000000,), }"
    header = header.ljust(118 - 1) + b"\n"
    array = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + bytes(100)
    with zipfile.ZipFile(tmp_path / "huge.npz", "w") as archive:
        archive.writestr("r.npy", array)
    with pytest.raises(CheckpointError, match="damaged"):
        Checkpoint(tmp_path / "huge.npz", "a run").load()
    shutil.copytree(whole, tmp_path / "out")
    shutil.copy(tmp_path / "huge.npz", tmp_path / "out" / "fields.npz")
    with pytest.raises(ResultError, match="damaged"):
        load_result(tmp_path / "out")
