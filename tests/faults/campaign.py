"""Kill, plant what is not finite, damage files, give wrong scenes: python -m tests.faults.campaign.

Leaves `faults.json` beside the verification runs, one row per kind of fault: what it was done to, how often, how it
ended. Not part of continuous integration: a hundred kills take a quarter of an hour. `--quick` is what the tests run.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from cases.scene import SceneError, load_scene
from tests.faults.damaged import FOLDER_FILES, damages
from tests.faults.jobs import RUNS, checkpoints_often, report_job, run_job, study_job
from tests.faults.kills import Job, chain, finished
from tests.faults.planted import ARRAYS, planting
from tests.inputs.test_wrong_scenes import TABLE as WRONG_SCENES

KILLS_IN_A_ROW = 3  # before a piece of work is let go to its end
SURVIVED, FAILED = "survived", "failed"


@dataclass(frozen=True)
class Row:
    """One kind of fault. moments : how often it was made to happen. outcome : "survived" or "failed".

    seconds : of CPU, of all processes that came to an end of their own.
    """

    fault: str
    what: str
    moments: int
    outcome: str
    detail: str
    seconds: float = 0.0


@dataclass(frozen=True)
class Amounts:
    """How often each fault happens: kills per run, of the study, of the report; the rest per array or file."""

    run: int = 18
    study: int = 10
    report: int = 18
    planted: int = 12
    damaged: int = 40


QUICK = Amounts(run=4, study=0, report=0, planted=1, damaged=6)


def campaign(folder: Path, amounts: Amounts, only: str = "") -> Iterator[Row]:
    """The rows, as they are found. folder : for everything that is killed and damaged."""
    checkpoints_often()
    runs = RUNS if amounts.report else RUNS[:1]
    jobs = [(run_job(*each), amounts.run) for each in runs]
    if amounts.study:
        jobs.append((study_job(folder), amounts.study))
    if amounts.report:
        jobs.append((report_job(), amounts.report))
    for job, kills in jobs:
        if only in f"kill {job.name}":
            yield killed(job, kills, folder)
    for where in ARRAYS:
        if only in f"planted {where}":
            yield not_finite(where, amounts.planted)
    for name in FOLDER_FILES:
        if only in f"damaged {name}":
            yield damaged(name, amounts.damaged, folder)
    if only in "bad input scene files":
        yield wrong_scenes(folder / "wrong.toml")


def killed(job: Job, kills: int, folder: Path) -> Row:
    """Kill a job at random moments, in chains that are let go to their end."""
    name = job.name.replace(" ", "-")
    finished(job, folder / f"{name}-first")  # compiles and loads what the job needs
    reference = folder / f"{name}-alone"
    code, seconds = finished(job, reference)
    if code != 0:
        return Row("killed", job.name, 0, FAILED, f"left alone, it ended with {code}")
    draw, done, faults, chains = random.Random(job.name), 0, [], 0
    while done < kills:
        home = folder / f"{name}-{chains}"
        home.mkdir()
        found = chain(job, home / "work", reference, seconds, min(KILLS_IN_A_ROW, kills - done), draw)
        done, chains = done + len(found.moments), chains + 1
        faults += found.faults
    detail = f"{chains} times resumed to its end, equal in every bit to the one left alone ({seconds:.2g} s)"
    return Row("killed", job.name, done, FAILED if faults else SURVIVED, "; ".join(faults) or detail)


def not_finite(where: str, times: int) -> Row:
    """Plant NaN and infinities in one array of the engine."""
    found = [planting(where, random.Random(k)) for k in range(times)]
    faults = [f"{each.value} at step {each.step}: {each.fault}" for each in found if each.fault]
    ends = Counter(each.status.value for each in found)
    when = [each.noticed for each in found if each.noticed is not None]
    detail = ", ".join(f"{count} {end}" for end, count in sorted(ends.items()))
    detail += f"; noticed after at most {max(when)} steps" if when else "; replaced before it was used"
    return Row("not finite", where, times, FAILED if faults else SURVIVED, "; ".join(faults) or detail)


def damaged(name: str, times: int, folder: Path) -> Row:
    """Cut short, change or replace one file of a result folder or a checkpoint."""
    counts = Counter(damages(name, times, folder, random.Random(name)))
    wrong = [f"{count} {end}" for end, count in counts.items() if end.startswith("wrong")]
    detail = ", ".join(f"{count} {end}" for end, count in sorted(counts.items()))
    return Row(
        "damaged file", name, counts.total(), FAILED if wrong else SURVIVED, "; ".join(wrong) or detail
    )


def wrong_scenes(file: Path) -> Row:
    """Load every wrong scene file of the tests: each must be refused with its own sentences."""
    faults = []
    for scene in WRONG_SCENES:
        file.write_text(scene["text"], encoding="utf-8")
        try:
            load_scene(file)
            said: list[str] = []
        except SceneError as refusal:
            said = [str(problem).removeprefix(f"{file}: ") for problem in refusal.problems]
        if said != scene["sentences"]:
            faults.append(f"{scene['name']}: {said}")
    detail = f"{len(WRONG_SCENES)} refused, each with its own sentences"
    return Row(
        "bad input",
        "scene files",
        len(WRONG_SCENES),
        FAILED if faults else SURVIVED,
        "; ".join(faults) or detail,
    )


def _cpu_seconds() -> float:
    """Of this process and of its children so far."""
    return sum(os.times()[:4])


def main() -> int:
    """Run the campaign; 0 if everything was survived."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("runs/benchmark"))
    parser.add_argument("--quick", action="store_true", help="a few of each, without study and report")
    parser.add_argument("--only", default="", help="part of a row's name, as in: kill report")
    chosen = parser.parse_args()
    rows: list[Row] = []
    chosen.out.mkdir(parents=True, exist_ok=True)
    spent = _cpu_seconds()
    with tempfile.TemporaryDirectory(prefix="faults-") as folder:
        for row in campaign(Path(folder), QUICK if chosen.quick else Amounts(), chosen.only):
            rows.append(replace(row, seconds=_cpu_seconds() - spent))
            spent = _cpu_seconds()
            print(f"{row.outcome:9} {row.moments:4} x {row.fault}: {row.what}: {row.detail}", flush=True)
            text = json.dumps([asdict(each) for each in rows], indent=1)
            (chosen.out / "faults.json").write_text(text, encoding="utf-8")
    print(f"{sum(row.moments for row in rows if row.fault == 'killed')} kills")
    return int(not rows or any(row.outcome == FAILED for row in rows))


if __name__ == "__main__":
    sys.exit(main())
