"""Buckling of a ring under radial displacement of its circles, wave by wave: polynomials in the radius."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Legendre
from scipy.linalg import eigh

TERMS, POINTS = 24, 80


def ring_factors(
    inner: float, outer: float, grow: tuple[float, float], thickness: float, poisson: float, waves: int
) -> np.ndarray:
    """Positive buckling factors, ascending, of w = f(R) cos(waves angle), f = 0 at both pinned circles.

    grow : radial displacements of the inner and the outer circle at factor 1. The prestress is Lame's,
    u = A R + B / R; f is a polynomial times (R - inner)(outer - R), so that the moments vanish by themselves.
    """
    a, b = np.linalg.solve([[inner, 1 / inner], [outer, 1 / outer]], grow)
    node, weight = np.polynomial.legendre.leggauss(POINTS)
    r = 0.5 * (inner + outer) + 0.5 * (outer - inner) * node
    weight = 0.5 * (outer - inner) * weight * r
    radial, hoop = a - b / r**2, a + b / r**2
    stress_r = (radial + poisson * hoop) / (1 - poisson**2)
    stress_t = (hoop + poisson * radial) / (1 - poisson**2)
    f, df, ddf = _functions(r, inner, outer)
    bend_r, bend_t = ddf, df / r - waves**2 * f / r**2
    twist = waves * (df / r - f / r**2)
    stiffness = thickness**2 / (12 * (1 - poisson**2))

    def product(g: np.ndarray, h: np.ndarray, factor: np.ndarray | float = 1.0) -> np.ndarray:
        return (g * weight * factor) @ h.T

    total = bend_r + bend_t
    bending = stiffness * (
        product(total, total)
        - (1 - poisson) * (product(bend_r, bend_t) + product(bend_t, bend_r) - 2 * product(twist, twist))
    )
    geometric = product(df, df, stress_r) + waves**2 * product(f / r, f / r, stress_t)
    inverse = eigh(-geometric, bending, eigvals_only=True)
    return 1 / inverse[inverse > 0][::-1]


def _functions(r: np.ndarray, inner: float, outer: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(TERMS, points) values and derivatives of Legendre polynomials times (R - inner)(outer - R)."""
    values = []
    hump = Legendre.fromroots([inner, outer], domain=[inner, outer])
    for k in range(TERMS):
        function = hump * Legendre.basis(k, domain=[inner, outer])
        scale = np.abs(function(r)).max()
        values.append(
            [function.deriv(order)(r) / scale if order else function(r) / scale for order in range(3)]
        )
    f, df, ddf = np.array(values).transpose(1, 0, 2)
    return f, df, ddf
