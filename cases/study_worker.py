"""One point of a study in a process of its own: `python -m cases.study_worker`, its order on standard input.

The order is one line of JSON. The rest of standard input stays silent as long as the study lives: when it ends, the
study is gone (even by kill -9), and the worker stops with its checkpoint. A lock per point keeps two workers of the
same point apart; the system drops it with the process.
"""

from __future__ import annotations

import fcntl
import json
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

from cases.interrupt import Interruption, interruptible
from cases.study_points import Point

REFUSED, FAILED, INTERRUPTED = 2, 1, 130
LOGS = "logs"


def order(point: Point, out: Path, resume: bool) -> str:
    """What a worker is told, as one line of JSON."""
    return json.dumps({"point": asdict(point), "out": str(out), "resume": resume}) + "\n"


def solve_point(point: Point, out: Path, resume: bool, interruption: Interruption | None = None) -> str:
    """Solve a point into `out`/NAME and return the status; a finished result there is returned as it is.

    resume : also continue a run that ended at a step or time limit.

    Raises MethodError and what else `cases.run` raises; a note of it is left for the study's table.
    """
    from cases.runner import run
    from cases.scene import load_scene

    with locked(out, point.name):
        note_path(out, point.name).unlink(missing_ok=True)
        try:
            solution = run(
                load_scene(point.scene, dict(point.changes)),
                point.method,
                nodes=point.nodes,
                seed=point.seed,
                threads=point.threads,
                out=out / point.name,
                resume=resume,
                progress=None if interruption is None else interruption.watch(None),
            )
        except (ValueError, RuntimeError, ArithmeticError, OSError, MemoryError) as reason:
            status = "refused" if isinstance(reason, ValueError) else "failed"
            note(out, point.name, status, str(reason) or type(reason).__name__)
            raise
        return solution.status.value


@contextmanager
def locked(out: Path, name: str) -> Iterator[None]:
    """Wait until no other process works on the point."""
    (out / LOGS).mkdir(parents=True, exist_ok=True)
    with open(out / LOGS / f"{name}.lock", "a", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.truncate(0)
        print(os.getpid(), file=file, flush=True)  # whoever wonders who works on it
        yield


def note_path(out: Path, name: str) -> Path:
    """Where it is noted why a point has no result."""
    return out / LOGS / f"{name}.json"


def note(out: Path, name: str, status: str, message: str) -> None:
    """Leave the reason why a point has no result."""
    from fdsolver.checkpoint import write_atomically

    (out / LOGS).mkdir(parents=True, exist_ok=True)
    text = json.dumps({"status": status, "message": message}) + "\n"
    write_atomically(note_path(out, name), lambda file: file.write(text.encode("utf-8")))


def main() -> int:
    """Work on the point that standard input names. Returns an exit code as `wrinkle run` would."""
    told = json.loads(sys.stdin.readline())
    threading.Thread(target=_follow, daemon=True).start()
    with interruptible() as interruption:
        try:
            status = solve_point(Point(**told["point"]), Path(told["out"]), told["resume"], interruption)
        except KeyboardInterrupt:
            return INTERRUPTED
        except (ValueError, OSError) as reason:
            print(f"wrinkle: {reason}", file=sys.stderr)
            return FAILED if isinstance(reason, OSError) else REFUSED
    return INTERRUPTED if status == "interrupted" else 0


def _follow() -> None:
    """Interrupt this process when the study has gone."""
    # the file itself, not Python's buffered reader, whose lock would hang the interpreter's end
    while os.read(0, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


if __name__ == "__main__":
    sys.exit(main())
