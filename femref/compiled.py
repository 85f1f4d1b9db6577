"""Compilation of kernels, kept on the disk under a checksum: a damaged or outdated file is compiled anew, never loaded.

Numba trusts its cache, where a changed byte of machine code computes something else, and it renews a function when its
own file changes, but not when one that it calls from another file does. Here every file ends with the SHA-256 of what
is before it, and the stamp of a function is the digest of all sources of this package.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import IndexDataCacheFile

CHECKSUM_BYTES = hashlib.sha256().digest_size


@functools.cache
def sources_digest() -> str:
    """SHA-256 of all sources of this package, in hexadecimal digits."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.name.encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()


def is_sound(path: str) -> bool:
    """Whether a file ends with the checksum of what is before it."""
    stored = Path(path).read_bytes() if Path(path).exists() else b""
    return hashlib.sha256(stored[:-CHECKSUM_BYTES]).digest() == stored[-CHECKSUM_BYTES:]


class _SealedFiles(IndexDataCacheFile):
    """The files of one function's cache. Numba's own readers stop before the checksum, where the pickle ends."""

    def save(self, key: Any, data: Any) -> None:
        """Keep a compiled function; a disk that takes no more costs a compilation, not the run."""
        with contextlib.suppress(OSError):
            super().save(key, data)

    def _load_index(self) -> dict[Any, str]:
        return super()._load_index() if is_sound(self._index_path) else {}

    def _load_data(self, name: str) -> Any:
        path = self._data_path(name)
        if not is_sound(path):
            raise OSError(f"{path} is damaged")  # which numba takes as: compile
        return super()._load_data(name)

    @contextlib.contextmanager
    def _open_for_write(self, path: str) -> Iterator[io.BytesIO]:
        content = io.BytesIO()
        with super()._open_for_write(path) as file:
            yield content
            file.write(content.getvalue() + hashlib.sha256(content.getvalue()).digest())


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """`numba.njit` with these options and the checked cache."""

    def compile_later(function: Callable[..., Any]) -> Any:
        dispatcher = numba.njit(cache=True, **options)(function)
        file = dispatcher._cache._cache_file
        name = file._index_name.removesuffix(".nbi")
        dispatcher._cache._cache_file = _SealedFiles(file._cache_path, name, sources_digest())
        return dispatcher

    return compile_later
