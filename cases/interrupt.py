"""Ctrl-C and SIGTERM, so that none is lost: a run ends with a checkpoint, at once or at its next report.

While a kernel is being compiled, Python may hold an exception of a signal handler for a mistake of a callback and
drop it. Interruptions are therefore remembered, and raised again when the engine reports its progress.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fdsolver.relax import Progress

COMPILERS = ("numba", "llvmlite")
SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """Whether the user has asked to stop. The first request waits for a compiler, the second does not."""

    def __init__(self) -> None:
        self.asked = False

    def ask(self, _: int, frame: FrameType | None) -> None:
        """The signal handler: remember, and raise KeyboardInterrupt where it will arrive."""
        again, self.asked = self.asked, True
        if again or not _compiling(frame):
            raise KeyboardInterrupt

    def check(self) -> None:
        """Raise KeyboardInterrupt if a request has not been answered."""
        if self.asked:
            raise KeyboardInterrupt

    def watch(self, progress: Callable[[Progress], None] | None) -> Callable[[Progress], None]:
        """The same progress function, which also answers requests."""

        def report(now: Progress) -> None:
            self.check()
            if progress is not None:
                progress(now)

        return report


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Listen to Ctrl-C and SIGTERM until the block ends; a signal that is ignored (nohup) stays so."""
    interruption = Interruption()
    before = {number: signal.getsignal(number) for number in SIGNALS}
    heard = [number for number in SIGNALS if before[number] not in (signal.SIG_IGN, None)]
    try:
        for number in heard:
            signal.signal(number, interruption.ask)
    except ValueError:  # only the main thread may listen; others are interrupted through it
        heard = []
    try:
        yield interruption
    finally:
        for number in heard:
            signal.signal(number, before[number])


def _compiling(frame: FrameType | None) -> bool:
    while frame is not None:
        if str(frame.f_globals.get("__name__", "")).partition(".")[0] in COMPILERS:
            return True
        frame = frame.f_back
    return False
