"""The relaxed law on arrays: principal stresses and the tangent dS/dE (Pipkin 1986), for checks and linear algebra.

The kernels use the compiled law of `relaxed`; this is the same law written by states instead of by <x> = max(x, 0).
"""

from __future__ import annotations

import numpy as np

from fdsolver.fields import SLACK, TENSE, zone_state

ROUND = 1e-14  # principal strains closer than this have no direction of their own


def principal(strain: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Principal Green strains E1 >= E2 and the direction of E1.

    strain : (..., 2, 2) float64, symmetric. Returns E1 (...), E2 (...), direction (..., 2) of unit length.
    """
    values, vectors = np.linalg.eigh(strain)
    return values[..., 1], values[..., 0], vectors[..., :, 1]


def relaxed_stress(strain: np.ndarray, poisson: float) -> np.ndarray:
    """2nd Piola stress / Y of the relaxed law.

    strain : (..., 2, 2) float64, Green strain. Returns (..., 2, 2) float64.
    """
    major, minor, direction = principal(strain)
    state = zone_state(major, minor, poisson)
    modulus = 1.0 / (1.0 - poisson**2)
    along = np.where(
        state == TENSE, modulus * (major + poisson * minor), np.where(state == SLACK, 0.0, major)
    )
    across = np.where(state == TENSE, modulus * (minor + poisson * major), 0.0)
    outer = direction[..., :, None] * direction[..., None, :]
    return along[..., None, None] * outer + across[..., None, None] * (np.eye(2) - outer)


def relaxed_tangent(strain: np.ndarray, poisson: float) -> np.ndarray:
    """Tangent dS_ab / dE_cd / Y of the relaxed law.

    In the principal frame the normal part is that of plane stress where tense, of a single direction where wrinkled
    and zero where slack; the shear part is (S1 - S2) / (E1 - E2), the turning of the principal directions. At a
    switch of state, where the stress has a kink, it is the tangent of one of the two states.

    strain : (..., 2, 2) float64, Green strain. Returns (..., 2, 2, 2, 2) float64, symmetric in ab, cd and in pairs.
    """
    major, minor, m = principal(strain)
    state = zone_state(major, minor, poisson)
    tense, taut = (state == TENSE).astype(float), (state != SLACK).astype(float)
    modulus = 1.0 / (1.0 - poisson**2)
    normal = tense * modulus + (taut - tense)
    coupling, lateral = tense * modulus * poisson, tense * modulus
    along = normal * major + coupling * minor
    across = coupling * major + lateral * minor
    gap = major - minor
    turning = np.where(gap > ROUND, (along - across) / np.where(gap > ROUND, gap, 1.0), normal - coupling)
    n = np.stack([-m[..., 1], m[..., 0]], axis=-1)
    mm, nn = m[..., :, None] * m[..., None, :], n[..., :, None] * n[..., None, :]
    mn = (m[..., :, None] * n[..., None, :] + n[..., :, None] * m[..., None, :]) / np.sqrt(2.0)

    def pair(factor: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        return np.einsum("...,...ab,...cd->...abcd", factor, first, second)

    return (
        pair(normal, mm, mm)
        + pair(lateral, nn, nn)
        + pair(coupling, mm, nn)
        + pair(coupling, nn, mm)
        + pair(turning, mn, mn)
    )
