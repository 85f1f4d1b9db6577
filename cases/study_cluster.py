"""The points of a study as an array of Slurm jobs, by submitit (extra `cluster`).

Account, partition and the like come from sbatch's own environment variables, as SBATCH_ACCOUNT and SBATCH_PARTITION.
"""

from __future__ import annotations

import math
import shutil
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cases.interrupt import Interruption
from cases.study_points import Point
from cases.study_pool import ONE_THREAD, Finished
from cases.study_worker import LOGS, note, note_path, solve_point

if TYPE_CHECKING:
    import submitit

POLL_SECONDS = 2.0
GRACE_SECONDS = 30.0  # a file written on a node may reach this machine late
# beside the solve's own limit: queueing of files, start of Python, compilation, writing of the result
SPARE_MINUTES = 10
MOST_AT_ONCE = 1000


class ClusterError(RuntimeError):
    """The cluster cannot be used; the message is one sentence."""


@dataclass(frozen=True)
class PointJob:
    """What runs on the node."""

    point: Point
    out: str
    resume: bool

    def __call__(self) -> str:
        """Solve the point; every end but a dead process leaves a result or a note."""
        return solve_point(self.point, Path(self.out), self.resume)

    def checkpoint(self) -> submitit.helpers.DelayedSubmission:
        """What Slurm puts back into the queue when it takes the node away: the same job, from its checkpoint."""
        import submitit

        return submitit.helpers.DelayedSubmission(self)


def solve_on_cluster(
    points: Sequence[Point],
    out: Path,
    jobs: int | None,
    resume: bool,
    finished: Finished,
    interruption: Interruption | None = None,
) -> None:
    """Solve points as one array of Slurm jobs, at most `jobs` at a time, and wait for them.

    Raises ClusterError without submitit or Slurm, KeyboardInterrupt after an interruption: the jobs are then
    cancelled, their checkpoints kept.
    """
    if not points:
        return
    executor = _executor(points, out, jobs)
    orders = [PointJob(point, str(out.resolve()), resume) for point in points]
    try:
        submitted = executor.map_array(_solve, orders)
    except Exception as reason:  # submitit wraps what sbatch says in errors of its own
        raise ClusterError(f"Slurm did not take the jobs: {reason}") from reason
    running = dict(zip(submitted, points, strict=True))
    seen = dict.fromkeys(running, time.monotonic())
    try:
        while running:
            if interruption is not None:
                interruption.check()
            queued = _queued(next(iter(running)).job_id.partition("_")[0])
            for job in list(running):
                if queued is None or job.job_id in queued:
                    seen[job] = time.monotonic()
                left = time.monotonic() - seen[job] > GRACE_SECONDS
                if left or job.paths.result_pickle.exists():
                    point = running.pop(job)
                    _conclude(point, out, job)
                    finished(point)
            time.sleep(POLL_SECONDS)
    finally:
        for job in running:
            job.cancel()


def _queued(array: str) -> set[str] | None:
    """The jobs of an array that wait or run; None if Slurm does not answer.

    The queue is asked, not the accounts: not every cluster keeps any.
    """
    asked = ["squeue", "--noheader", "--array", "--format=%i", f"--jobs={array}"]
    answer = subprocess.run(asked, capture_output=True, text=True)
    if answer.returncode == 0:
        return set(answer.stdout.split())
    return set() if "Invalid job id" in answer.stderr else None


def _solve(job: PointJob) -> str:
    return job()


def _executor(points: Sequence[Point], out: Path, jobs: int | None) -> submitit.SlurmExecutor:
    """A Slurm executor with limits that the points fit into."""
    try:
        import submitit
    except ImportError:
        message = "--cluster slurm needs submitit; install it with: pip install 'wrinklebench[cluster]'"
        raise ClusterError(message) from None
    if shutil.which("sbatch") is None:
        raise ClusterError(
            "--cluster slurm needs Slurm's command sbatch, which is not on this machine's path"
        )
    executor = submitit.SlurmExecutor(folder=out.resolve() / LOGS / "slurm", max_num_timeout=3)
    executor.update_parameters(
        job_name="wrinkle",
        time=SPARE_MINUTES + math.ceil(_longest_seconds(points) / 60.0),
        cpus_per_task=1,
        array_parallelism=jobs or MOST_AT_ONCE,
        setup=[f"export {name}={value}" for name, value in ONE_THREAD.items()],
    )
    return executor


def _longest_seconds(points: Sequence[Point]) -> float:
    """The longest time limit of any point."""
    from cases.scene import load_scene

    return max(load_scene(point.scene, dict(point.changes)).solver.max_seconds for point in points)


def _conclude(point: Point, out: Path, job: Any) -> None:
    """Note the end of a job that left neither result nor note of its own."""
    if note_path(out, point.name).exists():
        return
    if not job.paths.result_pickle.exists():
        ended = f"Its job {job.job_id} left the queue without a result"
        note(out, point.name, "died", f"{ended}; the study, started again, goes on from its checkpoint.")
    elif (reason := job.exception()) is not None:
        note(out, point.name, "failed", f"Its job {job.job_id} failed: {reason}")
