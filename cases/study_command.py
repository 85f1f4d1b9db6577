"""`wrinkle study`: from the words of the command line to a study and its table."""

from __future__ import annotations

import argparse
import sys

from cases.arguments import BAD_INPUT
from cases.commands import out_folder, whole_number
from cases.interrupt import Interruption
from cases.problems import Problem, SceneError, did_you_mean, shown
from cases.study_file import Study, load_study

CLUSTERS = ("slurm",)
MOST_JOBS = 1024
MACHINE_FAILED = ("failed", "died")  # statuses of points that the study, given again, begins anew


def study(arguments: argparse.Namespace, interruption: Interruption) -> int:
    """Solve the points of a study; 0 when finished, whatever their statuses, which the table shows.

    1 when the machine failed a point: a full disk, no memory, a process that was killed. What it was is said once.
    """
    asked, jobs = _read(arguments)
    out = out_folder(arguments.out, f"runs/{asked.name}-study")
    from cases.study import run_study
    from cases.study_cluster import ClusterError

    say = None if arguments.quiet else _say
    try:
        table = run_study(asked, out, jobs, arguments.cluster, arguments.resume, say, interruption)
    except ClusterError as refusal:
        print(f"wrinkle: {refusal}", file=sys.stderr)
        return BAD_INPUT
    counts = table["status"].value_counts()
    print(
        f"{out / 'study.csv'}: {len(table)} points; " + ", ".join(f"{n} {word}" for word, n in counts.items())
    )
    broken = table[table["status"].isin(MACHINE_FAILED)]
    for message in broken["message"].unique():
        print(f"wrinkle: {message}", file=sys.stderr)
    return int(len(broken) > 0)


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _read(arguments: argparse.Namespace) -> tuple[Study, int | None]:
    """The study and the number of processes. Raises SceneError with every problem of both."""
    problems: list[Problem] = []
    found = None
    try:
        found = load_study(arguments.study)
    except SceneError as error:
        problems += error.problems
    jobs = whole_number("--jobs", arguments.jobs, 1, MOST_JOBS, problems)
    if arguments.cluster not in (None, *CLUSTERS):
        message = f'must be "slurm"{did_you_mean(arguments.cluster, CLUSTERS)}'
        problems.append(Problem("", "--cluster", shown(arguments.cluster), message))
    if problems or found is None:
        raise SceneError(problems)
    return found, jobs
