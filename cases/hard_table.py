"""The table of hard cases: every case in a process of its own, so that none can take another with it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

import pandas as pd

from cases.hard import HardCase, Row, judged, unnamed
from cases.interrupt import Interruption
from cases.machine import code, machine, versions
from fdsolver.checkpoint import make_folder, write_atomically

TABLE = "hard.json"
LONGEST_SECONDS = (
    600.0  # of one case, compilation included: far beyond the limits that the cases give themselves
)
POLL_SECONDS = 0.05


def hard_cases() -> tuple[HardCase, ...]:
    """All hard cases, family by family."""
    from cases.hard_columns import column_cases
    from cases.hard_loads import load_cases
    from cases.hard_meshes import mesh_cases
    from cases.hard_scenes import scene_cases
    from cases.hard_starts import start_cases
    from cases.hard_steps import step_cases

    return (*scene_cases(), *load_cases(), *mesh_cases(), *start_cases(), *step_cases(), *column_cases())


def run_hard(
    out: Path,
    families: Sequence[str] = (),
    say: Callable[[str], None] | None = None,
    interruption: Interruption | None = None,
) -> pd.DataFrame:
    """Run the hard cases (of these families only) and leave hard.json and hard.csv in `out`.

    The table is rewritten after each case; rows made by this very code are kept when the command is given again. A case
    whose process dies, breaks or overruns its time is an unnamed end.

    Returns the table, one row per case. Raises StorageError if `out` cannot be written.
    """
    make_folder(out)
    wanted = [case for case in hard_cases() if not families or case.family in families]
    rows = _kept(out / TABLE)
    for number, case in enumerate(wanted, start=1):
        if case.name not in rows:
            if interruption is not None:
                interruption.check()
            rows[case.name] = asdict(_in_process(case, interruption))
            _write(out, [rows[case.name] for case in wanted if case.name in rows])
        if say is not None:
            say(f"[{number}/{len(wanted)}] {case.name}: {rows[case.name]['verdict']}")
    chosen = [rows[case.name] for case in wanted]
    _write(out, chosen)
    return pd.DataFrame(chosen)


def counts(table: pd.DataFrame) -> dict[str, int]:
    """How many cases came to each verdict."""
    return dict(Counter(table["verdict"]))


def read_hard(out: Path) -> list[dict]:
    """The rows of a table that `run_hard` left; empty if there is none."""
    try:
        return json.loads((out / TABLE).read_text(encoding="utf-8"))["rows"]
    except (OSError, ValueError, KeyError, TypeError):
        return []


def _kept(path: Path) -> dict[str, dict]:
    """Rows of an earlier table by name, if this very code made them."""
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        same = stored["code"]["source_sha256"] == code()["source_sha256"]
        return {row["name"]: row for row in stored["rows"]} if same else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _write(out: Path, rows: list[dict]) -> None:
    document = {"rows": rows, "code": code(), "versions": versions(), "machine": machine()}
    text = json.dumps(document, indent=1, allow_nan=True).encode()
    write_atomically(out / TABLE, lambda file: file.write(text))
    frame = pd.DataFrame(rows).drop(columns="requirements")
    write_atomically(out / "hard.csv", lambda file: file.write(frame.to_csv(index=False).encode()))


def _in_process(case: HardCase, interruption: Interruption | None) -> Row:
    """Solve one case in a process of its own."""
    top = str(Path(__file__).resolve().parents[1])
    path = os.pathsep.join(filter(None, [top, os.environ.get("PYTHONPATH")]))
    started = time.monotonic()
    worker = subprocess.Popen(
        [sys.executable, "-m", "cases.hard_table", case.name],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": path},
        text=True,
        start_new_session=True,
    )
    try:
        while True:
            try:
                printed, complaints = worker.communicate(timeout=POLL_SECONDS)
                break
            except subprocess.TimeoutExpired:
                if interruption is not None:
                    interruption.check()
                if time.monotonic() - started > LONGEST_SECONDS:
                    return unnamed(case, f"no end within {LONGEST_SECONDS:g} s", LONGEST_SECONDS)
    finally:
        if worker.poll() is None:
            worker.kill()
            worker.communicate()
    try:
        return Row(**{**json.loads(printed.splitlines()[-1])})
    except (IndexError, ValueError, TypeError):
        last = complaints.strip().splitlines()[-1:] or [f"exit code {worker.returncode}"]
        return unnamed(case, last[0][:300], time.monotonic() - started)


def main(name: str) -> int:
    """Solve the case of this name and print its row as one line of JSON: what a process of its own does."""
    case = next(case for case in hard_cases() if case.name == name)
    print(json.dumps(asdict(judged(case, case.find()))))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
