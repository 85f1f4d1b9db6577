"""Envelope, phase and mean wavelength of made profiles, clean and noisy, and their comparison whatever the phase."""

from __future__ import annotations

import numpy as np
import pytest

from cases.envelope import compare_waves, envelope, mean_wavelength, phase_deg, shift_phase

S = np.linspace(-50.0, 50.0, 1001)
WAVE = 10.0
# The bell's spectrum has the width 1 / WIDTH; what it holds of negative wavenumbers is below exp(-(k WIDTH / 2)^2).
WIDTH = 15.0
CLOSE = 1e-6


def train(phase: float, wave: float = WAVE, height: float = 1.0, centre: float = 0.0) -> np.ndarray:
    """Wrinkles under a bell about `centre`, their phase in degrees given there."""
    x = S - centre
    return height * np.exp(-((x / WIDTH) ** 2)) * np.cos(2.0 * np.pi * x / wave + np.radians(phase))


def noisy(z: np.ndarray, share: float, seed: int = 1) -> np.ndarray:
    return z + share * np.abs(z).max() * np.random.default_rng(seed).standard_normal(z.shape)


@pytest.mark.parametrize("phase", [0.0, 37.0, 90.0])
def test_the_envelope_is_the_bell_whatever_the_phase(phase: float) -> None:
    # the bell is cut at 50 mm, where it is exp(-11)
    np.testing.assert_allclose(envelope(train(phase)), np.exp(-((S / WIDTH) ** 2)), atol=1e-4)


def test_the_envelope_of_noisy_wrinkles() -> None:
    share = 0.02
    error = envelope(noisy(train(30.0), share)) - np.exp(-((S / WIDTH) ** 2))
    # noise and its Hilbert transform add to the envelope's square: sqrt(2) of its size where the train is low
    assert np.sqrt(np.mean(error**2)) < 1.5 * share


@pytest.mark.parametrize("phase", [-60.0, -30.0, 0.0, 20.0, 45.0, 89.0, 90.0])
def test_the_phase_about_the_middle(phase: float) -> None:
    for sign in (1.0, -1.0):
        assert phase_deg(sign * train(phase)) == pytest.approx(phase, abs=0.01)


def test_the_phase_of_noisy_wrinkles() -> None:
    # 2 % noise on about 300 samples of the train: 0.02 / sqrt(300) rad
    assert phase_deg(noisy(train(25.0), 0.02)) == pytest.approx(25.0, abs=0.5)


@pytest.mark.parametrize("wave", [5.0, 10.0, 23.0])
def test_mean_wavelength(wave: float) -> None:
    """A spectrum symmetric about 2 pi / wave; its median is that, but for the part cut off at zero."""
    assert mean_wavelength(S, train(0.0, wave)) == pytest.approx(wave, rel=2e-3)
    # of the power of 2 % noise on 1000 samples, 4e-4 of the train's peak, half is at shorter waves
    assert mean_wavelength(S, noisy(train(0.0, wave), 0.02)) == pytest.approx(wave, rel=5e-3)
    assert np.isnan(mean_wavelength(S, 0.0 * S))


def test_a_wave_without_end_has_its_wavelength() -> None:
    """Ten whole waves: the main lobe of the cut-off spectrum is symmetric but for the mirror image's tail."""
    assert mean_wavelength(S, np.sin(2.0 * np.pi * S / WAVE)) == pytest.approx(WAVE, rel=5e-3)


def test_a_shifted_phase_is_the_train_of_that_phase() -> None:
    np.testing.assert_allclose(shift_phase(train(10.0), 50.0), train(60.0), atol=1e-4)
    np.testing.assert_allclose(shift_phase(train(10.0), 360.0), train(10.0), atol=1e-12)


@pytest.mark.parametrize("shift", [0.0, 30.0, 90.0, 170.0, -110.0])
def test_trains_that_differ_by_their_phase_only_are_the_same(shift: float) -> None:
    found = compare_waves(S, train(20.0 + shift), S, train(20.0))
    assert found.correlation == pytest.approx(1.0, abs=CLOSE)
    assert found.envelope_difference < 1e-4
    assert found.wavelength_difference < 2e-3
    assert found.shift_deg == pytest.approx(shift, abs=0.01)


def test_a_higher_train_differs_by_its_envelope_alone() -> None:
    found = compare_waves(S, train(0.0), S, train(70.0, height=1.25))
    assert found.envelope_difference == pytest.approx(0.25, abs=1e-3)
    assert found.correlation == pytest.approx(1.0, abs=CLOSE)


def test_a_longer_wave_and_a_train_elsewhere_do_not_correlate() -> None:
    """<a1, a2> of two bells: exp(-(dk WIDTH)^2 / 8) for wavenumbers dk apart, exp(-d^2 / (2 WIDTH^2)) for centres d."""
    longer = compare_waves(S, train(0.0), S, train(0.0, wave=12.0))
    difference = 2.0 * np.pi * (1.0 / 10.0 - 1.0 / 12.0)
    assert longer.correlation == pytest.approx(np.exp(-((difference * WIDTH) ** 2) / 8.0), rel=1e-3)
    assert longer.wavelength_difference == pytest.approx(0.2, abs=5e-3)
    aside = compare_waves(S, train(0.0), S, train(0.0, centre=15.0))
    assert aside.correlation == pytest.approx(np.exp(-(15.0**2) / (2.0 * WIDTH**2)), rel=1e-3)
    assert aside.envelope_difference > 0.5


def test_noise_lowers_the_correlation_by_its_power() -> None:
    """|a|^2 gains the noise's power: 1 / sqrt(1 + noise / train), with 2 % noise on the whole line."""
    share = 0.05
    clean = train(0.0)
    found = compare_waves(S, clean, S, noisy(train(90.0), share))
    expected = 1.0 / np.sqrt(1.0 + share**2 * len(S) / np.sum(train(90.0) ** 2))
    assert found.correlation == pytest.approx(expected, abs=5e-3)


def test_profiles_of_other_samples_are_compared_too_and_other_lines_refused() -> None:
    coarse = np.linspace(-50.0, 50.0, 401)
    z = np.interp(coarse, S, train(45.0))
    # linear interpolation of 40 samples a wave: (pi / 40)^2 / 2 of the height
    for found in (compare_waves(S, train(0.0), coarse, z), compare_waves(coarse, z, S, train(0.0))):
        assert found.correlation == pytest.approx(1.0, abs=1e-4)
    with pytest.raises(ValueError, match="the profiles run from"):
        compare_waves(S, train(0.0), 2.0 * S, train(0.0))
    with pytest.raises(ValueError, match="is zero"):
        compare_waves(S, 0.0 * S, S, train(0.0))
    assert compare_waves(S, train(0.0), S, 0.0 * S).correlation == 0.0
