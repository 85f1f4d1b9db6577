"""Atomic files and checkpoints: a reader sees the old file or the whole new one, never a part of either."""

from __future__ import annotations

import contextlib
import os
import struct
import zipfile
import zlib
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import BinaryIO

import numpy as np

from fdsolver.compile_cache import source_digest

State = dict[str, "np.ndarray | float | int | str"]
# What numpy and zipfile raise for a file that is cut short, changed or something else.
UNREADABLE = (
    OSError,
    ValueError,
    EOFError,
    KeyError,
    MemoryError,  # a header that names more numbers than there is memory
    NotImplementedError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)
_IDENTITY = "checkpoint_identity"
_SOURCES = "checkpoint_sources"


class StorageError(OSError):
    """A file or folder could not be written; what was there before is unchanged. The message is one
    sentence.
    """


class CheckpointError(ValueError):
    """A checkpoint cannot be used: unreadable, cut short, or written by another run or another version."""


def storage_error(path: Path, reason: OSError) -> StorageError:
    """The one sentence for a failed write to `path`."""
    text = reason.strerror or str(reason)
    return StorageError(f"Could not write {path}: {text}. What was there before is unchanged.")


def make_folder(folder: Path) -> None:
    """Make a folder, and those above it, if it is not there. Raises StorageError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as reason:
        raise storage_error(folder, reason) from reason


def sync_directory(folder: Path) -> None:
    """Make renames inside `folder` durable (a rename lives in the directory, not in the file)."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_atomically(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file through a temporary name beside it: write, fsync, rename.

    write : called with the open temporary file.

    Raises StorageError if the disk is full, the folder is missing or may not be written.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        with open(temporary, "wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
        sync_directory(path.parent)
    except OSError as reason:
        raise storage_error(path, reason) from reason
    finally:
        _remove_quietly(temporary)


def _remove_quietly(path: Path) -> None:
    # A temporary file that cannot be removed must not hide the error that is already on its way.
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)


@cache
def _solver() -> str:
    """What identifies the solver that writes and reads."""
    return source_digest()


class Checkpoint:
    """The state of an unfinished run in one file (npz without pickles).

    path : the file.
    identity : names the run (scene, method, seed); a checkpoint of another identity is refused, as is one of another
        version of the solver: what it continued would be neither version's result.
    """

    def __init__(self, path: Path | str, identity: str) -> None:
        self.path = Path(path)
        self.identity = identity

    def save(self, state: Mapping[str, np.ndarray | float | int | str]) -> None:
        """Replace the checkpoint by `state`: arrays bit for bit, numbers and strings as they are.

        Raises StorageError if the file cannot be written, TypeError for a value that is no array, number or
        string.
        """
        arrays = {key: np.asarray(value) for key, value in state.items()}
        for key, array in arrays.items():
            if array.dtype.hasobject:
                raise TypeError(f"checkpoint entry {key!r} is no array of numbers, number or string")
        arrays |= {_IDENTITY: np.asarray(self.identity), _SOURCES: np.asarray(_solver())}
        # Any: numpy's stub would read the keyword arrays as its own options.
        write_atomically(self.path, lambda file: np.savez(file, **arrays))  # type: ignore[arg-type]

    def load(self) -> State | None:
        """The saved state, or None if there is no checkpoint.

        Raises CheckpointError for a file that is unreadable, cut short, of another run or another version.
        """
        if not self.path.exists():
            return None
        try:
            # numpy does not close a file of its own that turns out to be damaged.
            with open(self.path, "rb") as file, np.load(file, allow_pickle=False) as stored:
                arrays = {key: stored[key] for key in stored.files}
        except UNREADABLE as reason:
            raise CheckpointError(
                f"The checkpoint {self.path} is damaged or none; remove it to start from the beginning."
            ) from reason
        identity = arrays.pop(_IDENTITY, None)
        if identity is None or str(identity) != self.identity:
            raise CheckpointError(
                f"The checkpoint {self.path} belongs to another run; remove it to start from the beginning."
            )
        if str(arrays.pop(_SOURCES, None)) != _solver():
            raise CheckpointError(
                f"The checkpoint {self.path} was written by another version of the solver;"
                " remove it to start from the beginning."
            )
        return {key: array if array.ndim else array.item() for key, array in arrays.items()}

    def delete(self) -> None:
        """Remove the checkpoint, if there is one."""
        self.path.unlink(missing_ok=True)
