"""A quantity on a sequence of meshes: its value on the finest, its limit, and how far to trust that."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from reports.loads import planned_nodes
from reports.stored import Stored
from reports.style import number

ORDER = 2.0  # of the scheme in the mesh spacing


@dataclass(frozen=True)
class Banded:
    """finest : value on the finest mesh.  limit : extrapolated.  band : half width about the limit; NaN unknown."""

    finest: float
    limit: float
    band: float

    def text(self, digits: int = 3) -> str:
        """Limit and band, or the finest value alone where there is no sequence."""
        if math.isnan(self.limit):
            return number(self.finest, digits)
        return f"{number(self.limit, digits)} ± {number(self.band, 2)}"


def banded(
    stored: Sequence[Stored],
    quantity: Callable[[Stored], float],
    alike: Callable[[Stored], bool] | None = None,
) -> Banded:
    """Extrapolate a quantity over the converged runs of one load.

    alike : says of what kind a state is (wrinkled, or flat); only meshes that agree are extrapolated.
    """
    runs = sorted((s for s in stored if s.converged), key=planned_nodes)
    if not runs:
        return Banded(math.nan, math.nan, math.nan)
    values, nodes = [quantity(s) for s in runs], [planned_nodes(s) for s in runs]
    differ = alike is not None and len({alike(s) for s in runs[-2:]}) > 1
    if len(runs) < 2 or nodes[-1] == nodes[-2] or differ or not math.isfinite(values[-1] + values[-2]):
        return Banded(values[-1], math.nan, math.nan)
    ratio = (nodes[-1] / nodes[-2]) ** (ORDER / 2.0)
    limit = values[-1] + (values[-1] - values[-2]) / (ratio - 1.0)
    return Banded(values[-1], limit, abs(limit - values[-1]))
