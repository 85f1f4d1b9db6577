"""Where compiled kernels are kept between runs.

Numba renews a compiled function when its own file changes, but a kernel here is made of functions from several files.
So the folder carries a digest of all sources that kernels are made of: an edit anywhere in them compiles anew.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

PACKAGES = (
    "fdsolver",
    "tensionfield",
)  # by name only: a law of tensionfield is compiled into the kernels of fdsolver


def folder() -> Path:
    """The folder of this source state, under XDG_CACHE_HOME or ~/.cache."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return home / "wrinklebench" / f"kernels-{source_digest()[:16]}"


def source_digest() -> str:
    """SHA-256 of all sources that the solver and its kernels are made of, in hexadecimal digits."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        for source in sorted((Path(__file__).parent.parent / package).glob("*.py")):
            digest.update(source.name.encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()


def use() -> None:
    """Let numba keep its cache there, unless NUMBA_CACHE_DIR says otherwise. To be called before numba is imported."""
    os.environ.setdefault("NUMBA_CACHE_DIR", str(folder()))
