"""Refusal of meshes that this machine cannot hold, before anything is allocated for them."""

from __future__ import annotations

from pathlib import Path

# Measured: a plate of 200 000 nodes that is stopped after ten steps takes 2900 bytes a node beyond the interpreter's;
# finite elements take more. Less is assumed, so that nothing is refused that would have gone.
LEAST_BYTES_PER_NODE = 2000
GROUP = Path("/sys/fs/cgroup")


class TooManyNodes(ValueError):
    """A mesh needs more memory than there is; the message is one sentence."""


def refuse_too_many(nodes: int) -> None:
    """Raise TooManyNodes for a mesh that needs more memory than is free."""
    free = free_bytes()
    needed = nodes * LEAST_BYTES_PER_NODE
    if free is not None and needed > free:
        most = free // LEAST_BYTES_PER_NODE
        raise TooManyNodes(
            f"{nodes} nodes need at least {needed / 1e9:.3g} GB of memory, and {free / 1e9:.3g} GB are free here;"
            f" ask for fewer than {most} nodes."
        )


def free_bytes() -> int | None:
    """Memory that this process may still take: of the machine, of its group, under its own limit; None if unknown."""
    limits = [free for free in (_of_machine(), _of_group(), _of_process()) if free is not None]
    return max(min(limits), 0) if limits else None


def _of_machine() -> int | None:
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    for line in lines:
        if line.startswith("MemAvailable:"):
            return int(line.split()[1]) * 1024
    return None


def _of_group() -> int | None:
    """What a container or a batch system leaves, where it says so."""
    try:
        most, used = ((GROUP / name).read_text(encoding="ascii") for name in ("memory.max", "memory.current"))
        return int(most) - int(used)
    except (OSError, ValueError):  # "max": no limit
        return None


def _of_process() -> int | None:
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        used = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    except (ImportError, OSError):
        return None
    return None if limit == resource.RLIM_INFINITY else limit - used
