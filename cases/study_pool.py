"""The points of a study on this machine: one process per point, as many at a time as asked for.

No pool of workers is shared: a process that dies takes nothing with it but its own point.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from cases.interrupt import Interruption
from cases.study_points import Point
from cases.study_worker import LOGS, note, note_path, order

POLL_SECONDS = 0.05
PATIENCE_SECONDS = 60.0  # for a worker to leave its checkpoint: compiling a kernel cannot be broken off
# the study runs one process per core: no library may start threads of its own on top
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
Finished = Callable[[Point], None]


def solve_here(
    points: Sequence[Point],
    out: Path,
    jobs: int,
    resume: bool,
    finished: Finished,
    interruption: Interruption | None = None,
) -> None:
    """Solve points in processes of their own, at most `jobs` at a time.

    finished : called after each point has ended, however it ended.

    Raises KeyboardInterrupt after an interruption, when every worker has left its checkpoint.
    """
    waiting = list(points)[::-1]
    running: dict[subprocess.Popen[bytes], Point] = {}
    try:
        while waiting or running:
            if interruption is not None:
                interruption.check()
            while waiting and len(running) < jobs:
                point = waiting.pop()
                running[_begin(point, out, resume)] = point
            for worker in [worker for worker in running if worker.poll() is not None]:
                point = running.pop(worker)
                _conclude(point, out, worker)
                finished(point)
            time.sleep(POLL_SECONDS)
    finally:
        _stop(list(running))


def _begin(point: Point, out: Path, resume: bool) -> subprocess.Popen[bytes]:
    """Start the worker of a point; what it prints goes into its log."""
    (out / LOGS).mkdir(parents=True, exist_ok=True)
    top = str(Path(__file__).resolve().parents[1])
    path = os.pathsep.join(filter(None, [top, os.environ.get("PYTHONPATH")]))
    with open(out / LOGS / f"{point.name}.log", "ab") as log:
        worker = subprocess.Popen(
            [sys.executable, "-m", "cases.study_worker"],
            stdin=subprocess.PIPE,
            stdout=log,
            stderr=log,
            env={**os.environ, **ONE_THREAD, "PYTHONPATH": path},
            start_new_session=True,  # Ctrl-C reaches the study alone, which then asks each worker once
        )
    assert worker.stdin is not None
    try:
        worker.stdin.write(order(point, out, resume).encode())
        worker.stdin.flush()
    except BrokenPipeError:
        pass  # it died before it could listen: its exit code will tell
    return worker


def _conclude(point: Point, out: Path, worker: subprocess.Popen[bytes]) -> None:
    """Close the pipe, and note the end of a worker that could not do so itself."""
    assert worker.stdin is not None
    worker.stdin.close()
    if worker.returncode < 0:
        number = -worker.returncode
        name = signal.Signals(number).name if number in set(signal.Signals) else "a signal"
        ended = f"Its process was ended by signal {number} ({name})"
        note(out, point.name, "died", f"{ended}; the study, started again, goes on from its checkpoint.")
    elif worker.returncode == 1 and not note_path(out, point.name).exists():
        note(out, point.name, "failed", f"Its process failed; {LOGS}/{point.name}.log says how.")


def _stop(workers: Sequence[subprocess.Popen[bytes]]) -> None:
    """Ask workers to leave their checkpoints and wait for them; end those that do not answer."""
    for worker in workers:
        if worker.stdin is not None:
            worker.stdin.close()  # the worker interrupts itself
    give_up = time.monotonic() + PATIENCE_SECONDS
    for worker in workers:
        try:
            worker.wait(max(give_up - time.monotonic(), 0.1))
        except subprocess.TimeoutExpired:
            worker.kill()
            worker.wait()
