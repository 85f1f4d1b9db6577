"""The report's runs in several processes, which take them from one list in its order.

A helper lives no longer than the report that started it, even if that is killed: what it was solving goes on from its
checkpoint with the next report.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from cases.interrupt import interruptible

Solve = Callable[[int, Callable[[Any], None] | None], None]
PATIENCE_SECONDS = 60.0  # for a helper to leave its checkpoint: compiling a kernel cannot be broken off
WATCH_SECONDS = 0.2
INTERRUPTED = 130


def solve_side_by_side(
    solve: Solve, count: int, processes: int, progress: Callable[[Any], None] | None = None
) -> None:
    """Call `solve` for 0 to count - 1, in this process and in up to processes - 1 helpers.

    solve : a function that can be pickled, of the number and a progress function. What a helper had in hand when it
    died is solved again here. Raises what `solve` raises in this process, after the helpers have stopped.
    """
    spawning = multiprocessing.get_context("spawn")
    turn = spawning.Value("q", 0)
    in_hand = [spawning.Value("q", count) for _ in range(max(min(processes, count) - 1, 0))]
    helpers = [spawning.Process(target=_help, args=(solve, count, turn, own, os.getpid())) for own in in_hand]
    for helper in helpers:
        helper.start()
    try:
        while (k := _next(turn)) < count:
            solve(k, progress)
        for helper, own in zip(helpers, in_hand, strict=True):
            helper.join()
            if helper.exitcode and own.value < count:
                solve(own.value, progress)
    except BaseException:
        _stop(helpers)
        raise


def _next(turn: Any) -> int:
    """The next number, which no other process gets."""
    with turn.get_lock():
        turn.value += 1
        return int(turn.value) - 1


def _help(solve: Solve, count: int, turn: Any, own: Any, parent: int) -> None:
    """What a helper does; exits with INTERRUPTED when it was asked to stop. own : the number that it has in hand."""
    threading.Thread(target=_leave_with, args=(parent,), daemon=True).start()
    with interruptible() as interruption:
        try:
            own.value = _next(turn)
            while own.value < count:
                solve(own.value, interruption.watch(None))
                own.value = _next(turn)
        except KeyboardInterrupt:
            sys.exit(INTERRUPTED)


def _leave_with(parent: int) -> None:
    """End this process as soon as it is an orphan."""
    while os.getppid() == parent:
        time.sleep(WATCH_SECONDS)
    os._exit(INTERRUPTED)


def _stop(helpers: list[Any]) -> None:
    """Ask the helpers to leave their checkpoints, and end those that do not."""
    for helper in helpers:
        helper.terminate()
    for helper in helpers:
        helper.join(PATIENCE_SECONDS)
        if helper.is_alive():
            helper.kill()
            helper.join()
