"""The Koiter energy written out once more, plainly and in complex arithmetic, and smooth sheets to test it on."""

from __future__ import annotations

import numpy as np

YOUNG, POISSON, THICKNESS = 2.0, 0.3, 0.4


def plain_density(d: np.ndarray, young: float, poisson: float, thickness: float) -> np.ndarray:
    """Membrane and bending energy per area of the derivatives d (..., 5, 3): r,1 r,2 r,11 r,12 r,22; also complex."""
    c = young * poisson / (1.0 - poisson**2)
    two_mu = young / (1.0 + poisson)
    tangents, second = d[..., :2, :], d[..., 2:, :]
    strain = 0.5 * (np.einsum("...ak,...bk->...ab", tangents, tangents) - np.eye(2))
    area = np.cross(tangents[..., 0, :], tangents[..., 1, :])
    normal = area / np.sqrt((area**2).sum(axis=-1))[..., None]
    b11, b12, b22 = np.moveaxis(np.einsum("...k,...pk->...p", normal, second), -1, 0)
    e11, e12, e22 = strain[..., 0, 0], strain[..., 0, 1], strain[..., 1, 1]

    def form(p, q, s):
        return c * (p + s) ** 2 + two_mu * (p * p + 2.0 * q * q + s * s)

    return np.stack(
        [0.5 * thickness * form(e11, e12, e22), thickness**3 / 24.0 * form(b11, b12, b22)], axis=-1
    )


def plain_gradient(d: np.ndarray, young: float, poisson: float, thickness: float) -> np.ndarray:
    """dW/dd (..., 5, 3) by the complex step, exact to rounding."""
    gradient = np.empty(d.shape)
    for p in range(5):
        for k in range(3):
            moved = d.astype(complex)
            moved[..., p, k] += 1e-30j
            gradient[..., p, k] = plain_density(moved, young, poisson, thickness).sum(axis=-1).imag / 1e-30
    return gradient


def waves(x: np.ndarray, y: np.ndarray, height: float = 1.0) -> np.ndarray:
    """r and its derivatives of a smooth, strained and bent sheet: (6, ..., 3) = r, r,1 r,2 r,11 r,12 r,22."""
    amplitude = height * np.array([0.06, -0.05, 0.15])
    a, b = np.array([2.0, 1.7, 2.3]), np.array([1.5, 2.1, 1.9])
    phase, other = np.array([0.3, 1.1, -0.4]), np.array([0.7, -0.2, 0.5])
    u, v = a * x[..., None] + phase, b * y[..., None] + other
    s, c, t, d = np.sin(u), np.cos(u), np.sin(v), np.cos(v)
    one, zero = np.ones_like(x), np.zeros_like(x)
    flat = [
        np.stack(rows, axis=-1)
        for rows in ((x, y, zero), (one, zero, zero), (zero, one, zero), *3 * [(zero, zero, zero)])
    ]
    bent = [s * t, a * c * t, b * s * d, -a * a * s * t, a * b * c * d, -b * b * s * t]
    return np.stack([plane + amplitude * wave for plane, wave in zip(flat, bent, strict=True)])
