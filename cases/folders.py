"""Folders that appear whole: written under a temporary name beside their place, made durable, then put there
in one step.
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from fdsolver.checkpoint import storage_error, sync_directory

_CURRENT_DIRECTORY = -100  # AT_FDCWD of Linux
_EXCHANGE = 2  # RENAME_EXCHANGE of Linux


def write_folder(folder: Path, fill: Callable[[Path], None]) -> None:
    """Replace `folder` by what `fill` writes into the new folder that it is given.

    A reader finds the old folder or the new one. After any failure the old one is unchanged.

    Raises StorageError if the disk is full or the place may not be written.
    """
    folder = folder.absolute()
    temporary = folder.with_name(f".{folder.name}.{os.getpid()}.partial")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(temporary, ignore_errors=True)
        temporary.mkdir()
        fill(temporary)
        _sync(temporary)
        _put(temporary, folder)
        sync_directory(folder.parent)
    except OSError as reason:
        raise storage_error(folder, reason) from reason
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


class FolderRefused(ValueError):
    """The output folder holds something else, or another process works in it; the message is one sentence."""


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Keep other processes out of an existing folder until the block ends, however it ends.

    The lock is on the folder itself, so that it needs no file, goes with the process, and goes with the folder that
    `write_folder` replaces: whoever comes then finds the whole new one. Where the system cannot lock a folder (some
    network disks), there is none.

    Raises FolderRefused at once if another has it.
    """
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            sentence = (
                f"{folder} is in use by another process; wait for it, or choose another place with --out."
            )
            raise FolderRefused(sentence) from None
        except OSError:
            pass  # no locks here
        yield
    finally:
        os.close(handle)


def recover(folder: Path) -> None:
    """Clear up what killed writers of `folder` left beside it.

    Bring back the old folder if a kill fell between the two renames of a system without exchange; remove
    unfinished folders whose writer is no longer there.
    """
    folder = folder.absolute()
    for old in sorted(folder.parent.glob(f".{folder.name}.*.old")):
        if not folder.exists():
            os.rename(old, folder)
    for partial in folder.parent.glob(f".{folder.name}.*.partial"):
        writer = partial.name.removesuffix(".partial").rpartition(".")[2]
        if writer.isdecimal() and not _alive(int(writer)):
            shutil.rmtree(partial, ignore_errors=True)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


def _put(temporary: Path, folder: Path) -> None:
    """Give `temporary` the name of `folder`; what was there goes."""
    if not folder.exists():
        os.rename(temporary, folder)
    elif not _exchange(temporary, folder):
        old = folder.with_name(f".{folder.name}.{os.getpid()}.old")
        os.rename(folder, old)
        try:
            os.rename(temporary, folder)
        except BaseException:
            os.rename(old, folder)
            raise
        shutil.rmtree(old, ignore_errors=True)


def _exchange(first: Path, second: Path) -> bool:
    """Swap two names in one step; False where the system cannot (the caller then renames twice)."""
    try:
        rename = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError, TypeError):
        return False
    names = os.fsencode(first), os.fsencode(second)
    if rename(_CURRENT_DIRECTORY, names[0], _CURRENT_DIRECTORY, names[1], ctypes.c_uint(_EXCHANGE)) == 0:
        return True
    code = ctypes.get_errno()
    if code in (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP):
        return False
    raise OSError(code, os.strerror(code))


def _sync(folder: Path) -> None:
    """fsync every file and folder below `folder`."""
    for place, _, names in os.walk(folder):
        for name in names:
            handle = os.open(Path(place, name), os.O_RDONLY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)
        sync_directory(Path(place))
