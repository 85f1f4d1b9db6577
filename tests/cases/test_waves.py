"""Measures of profiles whose amplitude, wavelength, count and symmetry are known, clean and noisy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from cases.halfwaves import half_waves, noise, smallest_wavelength_ratio, turning_points
from cases.waves import count_half_waves, measure, zero_crossings

S = np.linspace(0.0, 100.0, 2001)
# Positions of zeros come from linear interpolation between samples: far below 1e-3 of a wave of 100 samples.
CLOSE = 1e-3


def bell(width: float, centre: float = 50.0) -> np.ndarray:
    return np.exp(-(((S - centre) / width) ** 2))


def test_a_sine_has_its_amplitude_rms_wavelength_and_count() -> None:
    found = measure(S, 0.7 * np.sin(2.0 * np.pi * S / 10.0))
    assert found.amplitude_mm == pytest.approx(0.7, rel=1e-6)
    assert found.rms_mm == pytest.approx(0.7 / np.sqrt(2.0), rel=1e-6)
    assert found.wavelength_mm == pytest.approx(10.0, rel=CLOSE)
    assert found.half_waves == 20
    assert found.symmetry == pytest.approx(-1.0, abs=1e-9)


def test_the_rms_does_not_depend_on_where_the_samples_are() -> None:
    s = 100.0 * np.linspace(0.0, 1.0, 2001) ** 2
    assert measure(s, np.sin(2.0 * np.pi * s / 10.0)).rms_mm == pytest.approx(np.sqrt(0.5), rel=1e-3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_half_wave_between_supports(sign: float) -> None:
    found = measure(S, sign * np.sin(np.pi * S / 100.0))
    assert found.half_waves == 1
    assert found.wavelength_mm == pytest.approx(200.0, rel=CLOSE)
    assert found.symmetry == pytest.approx(1.0, abs=1e-9)


def test_two_half_waves_between_supports() -> None:
    found = measure(S, np.sin(2.0 * np.pi * S / 100.0))
    assert found.half_waves == 2
    assert found.wavelength_mm == pytest.approx(100.0, rel=CLOSE)


def test_a_short_train_of_wrinkles_in_a_long_section() -> None:
    """The envelope hardly shifts the zeros: the wavelength is that of the carrier where the envelope is
    largest.
    """
    found = measure(S, bell(12.0) * np.cos(2.0 * np.pi * (S - 50.0) / 8.0))
    assert found.amplitude_mm == pytest.approx(1.0, rel=1e-6)
    assert found.wavelength_mm == pytest.approx(8.0, rel=CLOSE)
    assert found.symmetry == pytest.approx(1.0, abs=1e-9)
    # Extrema k half-waves from the middle have the height exp(-(4 k / 12)^2): above 5 % up to k = 5.
    assert found.half_waves == 11


def test_where_the_envelope_is_largest_decides_the_wavelength() -> None:
    z = bell(8.0, 25.0) * np.sin(2.0 * np.pi * S / 4.0) + 0.6 * bell(10.0, 75.0) * np.sin(
        2.0 * np.pi * S / 9.0
    )
    assert measure(S, z).wavelength_mm == pytest.approx(4.0, rel=5 * CLOSE)


def test_the_local_wavelength_of_a_chirp() -> None:
    """Phase 2 pi (s / 10 + s^2 / 2000): wavelength 1 / (1/10 + s / 1000), read where a bell is highest."""
    for centre in (30.0, 60.0):
        z = bell(25.0, centre) * np.cos(2.0 * np.pi * (S / 10.0 + S**2 / 2000.0))
        waves = half_waves(S, z)
        middle = 0.5 * (waves.start_mm + waves.end_mm)[np.argmax(waves.envelope_mm)]
        # The curvature of the wavelength along s, over one wave, is the error of its second-order estimate.
        assert measure(S, z).wavelength_mm == pytest.approx(1.0 / (0.1 + middle / 1000.0), rel=5e-3)
        assert middle == pytest.approx(centre, abs=5.0)


@pytest.mark.parametrize("share", [0.002, 0.01, 0.03])
def test_noise_changes_neither_count_nor_wavelength(share: float) -> None:
    clean = (0.5 + 0.5 * bell(40.0)) * np.cos(2.0 * np.pi * (S - 50.0) / 8.0)
    for seed in range(10):
        found = measure(S, clean + np.random.default_rng(seed).normal(0.0, share, S.shape))
        assert found.half_waves == 25
        # Noise shifts a zero by noise over slope: share / (2 pi / 8) mm, four of them in a mean, three
        # deviations.
        assert found.wavelength_mm == pytest.approx(8.0, abs=3.0 * 2.0 * share * 8.0 / (2.0 * np.pi))
        # Four deviations of noise on top of the crest.
        assert found.amplitude_mm == pytest.approx(1.0, abs=4.0 * share)
        assert found.symmetry == pytest.approx(1.0, abs=6.0 * share**2 + 0.01)


def test_the_noise_is_measured() -> None:
    z = np.sin(2.0 * np.pi * S / 10.0)
    # Fourth differences of 200 samples to a wave: (2 pi / 200)^4 / sqrt(70), about 1e-7.
    assert noise(z) < 2e-7
    noisy = z + np.random.default_rng(5).normal(0.0, 0.01, S.shape)
    # The median of 2000 correlated differences is good to a few percent.
    assert noise(noisy) == pytest.approx(0.01, rel=0.1)


def test_wrinkles_on_a_bow_keep_their_wavelength() -> None:
    z = np.sin(np.pi * S / 100.0) + 0.2 * bell(25.0) * np.cos(2.0 * np.pi * (S - 50.0) / 6.0)
    # The slope of bow and envelope across a wave, a few percent of the ripple, shifts its levels.
    assert measure(S, z).wavelength_mm == pytest.approx(6.0, rel=0.03)


def test_two_crests_on_one_side_of_zero_are_no_half_waves_more() -> None:
    """Half-waves are counted by changes of sign."""
    z = 1.0 + 0.5 * np.cos(2.0 * np.pi * S / 20.0)
    assert count_half_waves(z) == 1


def test_tails_below_five_percent_do_not_count() -> None:
    z = np.where(S < 50.0, np.sin(2.0 * np.pi * S / 10.0), 0.04 * np.sin(2.0 * np.pi * S / 2.0))
    # 10 half-waves, and none of the 50 small ones.
    assert count_half_waves(z) == 10
    z = np.where(S < 50.0, np.sin(2.0 * np.pi * S / 10.0), 0.06 * np.sin(2.0 * np.pi * S / 2.0))
    assert count_half_waves(z) == 60


@pytest.mark.parametrize("phase", [0.0, 0.3, 1.7, 3.1])
@pytest.mark.parametrize("count", [1, 2, 7])
def test_a_ring_is_cut_once_round_wherever_it_starts(count: int, phase: float) -> None:
    z = np.cos(2.0 * np.pi * count * S / 100.0 + phase)
    waves = half_waves(S, z, closed=True)
    assert len(waves.start_mm) == 2 * count
    assert waves.wavelength_mm == pytest.approx(100.0 / count, rel=CLOSE)
    assert np.sum(waves.end_mm - waves.start_mm) == pytest.approx(100.0, rel=1e-9)
    found = measure(S, z, closed=True)
    assert found.half_waves == 2 * count
    assert found.symmetry is None


def test_a_ring_with_waves_of_two_lengths() -> None:
    """Half the ring has waves of 10, half of 5 mm, joined at zeros of equal slope sign."""
    short = (1.5 + 0.1 * bell(10.0, 75.0)) * np.sin(2.0 * np.pi * S / 5.0)
    z = np.where(S < 50.0, np.sin(2.0 * np.pi * S / 10.0), short)
    found = measure(S, z, closed=True)
    assert found.half_waves == 10 + 20
    assert found.wavelength_mm == pytest.approx(5.0, rel=CLOSE)


def test_the_smallest_wavelength_is_held_against_the_spacing_there() -> None:
    z = np.where(S < 50.0, np.sin(2.0 * np.pi * S / 10.0), 0.4 * np.sin(2.0 * np.pi * S / 5.0))
    waves = half_waves(S, z)
    assert smallest_wavelength_ratio(waves, S, np.ones_like(S)) == pytest.approx(5.0, rel=CLOSE)
    # A mesh four times finer where the waves are short: now the long ones are the worst.
    spacing = np.where(S < 50.0, 1.0, 0.25)
    assert smallest_wavelength_ratio(waves, S, spacing) == pytest.approx(10.0, rel=CLOSE)


def test_flat_profiles_have_no_wavelength() -> None:
    for z in (np.zeros_like(S), 1e-4 * np.sin(S)):
        found = measure(S, z, floor_mm=1e-3)
        assert (found.wavelength_mm, found.half_waves, found.symmetry) == (None, 0, None)
        assert found.amplitude_mm == np.abs(z).max()


def test_a_tilt_is_antisymmetric_and_no_wave() -> None:
    found = measure(S, S - 50.0)
    assert found.wavelength_mm is None
    assert found.half_waves == 2
    assert found.symmetry == pytest.approx(-1.0, abs=1e-9)


def test_a_wave_at_a_free_edge_does_not_spoil_its_neighbours() -> None:
    """Highest at the edge, where no zero closes it: the wavelength is that of the next whole half-wave."""
    z = np.exp(-S / 40.0) * np.cos(2.0 * np.pi * S / 10.0)
    assert measure(S, z).wavelength_mm == pytest.approx(10.0, rel=CLOSE)


def test_turning_points_need_their_depth() -> None:
    z = np.array([0.0, 1.0, 0.95, 1.05, 0.0, 0.04, -1.0, 0.0])
    assert turning_points(z, 0.2) == [0, 3, 6, 7]
    assert turning_points(z, 0.01) == [0, 1, 2, 3, 4, 5, 6, 7]
    assert turning_points(np.zeros(5), 0.1) == []
    assert turning_points(np.array([0.0, 1.0, 0.7, 1.2, 0.0]), 0.2) == [0, 1, 2, 3, 4]
    assert turning_points(np.array([0.0, -1.0, -0.7, -1.2, 0.0]), 0.2) == [0, 1, 2, 3, 4]


@settings(max_examples=100, deadline=None)
@example([0.0, 77.0, -1.5e-7, 77.0, 0.0], True)
@example(
    [-2, 2, 1, -2, 2, 1, -1, 0, 1, 1, -1, 0, 2, 0, -2, 1, 1, 1, 1, 2, -2, -1, 0, 0, 0, 0, 0, -1, -2], True
)
@given(
    st.lists(st.floats(-1e3, 1e3, allow_subnormal=False), min_size=5, max_size=60),
    st.booleans(),
)
def test_any_profile_is_measured(values: list[float], closed: bool) -> None:
    """Whatever the profile: finite numbers in their ranges, half-waves in order and inside."""
    z = np.array(values, dtype=float)
    if closed:
        z[-1] = z[0]
    s = np.linspace(0.0, 10.0, len(z))
    found = measure(s, z, closed)
    assert 0.0 <= found.rms_mm <= found.amplitude_mm * (1.0 + 1e-12)
    assert found.symmetry is None or -1.0 <= found.symmetry <= 1.0
    waves = half_waves(s, z, closed)
    assert (waves.end_mm >= waves.start_mm).all()
    assert (np.diff(waves.start_mm) >= 0.0).all()
    assert not closed or len(waves.start_mm) % 2 == 0
    assert (waves.end_mm - waves.start_mm).sum() <= 10.0 * (1.0 + 1e-9)
    assert found.wavelength_mm is None or 0.0 <= found.wavelength_mm <= 40.0


@pytest.mark.parametrize("share", [0.0, 0.02])
def test_zero_crossings_are_where_they_are(share: float) -> None:
    """sin(2 pi s / 10) from 0 to 100 crosses at 5, 10, ..., 95; the ends are no crossings, nor is noise."""
    z = np.sin(2.0 * np.pi * S / 10.0) + share * np.random.default_rng(2).standard_normal(S.shape)
    places = zero_crossings(S, z)
    # noise has no sign within five deviations of zero: 0.1 / slope 0.63 on either side
    np.testing.assert_allclose(places, np.arange(5.0, 96.0, 5.0), rtol=0.0, atol=CLOSE + 5.0 * share)
    assert len(places) + 1 == count_half_waves(z)


def test_zero_crossings_of_a_closed_profile_and_of_one_that_has_none() -> None:
    assert len(zero_crossings(S, np.cos(2.0 * np.pi * S / 10.0), closed=True)) == 20
    # a crossing at the seam belongs to the round too
    assert len(zero_crossings(S, np.sin(2.0 * np.pi * S / 10.0), closed=True)) == 20
    assert len(zero_crossings(S, 1.0 + 0.1 * np.sin(S))) == 0
