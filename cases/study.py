"""Parameter studies: the points of a study file, each solved into a folder of its own, and one table of them all."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cases.folders import recover
from cases.interrupt import Interruption
from cases.machine import usable_cores
from cases.study_file import Study
from cases.study_points import Point
from cases.study_pool import solve_here
from cases.study_table import result_of, write_table
from fdsolver.checkpoint import make_folder, write_atomically

if TYPE_CHECKING:
    import pandas as pd

TO_DO = ("not run", "interrupted", "died", "failed", "refused")
AT_LIMIT = ("step_limit", "time_limit")
TABLE_SECONDS = 10.0  # between two writings of the table while the study runs


def run_study(
    study: Study,
    out: Path | str,
    jobs: int | None = None,
    cluster: str | None = None,
    resume: bool = False,
    say: Callable[[str], None] | None = None,
    interruption: Interruption | None = None,
) -> pd.DataFrame:
    """Solve the points of a study that have no finished result in `out`; return the table, `out`/study.csv.

    jobs : processes at a time, by default one per core (on a cluster: as many as it lets).
    cluster : "slurm" hands the points to that queue.
    resume : also continue points that ended at a step or time limit. say : called with a line per finished point.

    Raises KeyboardInterrupt after an interruption (checkpoints are kept), StorageError if `out` cannot be written,
    ClusterError for a cluster that cannot be used.
    """
    out = Path(out)
    make_folder(out)
    write_atomically(out / "study.toml", lambda file: file.write(study.text))
    to_do = [point for point in study.points if _unfinished(point, out, resume)]
    report = _Report(study.points, len(study.points) - len(to_do), out, say)
    try:
        if cluster is None:
            solve_here(to_do, out, jobs or usable_cores(), resume, report.finished, interruption)
        else:
            from cases.study_cluster import solve_on_cluster

            solve_on_cluster(to_do, out, jobs, resume, report.finished, interruption)
    finally:
        found = write_table(study.points, out)
    return found


def _unfinished(point: Point, out: Path, resume: bool) -> bool:
    """Whether there is something to do for a point."""
    if point.refused:
        return False
    recover(out / point.name)
    status = result_of(point, out)["status"]
    return status in TO_DO or (resume and status in AT_LIMIT)


class _Report:
    """Tells what has ended and how long the rest may take, and keeps the table up to date."""

    def __init__(
        self, points: Sequence[Point], done: int, out: Path, say: Callable[[str], None] | None
    ) -> None:
        self.points, self.out, self.say = points, out, say
        self.done, self.before = done, done
        self.started = self.written = time.monotonic()
        if say is not None and done:
            say(f"{done} of {len(points)} points are there already")

    def finished(self, point: Point) -> None:
        """One more point has ended."""
        self.done += 1
        now = time.monotonic()
        if now - self.written > TABLE_SECONDS:
            write_table(self.points, self.out)
            self.written = now
        if self.say is not None:
            result = result_of(point, self.out)
            how = (
                f"{result['status']}, {result['seconds']:.3g} s"
                if "seconds" in result
                else str(result["message"])
            )
            self.say(f"[{self.done}/{len(self.points)}] {point.name}: {how}{self._left(now)}")

    def _left(self, now: float) -> str:
        """The time that the rest takes if it goes on at this rate."""
        rest = len(self.points) - self.done
        seconds = rest * (now - self.started) / max(self.done - self.before, 1)
        return f"; about {seconds / 60:.0f} min left" if rest and seconds > 60 else ""
