"""Envelope, phase and mean wavelength of a wrinkled profile, and the comparison of two profiles whatever their phase.

The phase of wrinkles is nearly neutral: sheets that differ by nothing else have the same energy and yet quite other
heights at every point. So profiles are compared by what does not depend on it. The analytic signal a = z + i H z (H the
Hilbert transform) of wrinkles z = A(s) cos(k s + phi) with a slow envelope is A(s) exp(i (k s + phi)): its size is the
envelope, and shifting the phase multiplies it by exp(i psi). The greatest correlation over all shifts psi of two
profiles is therefore |<a1, a2>| / (|a1| |a2|).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import hilbert

_PADDING = (
    8  # times the profile's length, for the spectrum: resolves the wavelength far better than the length does
)


@dataclass(frozen=True)
class WaveComparison:
    """How two profiles differ apart from their phase.

    envelope_difference : relative L2 difference of their envelopes. wavelength_difference : relative difference of
        their mean wavelengths. correlation : greatest over all phase shifts, 0 to 1. shift_deg : the shift of the
        second profile's phase that gives it, (-180, 180].
    """

    envelope_difference: float
    wavelength_difference: float
    correlation: float
    shift_deg: float


def analytic_signal(z: np.ndarray) -> np.ndarray:
    """z + i H z of an evenly sampled profile (n,), complex; zero beyond its ends."""
    return hilbert(z, 2 * len(z))[: len(z)]


def envelope(z: np.ndarray) -> np.ndarray:
    """Height (n,) of the crests of an evenly sampled profile (n,), at every sample."""
    return np.abs(analytic_signal(z))


def mean_wavelength(s: np.ndarray, z: np.ndarray) -> float:
    """Wavelength, mm, with half of the profile's power at longer and half at shorter waves.

    s : (n,) mm, even. Noise, which spreads over all waves, hardly moves it. NaN for a profile that is zero.
    """
    window = np.fft.rfft(z, _PADDING * len(z))
    power = np.abs(window) ** 2
    power[0] = 0.0
    total = np.cumsum(power)
    if not total[-1] > 0.0:
        return float("nan")
    number = np.interp(0.5 * total[-1], total, np.arange(len(power)) + 0.5)
    length = _PADDING * len(z) * (s[-1] - s[0]) / (len(z) - 1)
    return float(length / number)


def phase_deg(z: np.ndarray) -> float:
    """Phase phi of A cos(k x + phi) about the middle of an evenly sampled profile (n,), in (-90, 90] degrees.

    0 : symmetric, a crest or a trough in the middle. 90 : antisymmetric. The sign of z does not count. Meaningless for
    a profile whose envelope is not about the same on both sides.
    """
    signal = analytic_signal(z)
    angle = 0.5 * np.degrees(np.angle(np.sum(signal * signal[::-1])))
    return float(90.0 if angle <= -90.0 + 1e-9 else angle)


def shift_phase(z: np.ndarray, degrees: float) -> np.ndarray:
    """The wrinkles of an evenly sampled profile (n,) moved under their envelope by a part of a wave, (n,)."""
    return np.real(analytic_signal(z) * np.exp(1j * np.radians(degrees)))


def compare_waves(s1: np.ndarray, z1: np.ndarray, s2: np.ndarray, z2: np.ndarray) -> WaveComparison:
    """Compare two profiles on the same line whatever the phase of their waves.

    s1, z1, s2, z2 : mm, each profile evenly sampled, over the same range. The first is the reference.
    Raises ValueError for ranges that differ, and for a reference that is zero.
    """
    if max(abs(s1[0] - s2[0]), abs(s1[-1] - s2[-1])) > 1e-6 * (s1[-1] - s1[0]):
        raise ValueError(f"the profiles run from {s1[0]:g} to {s1[-1]:g} and {s2[0]:g} to {s2[-1]:g} mm")
    if not np.any(z1):
        raise ValueError("the profile to compare with is zero")
    if len(s1) >= len(s2):
        s, first, second = s1, z1, np.interp(s1, s2, z2)
    else:
        s, first, second = s2, np.interp(s2, s1, z1), z2
    a, b = analytic_signal(first), analytic_signal(second)
    product = np.vdot(b, a)
    size = np.linalg.norm(a) * np.linalg.norm(b)
    length = mean_wavelength(s, first)
    return WaveComparison(
        envelope_difference=float(np.linalg.norm(np.abs(a) - np.abs(b)) / np.linalg.norm(a)),
        wavelength_difference=abs(mean_wavelength(s, second) / length - 1.0),
        correlation=float(abs(product) / size) if size > 0.0 else 0.0,
        shift_deg=float(np.degrees(np.angle(product))),
    )
