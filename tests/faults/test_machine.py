"""The machine fails: folders in use, damaged kernels, backward clocks, no memory; for disks see test_disks."""

from __future__ import annotations

import errno
import importlib.util
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numba
import pytest

from cases import load_scene, memory, run
from cases.__main__ import main
from cases.folders import FolderRefused, alone, write_folder
from cases.memory import TooManyNodes
from fdsolver import checkpoint
from fdsolver.checkpoint import Checkpoint, CheckpointError
from tests.cases.made import Fake, assert_same

WORDS = ["run", "annulus", "--method", "tension-field", "--nodes", "400", "--quiet", "--out", "out"]


def never(_: object) -> None:
    raise AssertionError("this must not be solved")


# Two at a time


def test_a_second_run_in_a_folder_is_refused_and_the_first_goes_on(tmp_path: Path, faked: Fake) -> None:
    out, sentences = tmp_path / "out", []
    scene = load_scene("annulus")

    def while_it_runs(task):
        with pytest.raises(FolderRefused) as refusal:
            run(scene, "tension-field", nodes=400, out=out, force=True)
        sentences.append(str(refusal.value))
        return solve(task)

    from cases.methods import METHODS

    solve = METHODS["tension-field"].solve
    faked(while_it_runs)
    first = run(scene, "tension-field", nodes=400, out=out)
    assert sentences == [
        f"{out} is in use by another process; wait for it, or choose another place with --out."
    ]
    faked(never)
    assert_same(run(scene, "tension-field", nodes=400, out=out), first)


def test_a_lock_goes_with_its_process_and_with_the_folder_it_was_on(tmp_path: Path, project: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    holder = "import sys, time\nfrom pathlib import Path\nfrom cases.folders import alone\n"
    holder += "with alone(Path(sys.argv[1])):\n    print('mine', flush=True)\n    time.sleep(600)\n"
    with subprocess.Popen(
        [sys.executable, "-c", holder, str(folder)], cwd=project, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None and process.stdout.readline() == "mine\n"
        with pytest.raises(FolderRefused), alone(folder):
            pass
        process.kill()
    with alone(folder):
        write_folder(folder, lambda new: (new / "result").touch())
        with alone(folder):  # the new folder: whoever comes now finds a whole result
            assert (folder / "result").exists()


# Kernels

BODY = "\ndef triple(x):\n    return 3.0 * x\n"
SOLVER = "from fdsolver.rows import compiled\n@compiled" + BODY
WITNESS = "from femref.compiled import compiled\n@compiled()" + BODY
KERNELS = pytest.mark.parametrize("kernel", [SOLVER, WITNESS], ids=["fdsolver", "femref"])


def loaded(file: Path) -> ModuleType:
    """The module as a new process would have it."""
    spec = importlib.util.spec_from_file_location("kernel", file)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@KERNELS
@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize(
    "damage",
    [
        lambda content: b"",
        lambda content: b"rubbish",
        lambda content: content[: len(content) // 2],
        lambda content: content[:200] + bytes([content[200] ^ 4]) + content[201:],
        lambda content: content[:-1] + bytes([content[-1] ^ 1]),
    ],
    ids=["empty", "rubbish", "cut", "bit", "checksum"],
)
def test_damaged_kernels_are_compiled_anew(
    kernel: str,
    suffix: str,
    damage: Callable[[bytes], bytes],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    file = tmp_path / "kernel.py"
    file.write_text(kernel)
    assert loaded(file).triple(2.0) == 6.0
    (stored,) = (tmp_path / "cache").rglob(f"*{suffix}")
    stored.write_bytes(damage(stored.read_bytes()))
    triple = loaded(file).triple
    assert triple(2.0) == 6.0
    assert sum(triple.stats.cache_hits.values()) == 0
    again = loaded(file).triple  # what was compiled anew has been kept, sound
    assert again(2.0) == 6.0
    assert sum(again.stats.cache_hits.values()) == 1


def test_a_witness_whose_sources_have_changed_anywhere_is_compiled_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    file = tmp_path / "kernel.py"
    file.write_text(WITNESS)
    assert loaded(file).triple(2.0) == 6.0
    monkeypatch.setattr("femref.compiled.sources_digest", lambda: "others")
    triple = loaded(file).triple
    assert triple(2.0) == 6.0
    assert sum(triple.stats.cache_hits.values()) == 0


@KERNELS
def test_a_cache_that_cannot_be_written_costs_a_compilation_only(
    kernel: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    (tmp_path / "kernel.py").write_text(kernel)
    triple = loaded(tmp_path / "kernel.py").triple

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(triple._cache._cache_file, "_save_index", full)
    assert triple(2.0) == 6.0


# Clocks, memory, versions


def test_clocks_that_run_backwards_change_no_bit(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    scene = load_scene("hole")
    expected = run(scene, "koiter", nodes=400)
    now = [1e9]

    def backwards() -> float:
        now[0] -= 100.0
        return now[0]

    for clock in ("time", "monotonic", "perf_counter", "process_time"):
        monkeypatch.setattr(time, clock, backwards)
    found = run(scene, "koiter", nodes=400, out=tmp_path / "out")
    monkeypatch.undo()
    assert now[0] < 1e9
    assert_same(found, expected)


def test_a_mesh_beyond_the_memory_is_refused_before_anything_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, faked: Fake
) -> None:
    faked(never)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(memory, "free_bytes", lambda: 8_000_000_000)
    words = ["run", "annulus", "--method", "tension-field", "--nodes", "50_000_000"]
    assert main(words) == 2
    assert capsys.readouterr().err == (
        "wrinkle: 50000000 nodes need at least 100 GB of memory, and 8 GB are free here;"
        " ask for fewer than 4000000 nodes.\n"
    )
    with pytest.raises(TooManyNodes):
        run(load_scene("annulus"), "tension-field", nodes=4_000_001)
    assert list(tmp_path.iterdir()) == []


def test_the_least_of_all_limits_of_memory_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = memory.free_bytes()
    assert before is None or before > 0
    (tmp_path / "memory.max").write_text("3000000\n")
    (tmp_path / "memory.current").write_text("1000000\n")
    monkeypatch.setattr(memory, "GROUP", tmp_path)
    assert memory.free_bytes() == 2_000_000
    (tmp_path / "memory.max").write_text("max\n")
    assert memory.free_bytes() != 2_000_000


def test_a_checkpoint_of_another_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = Checkpoint(tmp_path / "checkpoint.npz", "a run")
    with monkeypatch.context() as older:
        older.setattr(checkpoint, "_solver", lambda: "older")
        store.save({"step": 10})
        assert store.load() == {"step": 10}
    with pytest.raises(CheckpointError, match="written by another version of the solver; remove it to start"):
        store.load()
