"""The limit of a quantity on ever finer meshes, and an error band, from a sequence of meshes.

With errors C h^p the values v(h) on three meshes give p, C and the limit (Richardson 1911): the order is observed, not
assumed. The band follows the grid-convergence index of the verification literature (Roache 1998): 1.25 times the
distance of the finest value from the limit. A sequence whose values do not approach a limit in that way, because it
oscillates, its differences grow or its order is absurd, is refused with the reason; no number is made up for it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

SAFETY = 1.25  # of the grid-convergence index on three or more meshes
LEAST_ORDER, LARGEST_ORDER = (
    0.5,
    6.0,
)  # beyond, three values are no sequence of a second- to fourth-order scheme
LEAST_RATIO = 1.1  # of the mesh widths: closer meshes tell nothing
ROUNDING = 1e-12  # relative: values that agree so far have no error to observe


@dataclass(frozen=True)
class MeshLimit:
    """The limit of a sequence.

    value : the limit; the finest mesh's value where the sequence is refused. order : observed; None if refused or if
        all values agree. band : the limit is believed to lie within value +- band; if refused, the range of the last
        three values. refused : why there is no limit, empty if there is one. finest : value on the finest mesh.
    """

    value: float
    order: float | None
    band: float
    refused: str
    finest: float

    @property
    def error_of_finest(self) -> float:
        """Estimated discretisation error of the finest mesh's value, in its unit; the band if refused."""
        return self.band if self.refused else SAFETY * abs(self.value - self.finest)


def mesh_limit(nodes: Sequence[float], values: Sequence[float]) -> MeshLimit:
    """Limit of `values` on meshes of `nodes` nodes of one shape and map, so of mesh widths nodes^(-1/2).

    nodes : three or more counts, rising, each at least 1.1^2 times the one before. values : finite, of the same number.
    The last three meshes give the limit; earlier ones only widen the band, by what the limit of the three before
    the last differs.

    Raises ValueError for sequences that break these rules.
    """
    width, v = _checked(nodes, values)
    last = _limit_of_three(width[-3:], v[-3:])
    if last.refused or len(v) == 3:
        return last
    before = _limit_of_three(width[-4:-1], v[-4:-1])
    if before.refused:
        return last
    band = max(last.band, abs(before.value - last.value))
    return MeshLimit(last.value, last.order, band, "", last.finest)


def believed(limit: MeshLimit, values: Sequence[float], others: Sequence[float]) -> tuple[float, float]:
    """Lowest and highest value to believe of a quantity that random starts change too.

    values : those that gave `limit`. others : of states from several starts on one mesh, or none. With a limit this is
    its band, wider by half of the range of `others`; without one it is the range of the last three meshes and `others`,
    which shows how far results go apart, not where they lead.
    """
    if limit.refused:
        everything = [*values[-3:], *others]
        return min(everything), max(everything)
    half = limit.band + (0.5 * (max(others) - min(others)) if others else 0.0)
    return limit.value - half, limit.value + half


def _checked(nodes: Sequence[float], values: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Mesh widths and values as arrays."""
    n, v = np.asarray(nodes, dtype=float), np.asarray(values, dtype=float)
    if n.shape != v.shape or n.ndim != 1 or len(n) < 3:
        raise ValueError(f"a limit needs a value on each of at least three meshes, not {len(v)} on {len(n)}")
    if not (np.isfinite(n).all() and np.isfinite(v).all() and n.min() > 0.0):
        raise ValueError("node counts must be positive and values finite")
    width = n**-0.5
    if (width[:-1] / width[1:]).min() < LEAST_RATIO:
        raise ValueError(
            f"each mesh must be {LEAST_RATIO} times as fine as the one before; the nodes are {list(nodes)}"
        )
    return width, v


def _limit_of_three(width: np.ndarray, v: np.ndarray) -> MeshLimit:
    """Limit from three meshes, coarse to fine."""
    finest, spread = float(v[2]), float(np.ptp(v))
    first, second = float(v[0] - v[1]), float(v[1] - v[2])
    if spread <= ROUNDING * float(np.abs(v).max()):
        return MeshLimit(finest, None, spread, "", finest)
    reason = ""
    order = None
    if first * second <= 0.0:
        reason = "the values oscillate as the mesh is refined"
    elif (order := _observed_order(width, first / second)) is None:
        reason = f"the values do not converge with an order between {LEAST_ORDER:g} and {LARGEST_ORDER:g}"
    if reason or order is None:
        return MeshLimit(finest, None, spread, reason, finest)
    correction = -second / ((width[1] / width[2]) ** order - 1.0)
    return MeshLimit(finest + correction, order, SAFETY * abs(correction), "", finest)


def _observed_order(width: np.ndarray, ratio: float) -> float | None:
    """p of (h1^p - h2^p) / (h2^p - h3^p) = ratio, for any three widths; None if it is out of range.

    The left side rises with p, so there is one solution or none.
    """

    def excess(p: float) -> float:
        h1, h2, h3 = (width / width[1]) ** p
        return math.log((h1 - h2) / (h2 - h3)) - math.log(ratio)

    if excess(LEAST_ORDER) > 0.0 or excess(LARGEST_ORDER) < 0.0:
        return None
    return float(brentq(excess, LEAST_ORDER, LARGEST_ORDER, xtol=1e-12))
