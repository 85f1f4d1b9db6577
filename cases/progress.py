"""The progress display of a solve: nothing unless standard error is a terminal."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fdsolver.relax import Progress


@contextmanager
def display(quiet: bool = False) -> Iterator[Callable[[Progress], None] | None]:
    """A function that shows the progress it is called with; None when nobody is watching."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bars

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[residual]}  {task.fields[rate]}  {task.fields[left]}"),
    )
    with Bars(*columns, console=Console(stderr=True), transient=True) as bars:
        yield Meter(bars)


class Meter:
    """Turns the engine's reports into a bar: how much of the way to the tolerance, in orders of magnitude."""

    def __init__(self, bars: Any) -> None:
        self._bars = bars
        self._task = bars.add_task("compiling", total=1.0, residual="", rate="", left="")
        self._level: tuple[int, int] | None = None
        self._first: Progress | None = None

    def __call__(self, now: Progress) -> None:
        """Show one report."""
        if self._first is None or self._level != (now.level, now.nodes) or now.step < self._first.step:
            self._level, self._first = (now.level, now.nodes), now
        self._bars.update(
            self._task,
            description=f"mesh {now.level} of {now.levels}, {now.nodes} nodes, step {now.step}",
            completed=fraction_done(self._first, now),
            residual=f"residual {now.residual:.1e} of {now.tolerance:.0e}",
            rate=f"{now.steps_per_second:.0f} steps/s",
            left=time_left(self._first, now),
        )


def fraction_done(first: Progress, now: Progress) -> float:
    """Part of the way from the first residual of this mesh to the tolerance, logarithmically, 0 to 1."""
    whole = orders(first.residual, now.tolerance)
    done = orders(first.residual, now.residual)
    return 1.0 if whole <= 0.0 else min(max(done / whole, 0.0), 1.0)


def time_left(first: Progress, now: Progress) -> str:
    """Time left on this mesh if the residual goes on to fall as it did."""
    fallen, passed = orders(first.residual, now.residual), now.seconds - first.seconds
    if passed <= 0.0 or fallen < 0.3:  # less than a factor of 2: no rate to go by
        return "time left unknown"
    seconds = max(orders(now.residual, now.tolerance), 0.0) * passed / fallen
    return (
        f"{seconds:.0f} s left on this mesh" if seconds < 100 else f"{seconds / 60:.0f} min left on this mesh"
    )


def orders(start: float, end: float) -> float:
    """Orders of magnitude between two residuals; 0 where one is not positive and finite."""
    usable = all(math.isfinite(value) and value > 0.0 for value in (start, end))
    return math.log10(start / end) if usable else 0.0
