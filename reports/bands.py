"""A quantity on a sequence of meshes: its value on the finest, its limit, and how far to trust that."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from cases.mesh_sequence import mesh_limit
from reports.loads import planned_nodes
from reports.stored import Stored
from reports.style import number

FEWEST = 3  # meshes that a limit needs


@dataclass(frozen=True)
class Banded:
    """A quantity with what its mesh sequence says; NaN where that is unknown.

    finest : value on the finest mesh. value : the limit, or `finest` where there is none. band : half width about
        `value`. error : of the finest mesh's value. order : observed; NaN without a limit.
    """

    finest: float
    value: float = math.nan
    band: float = math.nan
    error: float = math.nan
    order: float = math.nan

    def text(self, digits: int = 3) -> str:
        """Value and band, or the finest value alone where there is no sequence."""
        if math.isnan(self.band):
            return number(self.finest, digits)
        return f"{number(self.value, digits)} ± {number(self.band, 2)}"


def banded(
    stored: Sequence[Stored],
    quantity: Callable[[Stored], float],
    alike: Callable[[Stored], bool] | None = None,
) -> Banded:
    """Limit and band of a quantity over the converged runs of one load.

    alike : says of what kind a state is (wrinkled, or flat); only meshes that agree make a sequence.
    """
    runs = sorted((s for s in stored if s.converged), key=planned_nodes)
    if not runs:
        return Banded(math.nan)
    values, nodes = [quantity(s) for s in runs], [planned_nodes(s) for s in runs]
    if alike is not None:
        while runs and alike(runs[0]) != alike(runs[-1]):
            runs, values, nodes = runs[1:], values[1:], nodes[1:]
        if len({alike(s) for s in runs}) > 1:
            return Banded(values[-1])
    if len(runs) < FEWEST or not all(math.isfinite(v) for v in values):
        return Banded(values[-1], values[-1])
    try:
        limit = mesh_limit(nodes, values)
    except ValueError:  # meshes too close to each other
        return Banded(values[-1], values[-1])
    order = math.nan if limit.order is None else limit.order
    return Banded(limit.finest, limit.value, limit.band, limit.error_of_finest, order)


def counted(stored: Sequence[Stored], count: Callable[[Stored], float]) -> Banded:
    """A whole number on the finest mesh, with the largest difference of the other meshes from it as band."""
    runs = sorted((s for s in stored if s.converged), key=planned_nodes)
    values = [count(s) for s in runs]
    if not values or not math.isfinite(values[-1]):
        return Banded(math.nan)
    apart = max((abs(v - values[-1]) for v in values if math.isfinite(v)), default=0.0)
    return Banded(values[-1], values[-1], apart if len(values) > 1 else math.nan, apart)
