"""Measures of an out-of-plane profile z(s): amplitude, local wavelength, number of half-waves, symmetry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cases.halfwaves import LEVEL, NOISE_FACTOR, half_waves, noise


@dataclass(frozen=True)
class Measures:
    """Measures of one profile (a section, or one circle); None where the profile is flat or has no such
    measure.

    amplitude_mm : largest |z|. rms_mm : root of the mean of z^2 along s.
    wavelength_mm : local wavelength where the envelope is largest.
    half_waves : sign changes plus one between the outermost extrema above 5 % of the amplitude; of a closed
        profile: sign changes once round.
    symmetry : correlation of z with its mirror image about the middle, -1 to 1; None for a closed profile,
        whose origin means nothing.
    """

    amplitude_mm: float
    rms_mm: float
    wavelength_mm: float | None
    half_waves: int
    symmetry: float | None


def measure(s: np.ndarray, z: np.ndarray, closed: bool = False, floor_mm: float = 0.0) -> Measures:
    """Measures of the profile z (n,) mm at the evenly or unevenly spaced places s (n,) mm, rising.

    closed : the profile is periodic and its last point repeats the first.
    floor_mm : a profile whose amplitude is not above this is flat: no wavelength, no half-waves, no symmetry.
    """
    amplitude = float(np.abs(z).max())
    if amplitude == 0.0:
        return Measures(0.0, 0.0, None, 0, None)
    # Squares of the shape, not of the heights: those of tiny heights would underflow.
    shape = z / amplitude
    rms = amplitude * float(np.sqrt(np.trapezoid(shape**2, s) / (s[-1] - s[0])))
    if not amplitude > floor_mm:
        return Measures(amplitude, rms, None, 0, None)
    waves = half_waves(s, z, closed)
    wavelength = None
    if len(waves.envelope_mm):
        wavelength = float(waves.wavelength_mm[np.argmax(waves.envelope_mm)])
    symmetry = None if closed else mirror_correlation(s, shape)
    return Measures(amplitude, rms, wavelength, count_half_waves(z, closed), symmetry)


def mirror_correlation(s: np.ndarray, z: np.ndarray) -> float:
    """Integral of z(s) z(mirrored s) over that of z^2: 1 for a symmetric, -1 for an antisymmetric profile."""
    mirrored = np.interp(s[0] + s[-1] - s, s, z)
    return float(np.clip(np.trapezoid(z * mirrored, s) / np.trapezoid(z**2, s), -1.0, 1.0))


def count_half_waves(z: np.ndarray, closed: bool = False) -> int:
    """Zero crossings (plus one if open) between the outermost extrema above 5 % of the amplitude."""
    return len(zero_crossings(np.arange(len(z), dtype=float), z, closed)) + (0 if closed else 1)


def zero_crossings(s: np.ndarray, z: np.ndarray, closed: bool = False) -> np.ndarray:
    """Places (m,), mm, where the profile z (n,) at s (n,) changes its sign, rising.

    Of an open profile only those between the outermost extrema above 5 % of the amplitude: beyond, a flat sheet crosses
    zero at random. Samples within the noise of zero have no sign. closed : the last sample repeats the first.
    """
    amplitude = np.abs(z).max()
    signed = np.flatnonzero(np.abs(z) > max(NOISE_FACTOR * noise(z), 1e-9 * amplitude))
    if not closed:
        high = np.flatnonzero(np.abs(z) >= LEVEL * amplitude)
        signed = signed[(signed >= high[0]) & (signed <= high[-1])]
    before, after = signed[:-1], signed[1:]
    change = z[before] * z[after] < 0.0
    before, after = before[change], after[change]
    places = s[before] + (s[after] - s[before]) * z[before] / (z[before] - z[after])
    if closed and len(signed) and z[signed[0]] * z[signed[-1]] < 0.0:
        places = np.append(places, s[-1])
    return places
