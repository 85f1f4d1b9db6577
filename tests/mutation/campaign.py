"""Plant small wrong changes one by one and see whether the tests catch them: python -m tests.mutation.campaign.

Works on copies of the project, several at a time; leaves `mutants.json` beside the verification runs, which the report
renders. Not part of continuous integration: every change compiles all kernels again.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parents[1]
COPIED = (
    "fdsolver",
    "tensionfield",
    "femref",
    "cases",
    "reports",
    "tests",
    "pyproject.toml",
    "README.md",
    "Makefile",
)
LONGEST_SECONDS = 1800.0


@dataclass(frozen=True)
class Mutant:
    """One wrong change. old, new : text in `file`. tests : files whose tests must catch it."""

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]


@dataclass(frozen=True)
class Outcome:
    """Whether a mutant was caught, and by which test first."""

    name: str
    file: str
    caught: bool
    by: str
    seconds: float


def mutants(path: Path = HERE / "mutants.toml") -> tuple[Mutant, ...]:
    """The declared mutants."""
    declared = tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]
    return tuple(Mutant(**{**entry, "tests": tuple(entry["tests"])}) for entry in declared)


def planted(mutant: Mutant, text: str) -> str:
    """The file's text with the wrong change. Raises ValueError unless `old` is there just once."""
    if text.count(mutant.old) != 1:
        raise ValueError(f"{mutant.file}: {mutant.old!r} occurs {text.count(mutant.old)} times, not once")
    return text.replace(mutant.old, mutant.new)


def try_mutant(mutant: Mutant) -> Outcome:
    """Run a mutant's tests on a copy of the project."""
    started = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="mutant-") as folder:
        copy = Path(folder) / "project"
        for name in COPIED:
            source = PROJECT / name
            if source.is_dir():
                shutil.copytree(source, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                copy.mkdir(exist_ok=True)
                shutil.copy(source, copy / name)
        target = copy / mutant.file
        target.write_text(planted(mutant, target.read_text(encoding="utf-8")), encoding="utf-8")
        ended = _run_tests(copy, mutant.tests)
    failed = [
        line.split(" ")[1] for line in ended.stdout.splitlines() if line.startswith(("FAILED ", "ERROR "))
    ]
    # 1: tests failed, 2: the import failed; anything else is no catch but a fault of the campaign
    caught = ended.returncode in (1, 2) and bool(failed)
    return Outcome(mutant.name, mutant.file, caught, failed[0] if failed else "", time.monotonic() - started)


def _run_tests(copy: Path, tests: tuple[str, ...]) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(copy), "NUMBA_CACHE_DIR": str(copy / "kernels")}
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-rfE", *tests]
    return subprocess.run(
        command,
        cwd=copy,
        env=environment,
        capture_output=True,
        text=True,
        timeout=LONGEST_SECONDS,
        check=False,
    )


def main() -> int:
    """Run the campaign; 0 if every mutant was caught."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("runs/benchmark"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--only", default="", help="part of a mutant's name or file")
    chosen = parser.parse_args()
    wanted = [mutant for mutant in mutants() if chosen.only in mutant.name or chosen.only in mutant.file]
    outcomes = []
    with ThreadPoolExecutor(chosen.jobs) as pool:
        for outcome in pool.map(try_mutant, wanted):
            outcomes.append(outcome)
            print(
                f"{'caught  ' if outcome.caught else 'SURVIVED'} {outcome.seconds:6.0f} s  {outcome.name}",
                flush=True,
            )
            chosen.out.mkdir(parents=True, exist_ok=True)
            text = json.dumps([asdict(item) for item in outcomes], indent=1)
            (chosen.out / "mutants.json").write_text(text, encoding="utf-8")
    return int(not all(outcome.caught for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main())
