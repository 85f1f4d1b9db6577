"""The limits of the wrinkled bands of a collocated annulus, from the sign changes of E2 + nu E1."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from tensionfield.annulus_bands import merged, runs
from tensionfield.annulus_energy import TENSE, WRINKLED, Array

SAMPLES = 400  # points per band at which the sign of the switch function is read
# A sign change shallower than this is rounding of the strains, not a band: absolute, and over the largest.
ROUNDING, RELATIVE_ROUNDING = 1e-13, 1e-9


@dataclass(frozen=True)
class Bands:
    """States of the bands from the inside, and the radii between them."""

    states: tuple[int, ...]
    limits: tuple[float, ...]

    def edges(self, inner: float) -> tuple[float, ...]:
        """Return the radii of all band ends, rims included."""
        return (inner, *self.limits, 1.0)


def _sample_radii(edges: tuple[float, ...]) -> Array:
    """Return radii inside the bands and at both rims, denser towards the band ends.

    The limits themselves are left out: there the switch function has a value from either side.
    """
    share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, SAMPLES))
    inside = [low + (high - low) * share[1:-1] for low, high in zip(edges[:-1], edges[1:], strict=True)]
    return np.concatenate([[edges[0]], *inside, [edges[-1]]])


def moved(switch: Callable[[Array], Array], bands: Bands, inner: float) -> Bands:
    """Return the bands between the sign changes of the switch function of a solution with the given bands.

    switch : radii (m,) -> E2 + nu E1 (m,); at a limit, its value from the inner side.
    """
    radii = _sample_radii(bands.edges(inner))
    values = switch(radii)
    depth = ROUNDING + RELATIVE_ROUNDING * float(np.max(np.abs(values)))
    signs = np.where(values > 0.0, TENSE, WRINKLED)
    states, changes = runs(signs)
    for index, part in enumerate(np.split(np.arange(values.size), changes)):
        if np.max(np.abs(values[part])) <= depth:
            signs[part] = states[index - 1] if index else states[min(1, len(states) - 1)]
    states, changes = runs(signs)
    limits = [_zero(switch, radii[i - 1], radii[i], bands.limits, int(signs[i - 1])) for i in changes]
    return Bands(*merged(states, limits, inner))


def _zero(
    switch: Callable[[Array], Array], low: float, high: float, limits: tuple[float, ...], state_below: int
) -> float:
    """Return the zero of the switch function between `low` and `high`, where its signs differ.

    Its values on the two sides of a present limit in between come from different branches, and the zero is
    looked for on the side whose sign has changed; a limit at which neither has changed is the zero already.
    """

    def value(radius: float) -> float:
        return float(switch(np.array([radius]))[0])

    for limit in limits:
        if low < limit < high:
            sign = 1.0 if state_below == TENSE else -1.0
            above = float(np.nextafter(limit, 2.0))
            if sign * value(limit) < 0.0:
                high = limit
            elif sign * value(above) > 0.0:
                low = above
            else:
                return limit
    at_low, at_high = value(low), value(high)
    if at_low * at_high >= 0.0:  # a run too shallow to be a band was joined to its neighbour
        return low if abs(at_low) < abs(at_high) else high
    return float(brentq(value, low, high, xtol=1e-16, rtol=1e-15))
