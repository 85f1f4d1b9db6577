"""Buckling of a ring, wave by wave: polynomials in the radius for any growth of its circles; Bessel functions where the
compression is isotropic."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Legendre
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.special import jvp, yvp

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


def isotropic_factors(inner: float, outer: float, supports: tuple[str, str], poisson: float) -> np.ndarray:
    """Exact N / D, ascending, of a ring under the isotropic compression N, each double factor twice; the first eight.

    supports : "pinned" or "clamped", of the inner and of the outer circle. D div div grad grad w + N div grad w = 0 is
    solved by w = (A J_n(k R) + B Y_n(k R) + C R^n + E R^-n) cos(n angle), k^2 = N / D, with R^0, R^-0 read as 1, log R.
    """
    found = []
    for waves in range(8):
        root = _first_root(
            lambda k, n=waves: _determinant(k, n, inner, outer, supports, poisson), outer - inner
        )
        found += [root**2] * (1 if waves == 0 else 2)
    return np.sort(found)[:8]


def _first_root(function: Callable[[float], float], width: float) -> float:
    """The first change of sign of a function of k, from waves far longer than the ring is wide on."""
    k = np.arange(1.0, 12.0, 0.1) / width
    value = np.array([function(each) for each in k])
    first = int(np.flatnonzero(value[:-1] * value[1:] < 0.0)[0])
    return float(brentq(function, k[first], k[first + 1], xtol=1e-14))


def _determinant(
    k: float, n: int, inner: float, outer: float, supports: tuple[str, str], poisson: float
) -> float:
    """Vanishes where some A, B, C, E, not all zero, meet w = 0 and no slope or no moment on both circles."""
    rows = []
    for r, support in zip((inner, outer), supports, strict=True):
        w, slope, second = (
            np.array([k**d * jvp(n, k * r, d), k**d * yvp(n, k * r, d), *_harmonic(n, r, d)])
            for d in range(3)
        )
        moment = second + poisson * (slope / r - n * n * w / r**2)
        rows += [w, slope if support == "clamped" else moment]
    matrix = np.array(rows)
    return float(np.linalg.det(matrix / np.abs(matrix).max(axis=1, keepdims=True)))


def _harmonic(n: int, r: float, order: int) -> tuple[float, float]:
    """Derivatives of R^n and R^-n; of 1 and log R for n = 0."""
    if n == 0:
        return (1.0, np.log(r)) if order == 0 else (0.0, (-1.0) ** (order - 1) / r**order)
    falling = [np.prod([sign * n - j for j in range(order)]) for sign in (1, -1)]
    return float(falling[0] * r ** (n - order)), float(falling[1] * r ** (-n - order))
