"""Formats and folders: what is written is read back exactly, whole or not at all."""

from __future__ import annotations

import errno
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

from cases import folders
from cases.files import json_text, read_csv, read_fields, write_csv, write_fields, write_vtu
from cases.folders import recover, write_folder
from fdsolver import meshes
from fdsolver.checkpoint import StorageError
from fdsolver.grid import Grid
from tests.cases.made import made_solution

GRIDS = {
    "rectangle": meshes.rectangle(30.0, 20.0, 400, bias=1.0),
    "annulus": meshes.annulus(62.5, 250.0, 400),
    "hole": meshes.rectangle_with_hole(50.0, 125.0, 15.0, 400),
}


@pytest.fixture(params=GRIDS, name="grid")
def _grid(request: pytest.FixtureRequest) -> Grid:
    return GRIDS[request.param]


def wave(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return 0.3 * np.sin(x / 7.0) + 0.01 * y


def test_fields_give_back_mesh_positions_and_zone_fields(grid: Grid, tmp_path: Path) -> None:
    solution = made_solution(grid, wave, stretch=1.1)
    write_fields(tmp_path / "fields.npz", solution)
    again, r, zone = read_fields(tmp_path / "fields.npz")
    assert r.tobytes() == solution.r.tobytes()
    for name in ("u", "xi", "eta"):
        assert np.array_equal(getattr(again, name), getattr(grid, name))
    for name in ("shape", "closed", "length_mm", "breaks"):
        assert getattr(again, name) == getattr(grid, name)
    assert set(again.edges) == set(grid.edges)
    for name, nodes in grid.edges.items():
        assert np.array_equal(again.edges[name], nodes)
    for name in ("stretch_major", "stretch_minor", "stress_major", "stress_minor", "state"):
        stored, made = getattr(zone, name), getattr(solution.zone, name)
        assert stored.dtype == made.dtype
        assert np.array_equal(stored, made)


def test_fields_of_the_wrong_shape_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "fields.npz"
    write_fields(path, made_solution(GRIDS["annulus"]))
    with np.load(path) as stored:
        arrays = dict(stored)
    np.savez(path, **(arrays | {"r": arrays["r"][:-1]}))
    with pytest.raises(ValueError, match="r has the shape"):
        read_fields(path)
    np.savez(path, **(arrays | {"state": arrays["state"][:, 1:]}))
    with pytest.raises(ValueError, match="state has the shape"):
        read_fields(path)


def test_the_vtu_file_has_the_deformed_sheet(grid: Grid, tmp_path: Path) -> None:
    """Read by meshio: nodes, counter-clockwise zones that tile the sheet, fields zone by zone."""
    solution = made_solution(grid, wave, stretch=1.1)
    write_vtu(tmp_path / "sheet.vtu", solution)
    mesh = meshio.read(tmp_path / "sheet.vtu")
    assert np.array_equal(mesh.points, solution.r.reshape(-1, 3))
    reference = mesh.point_data["reference_mm"]
    assert np.array_equal(reference[:, :2], grid.u.reshape(-1, 2))
    # x + (r - x) is r up to one rounding.
    assert np.allclose(
        reference + mesh.point_data["displacement_mm"], mesh.points, rtol=0.0, atol=1e-13 * grid.length_mm
    )
    (cells,) = [block.data for block in mesh.cells if block.type == "quad"]
    a, b, c, d = (reference[cells[:, k], :2] for k in range(4))
    p, q = c - a, d - b
    area = 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    # The same products in the same order as in the mesh, only regrouped.
    assert np.allclose(area, grid.zone_area.ravel(), rtol=1e-12, atol=0.0)
    assert np.array_equal(mesh.cell_data["stretch_major"][0], solution.zone.stretch_major.ravel())
    assert np.array_equal(mesh.cell_data["state"][0], solution.zone.state.ravel())


def test_csv_columns_keep_every_bit_and_their_kind(tmp_path: Path) -> None:
    columns = {
        "s_mm": np.array([0.0, 0.1 + 0.2, 1 / 3, 1e-300, np.nan, np.inf]),
        "state": np.array([0, 1, 2, 0, 1, 2], dtype=np.int8),
    }
    write_csv(tmp_path / "a.csv", columns)
    again = read_csv(tmp_path / "a.csv")
    assert again["s_mm"].tobytes() == columns["s_mm"].tobytes()
    assert again["state"].dtype == np.int64
    assert np.array_equal(again["state"], columns["state"])


def test_csv_of_no_rows_keeps_its_header(tmp_path: Path) -> None:
    write_csv(tmp_path / "a.csv", {"step": np.zeros(0), "energy": np.zeros(0)})
    again = read_csv(tmp_path / "a.csv")
    assert list(again) == ["step", "energy"]
    assert again["energy"].shape == (0,)


def test_csv_with_a_row_cut_short_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("s_mm,z_mm\n1.0,2.0\n3.0\n")
    with pytest.raises(ValueError, match="not as many entries"):
        read_csv(tmp_path / "a.csv")


def test_json_has_null_for_what_is_not_finite() -> None:
    text = json_text({"a": np.float64(np.nan), "b": [np.inf, np.int64(3)], "c": np.array([1.5, -np.inf])})
    assert json.loads(text) == {"a": None, "b": [None, 3], "c": [1.5, None]}


def _fill(text: str):
    def fill(folder: Path) -> None:
        (folder / "part").mkdir()
        (folder / "part" / "file").write_text(text)

    return fill


def _text(folder: Path) -> str:
    return (folder / "part" / "file").read_text()


@pytest.mark.parametrize("exchange", [True, False], ids=["exchange", "two renames"])
def test_a_folder_is_replaced_as_a_whole(
    exchange: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not exchange:
        monkeypatch.setattr(folders, "_exchange", lambda *_: False)
    out = tmp_path / "deep" / "result"
    write_folder(out, _fill("first"))
    (out / "stale").write_text("of the first run")
    write_folder(out, _fill("second"))
    assert _text(out) == "second"
    assert [path.name for path in out.iterdir()] == ["part"]
    assert [path.name for path in out.parent.iterdir()] == ["result"]


def test_the_system_can_exchange_folders_here(tmp_path: Path) -> None:
    """Otherwise the test above would not have tested it."""
    if not sys.platform.startswith("linux"):
        pytest.skip("exchange is a call of Linux")
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / name).touch()
    assert folders._exchange(tmp_path / "a", tmp_path / "b")
    assert (tmp_path / "a" / "b").exists()
    assert (tmp_path / "b" / "a").exists()


@pytest.mark.parametrize("when", ["while filling", "at fsync", "at the exchange", "at the second rename"])
def test_a_full_disk_leaves_the_old_folder(
    when: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "result"
    write_folder(out, _fill("first"))

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def fill(folder: Path) -> None:
        _fill("second")(folder)
        if when == "while filling":
            full()

    if when == "at fsync":
        monkeypatch.setattr(folders.os, "fsync", full)
    if when == "at the exchange":
        monkeypatch.setattr(folders, "_exchange", full)
    if when == "at the second rename":
        rename, calls = os.rename, []
        monkeypatch.setattr(folders, "_exchange", lambda *_: False)
        monkeypatch.setattr(
            folders.os,
            "rename",
            lambda *words: (calls.append(words), full() if len(calls) == 2 else rename(*words)),
        )
    sentence = f"Could not write {out}: No space left on device. What was there before is unchanged."
    with pytest.raises(StorageError, match=re.escape(sentence)):
        write_folder(out, fill)
    monkeypatch.undo()
    assert _text(out) == "first"
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


def test_an_interrupt_leaves_the_old_folder_and_no_rubbish(tmp_path: Path) -> None:
    out = tmp_path / "result"
    write_folder(out, _fill("first"))

    def fill(folder: Path) -> None:
        _fill("second")(folder)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_folder(out, fill)
    assert _text(out) == "first"
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


KILLED_WRITE = """
import os, signal, sys
from pathlib import Path
from cases import folders

def die(*_):
    os.kill(os.getpid(), signal.SIGKILL)

def fill(folder):
    (folder / "part").mkdir()
    (folder / "part" / "file").write_text("second")
    if sys.argv[2] == "filling":
        die()

rename = os.rename
renames = []

def second_dies(*words):
    if renames:
        die()
    renames.append(words)
    rename(*words)

if sys.argv[2] == "fsync":
    folders.os.fsync = die
if sys.argv[2] == "between":
    folders._exchange = lambda *_: False
    folders.os.rename = second_dies
folders.write_folder(Path(sys.argv[1]), fill)
"""


@pytest.mark.parametrize("when", ["filling", "fsync", "between"])
def test_a_kill_leaves_the_old_folder(when: str, tmp_path: Path, project: Path) -> None:
    """Also between the two renames of a system that cannot exchange: there the next run brings it back."""
    out = tmp_path / "result"
    write_folder(out, _fill("first"))
    done = subprocess.run([sys.executable, "-c", KILLED_WRITE, str(out), when], cwd=project)
    assert done.returncode == -9
    assert out.exists() == (when != "between")
    recover(out)
    assert _text(out) == "first"
    assert [path.name for path in tmp_path.iterdir()] == ["result"]


def test_the_unfinished_folder_of_a_living_writer_stays(tmp_path: Path) -> None:
    partial = tmp_path / f".result.{os.getpid()}.partial"
    partial.mkdir()
    recover(tmp_path / "result")
    assert partial.exists()
