"""What a result was made with: versions of the packages, the machine, the identity of our own code."""

from __future__ import annotations

import hashlib
import os
import platform
import sys
from collections.abc import Sequence
from functools import cache
from importlib import metadata
from pathlib import Path

PACKAGES = ("fdsolver", "tensionfield", "femref", "cases", "reports")
LIBRARIES = (
    "numpy",
    "scipy",
    "numba",
    "llvmlite",
    "meshio",
    "scikit-fem",
    "pandas",
    "matplotlib",
    "pydantic",
)
OPTIONAL = ("pypardiso",)


def version_of(distribution: str) -> str | None:
    """Installed version, None if it is not installed."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return None


@cache
def versions() -> dict[str, str | None]:
    """Versions of Python and of the libraries, None of what is not installed."""
    names = (*LIBRARIES, *OPTIONAL)
    return {"python": platform.python_version()} | {name: version_of(name) for name in names}


@cache
def machine() -> dict[str, str | int | float | None]:
    """System, processor, cores that this process may use, memory in GB."""
    return {
        "system": f"{platform.system()} {platform.release()}",
        "architecture": platform.machine(),
        "processor": _processor(),
        "cores": usable_cores(),
        "memory_GB": _memory_GB(),
    }


def usable_cores() -> int:
    """Number of cores that this process may use (containers and batch systems allow fewer than there are)."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


@cache
def code() -> dict[str, str | None]:
    """Version of the project and a SHA-256 over the sources of its packages."""
    return {"version": version_of("wrinklebench"), "source_sha256": source_digest(PACKAGES)}


def source_digest(packages: Sequence[str]) -> str:
    """SHA-256 over the sources of some of our packages, 64 hexadecimal digits."""
    digest = hashlib.sha256()
    top = Path(__file__).resolve().parents[1]
    for package in packages:
        for source in sorted((top / package).rglob("*.py")):
            digest.update(str(source.relative_to(top)).encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()


def peak_memory_MB() -> float | None:
    """Largest resident memory of this process so far, MB; None where the system does not tell."""
    try:  # Linux hands the peak of the process that started this one on to `getrusage`, but not to this file
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
        return next(float(line.split()[1]) * 1024 / 1e6 for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        pass
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # Linux counts kilobytes, macOS bytes.
    return peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6


def _processor() -> str | None:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or None


def _memory_GB() -> float | None:
    try:
        return round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1)
    except (AttributeError, ValueError, OSError):
        return None
