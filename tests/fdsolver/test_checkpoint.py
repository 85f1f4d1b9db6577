"""Checkpoints: bit for bit, never in part, and only for the run that wrote them."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fdsolver import checkpoint as module
from fdsolver.checkpoint import Checkpoint, CheckpointError, StorageError

STATE = {
    "r": np.random.default_rng(3).normal(size=(3, 7, 5)),
    "empty": np.zeros((0, 6)),
    "step": 1200,
    "viscosity": 0.1 + 0.2,
    "best": np.inf,
    "done": '[{"nodes": 400}]',
}


def test_every_value_comes_back_with_the_same_bits_and_kind(tmp_path: Path) -> None:
    store = Checkpoint(tmp_path / "checkpoint.npz", "a run")
    store.save(STATE)
    loaded = store.load()
    assert loaded is not None
    assert set(loaded) == set(STATE)
    assert loaded["r"].tobytes() == STATE["r"].tobytes()
    assert loaded["empty"].shape == (0, 6)
    for key in ("step", "viscosity", "best", "done"):
        assert loaded[key] == STATE[key]
        assert type(loaded[key]) is type(STATE[key])


def test_there_is_nothing_before_the_first_save_and_after_delete(tmp_path: Path) -> None:
    store = Checkpoint(tmp_path / "checkpoint.npz", "a run")
    assert store.load() is None
    store.save(STATE)
    store.delete()
    store.delete()
    assert store.load() is None
    assert list(tmp_path.iterdir()) == []


def test_a_checkpoint_of_another_run_is_refused(tmp_path: Path) -> None:
    Checkpoint(tmp_path / "checkpoint.npz", "a run").save(STATE)
    with pytest.raises(CheckpointError, match="belongs to another run"):
        Checkpoint(tmp_path / "checkpoint.npz", "b run").load()


def test_an_archive_without_identity_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "checkpoint.npz", r=np.zeros(3))
    with pytest.raises(CheckpointError, match="belongs to another run"):
        Checkpoint(tmp_path / "checkpoint.npz", "a run").load()


def test_what_would_need_a_pickle_is_not_saved(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="'levels'"):
        Checkpoint(tmp_path / "checkpoint.npz", "a run").save({"levels": [{"nodes": 400}]})  # type: ignore[dict-item]
    assert list(tmp_path.iterdir()) == []


def test_a_pickle_is_not_executed(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.npz"
    np.savez(path, r=np.array([{"an": "object"}], dtype=object))
    with pytest.raises(CheckpointError, match="damaged"):
        Checkpoint(path, "a run").load()


def test_a_file_cut_short_anywhere_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.npz"
    store = Checkpoint(path, "a run")
    store.save(STATE)
    whole = path.read_bytes()
    for length in range(0, len(whole), 97):
        path.write_bytes(whole[:length])
        with pytest.raises(CheckpointError, match="damaged"):
            store.load()


def test_a_changed_byte_is_refused_or_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.npz"
    store = Checkpoint(path, "a run")
    store.save(STATE)
    whole = path.read_bytes()
    refused = 0
    for place in range(0, len(whole), 31):
        changed = bytearray(whole)
        changed[place] ^= 0x55
        path.write_bytes(changed)
        try:
            loaded = store.load()
        except CheckpointError:
            refused += 1
        else:
            # Time stamps and other entries of the archive that carry no data.
            assert loaded is not None
            assert loaded["r"].tobytes() == STATE["r"].tobytes()
    # Most of the bytes are data under a checksum.
    assert refused > 0.5 * len(range(0, len(whole), 31))


def test_a_full_disk_leaves_the_old_checkpoint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = Checkpoint(tmp_path / "checkpoint.npz", "a run")
    store.save(STATE)

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(module.os, "fsync", full)
    sentence = f"Could not write {store.path}: No space left on device. What was there before is unchanged."
    with pytest.raises(StorageError, match=re.escape(sentence)):
        store.save({"r": np.ones(3)})
    monkeypatch.undo()
    loaded = store.load()
    assert loaded is not None
    assert loaded["step"] == 1200
    assert [path.name for path in tmp_path.iterdir()] == ["checkpoint.npz"]


def test_a_file_size_limit_leaves_the_old_checkpoint(tmp_path: Path, project: Path) -> None:
    """The same with a real refusal of the system, in a process of its own."""
    store = Checkpoint(tmp_path / "checkpoint.npz", "a run")
    store.save(STATE)
    script = (
        "import resource, signal, sys, numpy as np\n"
        "from fdsolver.checkpoint import Checkpoint, StorageError\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))\n"
        "try:\n"
        "    Checkpoint(sys.argv[1], 'a run').save({'r': np.zeros(100000)})\n"
        "except StorageError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(store.path)], capture_output=True, text=True, cwd=project
    )
    assert "Could not write" in done.stdout, done.stderr
    loaded = store.load()
    assert loaded is not None
    assert loaded["step"] == 1200
    assert [path.name for path in tmp_path.iterdir()] == ["checkpoint.npz"]


KILLED_SAVE = """
import builtins, os, signal, sys
import numpy as np
from fdsolver import checkpoint

def die():
    os.kill(os.getpid(), signal.SIGKILL)

class Dying:
    # a file that kills its process once so many bytes are on the disk

    def __init__(self, file, most):
        self.file, self.most = file, most

    def write(self, data):
        self.most -= len(data)
        if self.most < 0:
            self.file.flush()
            die()
        return self.file.write(data)

    def __getattr__(self, name):
        return getattr(self.file, name)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

where = sys.argv[2]
if where.isdigit():
    checkpoint.open = lambda *words: Dying(builtins.open(*words), int(where))
else:
    setattr(checkpoint.os, where, lambda *_: die())
checkpoint.Checkpoint(sys.argv[1], "a run").save({"r": np.ones(20000), "step": 2})
"""


@pytest.mark.parametrize("where", ["0", "100", "5000", "160000", "fsync", "replace"])
def test_a_kill_at_any_time_leaves_the_old_checkpoint(where: str, tmp_path: Path, project: Path) -> None:
    """Killed before the first byte, amid the data, in the directory of the archive, before fsync, before the
    rename.
    """
    store = Checkpoint(tmp_path / "checkpoint.npz", "a run")
    store.save(STATE)
    done = subprocess.run([sys.executable, "-c", KILLED_SAVE, str(store.path), where], cwd=project)
    assert done.returncode == -signal.SIGKILL
    loaded = store.load()
    assert loaded is not None
    assert loaded["step"] == 1200
    assert loaded["r"].tobytes() == STATE["r"].tobytes()
