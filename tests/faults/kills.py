"""Work that is killed with SIGKILL at random moments, resumed, and compared with work that was left alone."""

from __future__ import annotations

import hashlib
import json
import os
import random
import signal
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fdsolver.result import Status

POLL_SECONDS = 0.002
# what differs between two runs that computed the same
OF_THE_MOMENT = (
    "seconds",
    "cpu_seconds",
    "seconds_compile",
    "peak_memory_MB",
    "machine",
    "threads",
    "sha256",
)


@dataclass(frozen=True)
class Job:
    """What is killed.

    work : does it, or goes on with it, in a folder. results : the result folders below that folder.
    sound : raises AssertionError or ValueError for anything half-done that a reader could meet after a kill.
    of_workers : kill the processes that it started as often as itself.
    """

    name: str
    work: Callable[[Path], None]
    results: tuple[str, ...]
    sound: Callable[[Path], None]
    of_workers: bool = False


@dataclass(frozen=True)
class Chain:
    """One piece of work that was killed again and again: the moments, s, and what was wrong at the end."""

    moments: tuple[float, ...]
    faults: tuple[str, ...]


def begun(job: Job, folder: Path) -> int:
    """The process that works on the job: a copy of this one, in which everything is imported and compiled."""
    process = os.fork()
    if process:
        return process
    code = 1
    try:
        silent = os.open(folder.with_suffix(".log"), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        job.work(folder)
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def finished(job: Job, folder: Path) -> tuple[int, float]:
    """Let a job come to its end: its exit code, and the seconds that it took (of its CPU, if it works alone)."""
    started, process = time.monotonic(), begun(job, folder)
    _, status, usage = os.wait4(process, 0)
    seconds = time.monotonic() - started if job.of_workers else usage.ru_utime + usage.ru_stime
    return os.waitstatus_to_exitcode(status), seconds


def killed(job: Job, folder: Path, moment: float, of_worker: bool) -> bool:
    """Work until a moment and kill; False if the work had ended before.

    moment : seconds of the process' CPU, which a busy machine does not shift, or of the clock where it has workers.
    """
    started, process = time.monotonic(), begun(job, folder)
    while True:
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            assert os.waitstatus_to_exitcode(status) == 0, "the work failed by itself"
            return False
        used = time.monotonic() - started if job.of_workers else _cpu_seconds(process)
        if used >= moment:
            break
        time.sleep(POLL_SECONDS)
    victim = next(iter(_children(process)), process) if of_worker else process
    try:
        os.kill(victim, signal.SIGKILL)
    except ProcessLookupError:
        victim = process
        os.kill(process, signal.SIGKILL)
    _, status = os.waitpid(process, 0)
    return victim != process or os.waitstatus_to_exitcode(status) == -signal.SIGKILL


def _cpu_seconds(process: int) -> float:
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text(encoding="ascii").split()[0]) / 1e9
    except OSError:
        return 0.0


def _children(process: int) -> list[int]:
    try:
        return [int(word) for word in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    except OSError:
        return []


def chain(job: Job, folder: Path, reference: Path, seconds: float, kills: int, draw: random.Random) -> Chain:
    """Kill a job `kills` times at moments drawn over its whole length, let it finish, and hold it against `reference`.

    seconds : how long the job takes. A kill that comes too late begins the work anew, so that all of them count.
    """
    moments, faults = [], []
    while len(moments) < kills:
        moment = draw.uniform(0.0, seconds)
        before = stored(job, folder)
        if not killed(job, folder, moment, job.of_workers and len(moments) % 2 == 1):
            folder = folder.with_name(folder.name + "+")
            continue
        moments.append(round(moment, 4))
        try:
            job.sound(folder)
        except (AssertionError, ValueError) as half:
            faults.append(f"after the kill at {moment:.3f} s: {half}")
        after = stored(job, folder)
        faults += [
            f"{name} was lost or changed by a kill" for name in before if after.get(name) != before[name]
        ]
    kept = stored(job, folder)
    code, _ = finished(job, folder)
    if code != 0:
        faults.append(f"resumed, it ended with {code}")
    after = stored(job, folder)
    faults += [f"{name} was solved again" for name in kept if after.get(name) != kept[name]]
    for name in job.results:
        faults += differences(reference / name, folder / name)
    faults += [f"{left} was left behind" for left in folder.parent.rglob(f".{folder.name}*")]
    return Chain(tuple(moments), tuple(faults))


def stored(job: Job, folder: Path) -> dict[str, str]:
    """The digest of every finished result of a job; what a worker left when it lost its study is none."""
    found = {name: folder / name / "result.json" for name in job.results}
    texts = {name: path.read_bytes() for name, path in found.items() if path.exists()}
    return {
        name: hashlib.sha256(text).hexdigest()
        for name, text in texts.items()
        if json.loads(text).get("status") != Status.INTERRUPTED.value
    }


def differences(one: Path, other: Path) -> list[str]:
    """The files of two result folders that differ in any bit that is not of the clock or the machine."""
    names = [
        {str(path.relative_to(top)) for path in top.rglob("*") if path.is_file()} for top in (one, other)
    ]
    wrong = [f"{other}: {name} is there only once" for name in sorted(names[0] ^ names[1])]
    return wrong + [
        f"{other}: {name} differs"
        for name in sorted(names[0] & names[1])
        if not _equal(one / name, other / name)
    ]


def _equal(one: Path, other: Path) -> bool:
    if one.suffix == ".npz":
        with np.load(one, allow_pickle=False) as a, np.load(other, allow_pickle=False) as b:
            return a.files == b.files and all(a[name].tobytes() == b[name].tobytes() for name in a.files)
    if one.name == "result.json":
        return timeless(json.loads(one.read_text())) == timeless(json.loads(other.read_text()))
    return one.read_bytes() == other.read_bytes()


def timeless(value: Any) -> Any:
    """A JSON value without what a clock or a machine says."""
    if isinstance(value, dict):
        return {key: timeless(item) for key, item in value.items() if key not in OF_THE_MOMENT}
    return [timeless(item) for item in value] if isinstance(value, list) else value
