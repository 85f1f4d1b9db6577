"""Symmetric 2 x 2 matrices in kernels: triples (11, 22, 12), most of them positive definite."""

from __future__ import annotations

import numpy as np

from fdsolver.rows import compiled

NEARLY_SINGULAR = 1e-18  # least determinant over the square of the trace: below, it is rounding


@compiled
def determinant(a):
    """The determinant of a positive definite matrix, kept positive where rounding hides it."""
    trace = a[0] + a[1]
    return max(a[0] * a[1] - a[2] * a[2], NEARLY_SINGULAR * trace * trace)


@compiled
def inverse(a):
    """The inverse of a positive definite matrix."""
    d = determinant(a)
    return a[1] / d, a[0] / d, -a[2] / d


@compiled
def mean(a, b):
    """The geometric mean of two positive definite matrices: the one w with w a^-1 w = b."""
    p, q = np.sqrt(determinant(a)), np.sqrt(determinant(b))
    m = a[0] / p + b[0] / q, a[1] / p + b[1] / q, a[2] / p + b[2] / q
    k = np.sqrt(p * q / determinant(m))
    return k * m[0], k * m[1], k * m[2]


@compiled
def root(a):
    """The positive definite square root."""
    d = np.sqrt(determinant(a))
    t = np.sqrt(a[0] + a[1] + 2.0 * d)
    return (a[0] + d) / t, (a[1] + d) / t, a[2] / t


@compiled
def between(w, x):
    """The product w x w."""
    p11, p12 = w[0] * x[0] + w[2] * x[2], w[0] * x[2] + w[2] * x[1]
    p21, p22 = w[2] * x[0] + w[1] * x[2], w[2] * x[2] + w[1] * x[1]
    return p11 * w[0] + p12 * w[2], p21 * w[2] + p22 * w[1], p11 * w[2] + p12 * w[1]


@compiled
def symmetric_product(x, y):
    """(x y + y x) / 2."""
    return (
        x[0] * y[0] + x[2] * y[2],
        x[1] * y[1] + x[2] * y[2],
        0.5 * ((x[0] + x[1]) * y[2] + x[2] * (y[0] + y[1])),
    )


@compiled
def principal(a):
    """Larger and smaller eigenvalue, and cosine and sine of the direction of the larger; a positive definite."""
    half = 0.5 * (a[0] - a[1])
    angle = 0.5 * np.arctan2(a[2], half)
    larger = 0.5 * (a[0] + a[1]) + np.sqrt(half * half + a[2] * a[2])
    return larger, determinant(a) / larger, np.cos(angle), np.sin(angle)


@compiled
def along(x1, x2, x12, co, si):
    """The matrix with components x1, x2, x12 along directions turned by an angle with this cosine and sine."""
    return (
        co * co * x1 + si * si * x2 - 2.0 * co * si * x12,
        si * si * x1 + co * co * x2 + 2.0 * co * si * x12,
        co * si * (x1 - x2) + (co * co - si * si) * x12,
    )


@compiled
def divided(p, v):
    """The z with (v z + z v) / 2 = p; v positive definite."""
    larger, smaller, co, si = principal(v)
    z = along(p[0], p[1], p[2], co, -si)
    z = z[0] / larger, z[1] / smaller, 2.0 * z[2] / (larger + smaller)
    return along(z[0], z[1], z[2], co, si)


@compiled
def longest(a, change):
    """Largest share of a change that leaves a positive semidefinite; infinite where none is too much."""
    d = determinant(a)
    trace = (a[1] * change[0] + a[0] * change[1] - 2.0 * a[2] * change[2]) / d
    product = (change[0] * change[1] - change[2] * change[2]) / d
    least = 0.5 * trace - np.sqrt(max(0.25 * trace * trace - product, 0.0))
    return -1.0 / least if least < 0.0 else np.inf
