"""Compiled kernels on the disk, each file under a checksum: a damaged one is compiled anew, never loaded.

Numba trusts its cache: an index cut short ends in a traceback, and a changed byte of machine code computes something
else. The files here end with the SHA-256 of what is before it. A disk that takes no more files costs a compilation,
not the run.
"""

from __future__ import annotations

import contextlib
import hashlib
import pickle
from pathlib import Path
from typing import Any

from numba.core.caching import IndexDataCacheFile

CHECKSUM_BYTES = hashlib.sha256().digest_size


class CheckedCacheFile(IndexDataCacheFile):
    """The index and the data files of one function's cache; a damaged file counts as absent."""

    def save(self, key: Any, data: Any) -> None:
        """Keep a compiled function, if it can be kept."""
        with contextlib.suppress(OSError):
            super().save(key, data)

    def _load_index(self) -> dict[Any, str]:
        try:
            version, entries = pickle.loads(_checked(Path(self._index_path)))
        except OSError:
            return {}
        if version != self._version:
            return {}  # the entries of another numba may not be readable
        stamp, overloads = pickle.loads(entries)
        return overloads if stamp == self._source_stamp else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        entries = self._dump((self._source_stamp, overloads))
        self._write(self._index_path, (self._version, entries))

    def _load_data(self, name: str) -> Any:
        # numba takes an OSError here for a file that has been removed, and compiles
        return pickle.loads(_checked(Path(self._data_path(name))))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, content: Any) -> None:
        data = self._dump(content)
        with self._open_for_write(path) as file:
            file.write(data + hashlib.sha256(data).digest())


def _checked(path: Path) -> bytes:
    """The content of a file without its checksum. Raises OSError if there is none or the checksum is not that of it."""
    stored = path.read_bytes()
    content, checksum = stored[:-CHECKSUM_BYTES], stored[-CHECKSUM_BYTES:]
    if hashlib.sha256(content).digest() != checksum:
        raise OSError(f"{path} is damaged")
    return content


def checked(dispatcher: Any) -> Any:
    """Give a function that `numba.njit(cache=True)` returned the checked files; returns the function."""
    file = dispatcher._cache._cache_file
    dispatcher._cache._cache_file = CheckedCacheFile(
        file._cache_path, file._index_name.removesuffix(".nbi"), file._source_stamp
    )
    return dispatcher
