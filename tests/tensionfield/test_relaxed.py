"""The relaxed law: states, stress, energy and tangent against their definition and against each other."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from fdsolver.membrane import StVenantKirchhoff, stress
from tensionfield.relaxed import Relaxed
from tensionfield.tangent import relaxed_stress, relaxed_tangent

POISSON = (-0.5, 0.0, 0.31, 0.5)


@numba.njit
def kernel_law(law, e11, e22, e12):  # type: ignore[no-untyped-def]
    """The compiled law, callable from here."""
    return stress(law, e11, e22, e12)


def matrix(e11: float, e22: float, e12: float) -> np.ndarray:
    return np.array([[e11, e12], [e12, e22]])


def random_strains(count: int = 400) -> np.ndarray:
    e = np.random.default_rng(1).uniform(-0.4, 0.6, (count, 2, 2))
    return 0.5 * (e + np.swapaxes(e, 1, 2))


def definition(strain: np.ndarray, nu: float) -> float:
    """Energy / Y by the cases of Pipkin 1986."""
    minor, major = np.linalg.eigvalsh(strain)
    c, two_mu = nu / (1.0 - nu**2), 1.0 / (1.0 + nu)
    if major <= 0.0:
        return 0.0
    if minor <= -nu * major:
        return 0.5 * major**2
    return 0.5 * (c * (major + minor) ** 2 + two_mu * (major**2 + minor**2))


@pytest.mark.parametrize("nu", POISSON)
def test_energy_is_that_of_its_definition(nu: float) -> None:
    for strain in random_strains():
        *_, density = kernel_law(Relaxed(nu), strain[0, 0], strain[1, 1], strain[0, 1])
        assert density == pytest.approx(definition(strain, nu), rel=1e-12, abs=1e-15)  # rounding


@pytest.mark.parametrize("nu", POISSON)
def test_relaxation_never_raises_the_energy_and_keeps_tense_states(nu: float) -> None:
    for strain in random_strains():
        arguments = (strain[0, 0], strain[1, 1], strain[0, 1])
        relaxed, unrelaxed = (
            kernel_law(Relaxed(nu), *arguments),
            kernel_law(StVenantKirchhoff(nu), *arguments),
        )
        assert relaxed[3] <= unrelaxed[3] + 1e-15
        minor, major = np.linalg.eigvalsh(strain)
        if major > 0.0 and minor > -nu * major:
            np.testing.assert_allclose(relaxed, unrelaxed, rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("nu", POISSON)
def test_stress_is_the_derivative_of_the_energy(nu: float) -> None:
    step = 1e-5  # W is C1 with kinks in its second derivative: central differences err by at most `step`
    for strain in random_strains():
        s11, s22, s12, _ = kernel_law(Relaxed(nu), strain[0, 0], strain[1, 1], strain[0, 1])
        for direction, value in (
            (matrix(1, 0, 0), s11),
            (matrix(0, 1, 0), s22),
            (matrix(0, 0, 1), 2.0 * s12),
        ):
            slope = (
                definition(strain + step * direction, nu) - definition(strain - step * direction, nu)
            ) / (2 * step)
            assert value == pytest.approx(slope, abs=2.0 * step / (1.0 - nu**2))


@pytest.mark.parametrize("nu", POISSON)
def test_kernel_and_array_law_agree(nu: float) -> None:
    strains = random_strains()
    expected = relaxed_stress(strains, nu)
    for strain, stress_matrix in zip(strains, expected, strict=True):
        s11, s22, s12, _ = kernel_law(Relaxed(nu), strain[0, 0], strain[1, 1], strain[0, 1])
        np.testing.assert_allclose(matrix(s11, s22, s12), stress_matrix, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    "strain", [matrix(0, 0, 0), matrix(0.2, 0.2, 0), matrix(-0.1, -0.1, 0), matrix(0.3, -0.3, 0)]
)
def test_isotropic_and_switching_strains_give_finite_stress(strain: np.ndarray) -> None:
    values = kernel_law(Relaxed(0.31), strain[0, 0], strain[1, 1], strain[0, 1])
    assert np.isfinite(values).all()
    np.testing.assert_allclose(matrix(*values[:3]), relaxed_stress(strain, 0.31), rtol=0, atol=1e-14)


def far_from_a_switch(strain: np.ndarray, nu: float, margin: float = 1e-3) -> bool:
    minor, major = np.linalg.eigvalsh(strain)
    return bool(min(abs(major), abs(minor + nu * major), major - minor) > margin)


@pytest.mark.parametrize("nu", POISSON)
def test_tangent_is_the_derivative_of_the_stress(nu: float) -> None:
    step, seen = 1e-6, 0
    for strain in random_strains():
        if not far_from_a_switch(strain, nu):
            continue
        seen += 1
        tangent = relaxed_tangent(strain, nu)
        for direction in (matrix(1, 0, 0), matrix(0, 1, 0), matrix(0, 0, 1)):
            difference = (
                relaxed_stress(strain + step * direction, nu) - relaxed_stress(strain - step * direction, nu)
            ) / (2 * step)
            # second order in the step; the third derivative grows with the inverse square of the gap E1 - E2
            np.testing.assert_allclose(
                np.einsum("abcd,cd", tangent, direction), difference, rtol=0, atol=1e-5
            )
    assert seen > 300


@pytest.mark.parametrize("nu", POISSON)
def test_tangent_is_symmetric_and_not_negative(nu: float) -> None:
    tangents = relaxed_tangent(random_strains(), nu)
    np.testing.assert_allclose(tangents, np.einsum("...abcd->...cdab", tangents), rtol=0, atol=1e-15)
    np.testing.assert_allclose(tangents, np.einsum("...abcd->...bacd", tangents), rtol=0, atol=1e-15)
    assert np.linalg.eigvalsh(tangents.reshape(-1, 4, 4)).min() > -1e-12  # the energy is convex


def test_tangent_of_an_isotropic_tense_state_is_plane_stress() -> None:
    nu = 0.31
    tangent = relaxed_tangent(matrix(0.1, 0.1, 0.0), nu)
    assert tangent[0, 0, 0, 0] == pytest.approx(1.0 / (1.0 - nu**2), rel=1e-12)
    assert tangent[0, 0, 1, 1] == pytest.approx(nu / (1.0 - nu**2), rel=1e-12)
    assert 2.0 * tangent[0, 1, 0, 1] == pytest.approx(1.0 / (1.0 + nu), rel=1e-12)
