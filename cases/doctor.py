"""`wrinkle doctor`: versions, machine, compiler cache, what is missing; throughput of the kernels."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from importlib import util
from pathlib import Path

from cases.machine import LIBRARIES, OPTIONAL, code, machine, version_of, versions

MODULES = {"scikit-fem": "skfem"}
NEEDED = (*LIBRARIES, "rich", "jinja2")
TOO_LITTLE_MEMORY_GB = 2.0


def examine(bench: bool = False) -> int:
    """Print the examination. Returns 0, or 1 if a needed package is missing."""
    lacking = [name for name in NEEDED if util.find_spec(MODULES.get(name, name)) is None]
    ours = code()
    sources = str(ours["source_sha256"])[:12]
    print(f"wrinklebench {ours['version'] or '(not installed)'}, source digest {sources}")
    for name, version in {**versions(), **{name: version_of(name) for name in ("rich", "jinja2")}}.items():
        print(f"  {name:<13}{version or ('not installed, optional' if name in OPTIONAL else 'missing')}")
    for name, value in machine().items():
        print(f"  {name:<13}{'unknown' if value is None else value}")
    threads = os.environ.get("NUMBA_NUM_THREADS") or machine()["cores"]
    print(f"  {'threads':<13}up to {threads}; 1 unless --threads asks for more")
    print(f"  {'cache':<13}{_cache()}")
    for complaint in [f"{name} is not installed" for name in lacking] + _complaints():
        print(f"  missing: {complaint}")
    if lacking:
        return 1
    print("nothing is missing" if not _complaints() else "usable, but see above")
    return _bench() if bench else 0


def _cache() -> str:
    """Where compiled kernels are kept, and how many there are."""
    folder = _cache_folder()
    kernels = sum(1 for _ in folder.rglob("*.nbc")) if folder.is_dir() else 0
    return f"{folder} ({kernels} compiled kernels)"


def _cache_folder() -> Path:
    from fdsolver.compile_cache import folder

    return Path(os.environ.get("NUMBA_CACHE_DIR") or folder())


def _complaints() -> list[str]:
    """What works, but badly."""
    found = []
    folder = _cache_folder()
    place = next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())
    if not os.access(place, os.W_OK):
        found.append(
            f"leave to write {folder}: every run compiles anew; set NUMBA_CACHE_DIR to a folder of yours"
        )
    memory = machine()["memory_GB"]
    if isinstance(memory, float) and memory < TOO_LITTLE_MEMORY_GB:
        found.append(f"memory: {memory} GB is little; the largest meshes will not fit")
    return found


def _bench() -> int:
    """Print the measured throughput."""
    from fdsolver.bench import throughput
    from fdsolver.model import KOITER, MEMBRANE
    from tensionfield.relaxed import TENSION_FIELD

    print("measuring the kernels ...", file=sys.stderr)
    rows = throughput(
        (
            replace(TENSION_FIELD, name="tension-field in the plane", out_of_plane=False),
            TENSION_FIELD,
            replace(MEMBRANE, name="membrane in the plane", out_of_plane=False),
            MEMBRANE,
            replace(KOITER, name="koiter in the plane", out_of_plane=False),
            replace(KOITER, name="moderate rotations", moderate=True),
            replace(KOITER, name="koiter, normal of the flat sheet", strain_gradient=False),
            KOITER,
        )
    )
    names = list(rows[0])
    table = [names] + [[_cell(row[name]) for name in names] for row in rows]
    widths = [max(len(line[column]) for line in table) for column in range(len(names))]
    for line in table:
        print("  ".join(word.ljust(width) for word, width in zip(line, widths, strict=True)).rstrip())
    return 0


def _cell(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)
