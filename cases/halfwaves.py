"""The half-waves of an out-of-plane profile z(s), and their local wavelengths.

The profile is cut into half-waves. A turning point counts once the profile has come back from it by 5 % of
the amplitude (more if the profile is noisy), so ripples of that size make no waves. Between two successive
turning points the half-waves meet where z passes zero; where both points lie on one side of zero, where it
passes their mean (a wave riding on a slow bow). For z = e(s) cos(k s) the zeros, hence the wavelengths, do
not depend on the envelope e.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# The level for the outermost extrema, and the smallest return that makes a turning point.
LEVEL = 0.05
# Turning points this many noise standard deviations deep are not noise (5: once in 10^6 samples).
NOISE_FACTOR = 5.0
# Only half-waves above this part of the largest count for the smallest wavelength (contract of
# nodes_per_wrinkle).
_ENVELOPE_PART = 0.2


@dataclass(frozen=True)
class HalfWaves:
    """The complete half-waves of a profile, in order of s; each array (n,).

    start_mm, end_mm : where they begin and end (end may pass the length of a closed profile).
    envelope_mm : distance of the turning point from the nearer of the levels at which the half-wave begins
        and ends.
    wavelength_mm : twice its length, averaged with its neighbours' (1 : 2 : 1) where it has two.
    """

    start_mm: np.ndarray
    end_mm: np.ndarray
    envelope_mm: np.ndarray
    wavelength_mm: np.ndarray


def noise(z: np.ndarray) -> float:
    """Standard deviation of the white noise on a profile sampled finely, from its fourth differences
    (median).
    """
    if len(z) < 9:
        return 0.0
    fourth = np.diff(z, 4)
    # sqrt(70): norm of (1, -4, 6, -4, 1); 1.4826: median of |x| to standard deviation.
    return float(1.4826 * np.median(np.abs(fourth)) / np.sqrt(70.0))


def half_waves(s: np.ndarray, z: np.ndarray, closed: bool = False) -> HalfWaves:
    """Cut a profile into its complete half-waves.

    A half-wave at an end of an open profile is complete only if z has come back to zero there (below 5 %
    of the amplitude). A closed profile is cut once round, from an arbitrary half-wave on.
    """
    length = s[-1] - s[0]
    depth = max(LEVEL * float(np.abs(z).max()), NOISE_FACTOR * noise(z))
    if closed:
        s, z = _thrice_round(s, z)
    turns = turning_points(z, depth)
    before, turns, after = ([], turns, []) if closed else _ends(s, z, turns)
    pairs = list(zip(turns[:-1], turns[1:], strict=True))
    levels = [0.0] * len(before) + [_level(z[m], z[n]) for m, n in pairs] + [0.0] * len(after)
    crossings = before + [_crossing(s, z, m, n, _level(z[m], z[n])) for m, n in pairs] + after
    # The first turning point has a half-wave only if something closes it on the left, the last one on the
    # right.
    inner = turns[1 - len(before) : len(turns) - 1 + len(after)]
    envelope = np.array(
        [min(abs(z[turn] - level) for level in levels[k : k + 2]) for k, turn in enumerate(inner)],
        dtype=float,
    )
    start, end = np.array(crossings[:-1], dtype=float), np.array(crossings[1:], dtype=float)
    wavelength = _averaged(2.0 * (end - start), envelope)
    once = _once_round(start, length) if closed else np.arange(len(start))
    return HalfWaves(start[once], end[once], envelope[once], wavelength[once])


def smallest_wavelength_ratio(waves: HalfWaves, s: np.ndarray, spacing_mm: np.ndarray) -> float | None:
    """Smallest local wavelength over the node spacing (n,) given at s, among half-waves above 20 % of the
    largest envelope.
    """
    if not len(waves.envelope_mm):
        return None
    high = waves.envelope_mm > _ENVELOPE_PART * waves.envelope_mm.max()
    length = s[-1] - s[0]
    middle = s[0] + np.mod(0.5 * (waves.start_mm + waves.end_mm) - s[0], length)
    ratio = waves.wavelength_mm / np.interp(middle, s, spacing_mm)
    return float(ratio[high].min())


def turning_points(z: np.ndarray, depth: float) -> list[int]:
    """Indices of alternating maxima and minima, each at least `depth` from the next (the ends may be among
    them).
    """
    turns: list[int] = []
    low = high = 0
    rising = 0
    for k in range(1, len(z)):
        if z[k] > z[high]:
            high = k
        if z[k] < z[low]:
            low = k
        if rising >= 0 and z[high] - z[k] > depth:
            if rising == 0 and low < high and z[high] - z[low] > depth:
                turns.append(low)
            turns.append(high)
            rising, low = -1, k
        elif rising <= 0 and z[k] - z[low] > depth:
            if rising == 0 and high < low and z[high] - z[low] > depth:
                turns.append(high)
            turns.append(low)
            rising, high = 1, k
    if turns:
        turns.append(high if rising > 0 else low)
    return turns


def _level(first: float, second: float) -> float:
    return 0.0 if first * second < 0.0 else 0.5 * float(first + second)


def _crossing(s: np.ndarray, z: np.ndarray, first: int, last: int, level: float) -> float:
    """Where z passes `level` between two samples; the mean of the outermost passes if noise makes several."""
    part = z[first : last + 1] - level
    passes = np.flatnonzero(part[:-1] * part[1:] <= 0.0)
    places = []
    for k in (passes[0], passes[-1]):
        step = part[k + 1] - part[k]
        fraction = -part[k] / step if step else 0.5
        places.append(s[first + k] + fraction * (s[first + k + 1] - s[first + k]))
    return 0.5 * float(places[0] + places[1])


def _thrice_round(s: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A closed profile (last point = first) written three times, from its largest |z| on."""
    count = len(z) - 1
    order = int(np.argmax(np.abs(z[:-1]))) + np.arange(3 * count + 1)
    return s[order % count] + (s[-1] - s[0]) * (order // count), z[order % count]


def _once_round(start: np.ndarray, length: float) -> np.ndarray:
    """Indices of the half-waves of the second of three rounds.

    The first round still depends on where it began. Crests and troughs alternate, so a round has an even
    number of half-waves: this tells apart those that begin at almost the same place.
    """
    if len(start) < 3:
        return np.arange(0)
    first = int(np.searchsorted(start, start[0] + 0.5 * length))
    even = np.arange(first + 2, len(start), 2)
    end = even[np.argmin(np.abs(start[even] - start[first] - length))]
    return np.arange(first, end)


def _ends(s: np.ndarray, z: np.ndarray, turns: list[int]) -> tuple[list[float], list[int], list[float]]:
    """Where the outermost half-waves of an open profile have come back to zero: before, turning points,
    after.

    An outermost turning point below 5 % of the amplitude is no wave but the end of its neighbour, whose zero
    is extrapolated from where |z| passes 10 % and 5 %.
    """
    before: list[float] = []
    after: list[float] = []
    level = LEVEL * float(np.abs(z).max())
    if len(turns) > 1 and abs(z[turns[0]]) <= level and abs(z[turns[1]]) > 2.0 * level:
        turns = turns[1:]
        part = slice(turns[0], None, -1)
        before = [max(_vanishing(s[part], np.abs(z[part]), level), float(s[0]))]
    if len(turns) > 1 and abs(z[turns[-1]]) <= level and abs(z[turns[-2]]) > 2.0 * level:
        turns = turns[:-1]
        after = [min(_vanishing(s[turns[-1] :], np.abs(z[turns[-1] :]), level), float(s[-1]))]
    elif len(turns) == 1 and before and abs(z[-1]) <= level:
        after = [min(_vanishing(s[turns[0] :], np.abs(z[turns[0] :]), level), float(s[-1]))]
    return before, turns, after


def _vanishing(s: np.ndarray, height: np.ndarray, level: float) -> float:
    """Zero of `height`, extrapolated linearly through the places where it first falls to 2 level and to
    level.
    """
    places = []
    for target in (2.0 * level, level):
        k = int(np.argmax(height <= target))
        fraction = (height[k - 1] - target) / (height[k - 1] - height[k])
        places.append(s[k - 1] + fraction * (s[k] - s[k - 1]))
    return float(2.0 * places[1] - places[0])


def _averaged(values: np.ndarray, envelope: np.ndarray) -> np.ndarray:
    """1 : 2 : 1 means of neighbours; the ends as they are.

    A neighbour less than half as high belongs to another part of the profile and is replaced by the value
    itself.
    """
    averaged = values.copy()
    if len(values) >= 3:
        own, high = values[1:-1], 0.5 * envelope[1:-1]
        left = np.where(envelope[:-2] >= high, values[:-2], own)
        right = np.where(envelope[2:] >= high, values[2:], own)
        averaged[1:-1] = 0.25 * left + 0.5 * own + 0.25 * right
    return averaged
