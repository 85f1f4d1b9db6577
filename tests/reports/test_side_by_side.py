"""Runs in several processes: each once, in turn, whatever happens to a helper."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from reports.side_by_side import solve_side_by_side

SOON = 30.0  # seconds; a helper takes one or two to start


def note(folder: Path, k: int, _: object) -> None:
    """Leave a file that says who did k, and take some time for it."""
    with open(folder / f"{k}", "x", encoding="utf-8") as file:
        file.write(str(os.getpid()))
    time.sleep(0.05)


def die_once(folder: Path, parent: int, k: int, _: object) -> None:
    """Die with number 3 where it is a helper's."""
    while k == 2 and os.getpid() == parent and not (folder / "dead").exists():
        time.sleep(0.01)
    if k >= 3 and os.getpid() != parent:
        (folder / "dead").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    (folder / f"{k}").touch()


def wait_for_helper(folder: Path, parent: int, k: int, progress: object) -> None:
    """In the parent: refuse as soon as a helper is at work. In a helper: work until it is asked to stop."""
    if os.getpid() != parent:
        (folder / "helper").write_text(str(os.getpid()))
        try:
            while True:
                time.sleep(0.01)
        except KeyboardInterrupt:
            (folder / "stopped").touch()
            raise
    limit = time.monotonic() + SOON
    while not (folder / "helper").exists() and time.monotonic() < limit:
        time.sleep(0.01)
    raise KeyboardInterrupt


@pytest.mark.parametrize("processes", [1, 2])
def test_every_number_is_solved_once(tmp_path: Path, processes: int) -> None:
    solve_side_by_side(partial(note, tmp_path), 120 if processes == 2 else 3, processes)
    done = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()}
    assert set(done) == {str(k) for k in range(120 if processes == 2 else 3)}
    assert len(set(done.values())) == processes


def test_what_a_dead_helper_had_in_hand_is_solved_here(tmp_path: Path) -> None:
    solve_side_by_side(partial(die_once, tmp_path, os.getpid()), 6, 2)
    assert {path.name for path in tmp_path.iterdir()} == {"dead", *map(str, range(6))}


def test_an_interrupt_lets_helpers_leave_their_checkpoints(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        solve_side_by_side(partial(wait_for_helper, tmp_path, os.getpid()), 5, 2)
    assert (tmp_path / "stopped").exists()


def test_a_helper_dies_with_the_report_that_started_it(tmp_path: Path) -> None:
    code = (
        "import os, pathlib, sys\n"
        "from functools import partial\n"
        "from reports.side_by_side import solve_side_by_side\n"
        "from tests.reports.test_side_by_side import stay\n"
        "if __name__ == '__main__':\n"
        "    solve_side_by_side(partial(stay, pathlib.Path(sys.argv[1]), os.getpid()), 5, 2)\n"
    )
    script = tmp_path / "report.py"
    script.write_text(code, encoding="utf-8")
    project = Path(__file__).parents[2]
    environment = {**os.environ, "PYTHONPATH": str(project)}
    report = subprocess.Popen([sys.executable, script, tmp_path], env=environment, cwd=project)
    limit = time.monotonic() + SOON
    while not (tmp_path / "helper").exists() and time.monotonic() < limit:
        time.sleep(0.01)
    helper = int((tmp_path / "helper").read_text(encoding="utf-8"))
    report.kill()
    report.wait()
    while _lives(helper) and time.monotonic() < limit:
        time.sleep(0.01)
    assert not _lives(helper)


def stay(folder: Path, parent: int, k: int, _: object) -> None:
    """Name the helper, and work for ever."""
    if os.getpid() != parent:
        unfinished = folder / "unfinished"
        unfinished.write_text(str(os.getpid()), encoding="utf-8")
        unfinished.rename(folder / "helper")
    while True:
        time.sleep(0.01)


def _lives(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"  # a zombie is one that nobody has waited for
