"""Chebyshev-Lobatto elements on an interval: derivative, interpolation and integral of nodal values."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

Array = NDArray[np.float64]


@lru_cache(maxsize=8)
def _reference(degree: int) -> tuple[Array, Array, Array]:
    """Return nodes (n,) on [-1, 1], derivative matrix (n, n) and values-to-coefficients matrix (n, n)."""
    nodes = -np.cos(np.pi * np.arange(degree + 1) / degree)
    weight = (-1.0) ** np.arange(degree + 1)
    weight[[0, -1]] *= 0.5
    # differences of the nodes by sines: subtracting nodes near +-1 would lose half of the digits
    angle = 0.5 * np.pi * np.arange(degree + 1) / degree
    gap = 2.0 * np.sin(angle[:, None] + angle) * np.sin(angle[:, None] - angle)
    np.fill_diagonal(gap, 1.0)
    slope = weight / weight[:, None] / gap
    np.fill_diagonal(slope, 0.0)
    np.fill_diagonal(slope, -slope.sum(axis=1))
    coefficients = np.asarray(np.linalg.inv(chebyshev.chebvander(nodes, degree)), dtype=np.float64)
    return nodes, slope, coefficients


@dataclass(frozen=True)
class Elements:
    """Elements between consecutive `breaks` (e + 1,), each with n = degree + 1 nodes in ascending order."""

    breaks: Array
    degree: int

    @cached_property
    def radius(self) -> Array:
        """Radii of the nodes, (e, n)."""
        nodes = _reference(self.degree)[0]
        low, high = self.breaks[:-1, None], self.breaks[1:, None]
        radius = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        radius[:, 0], radius[:, -1] = self.breaks[:-1], self.breaks[1:]
        return radius

    def matrix(self, element: int) -> Array:
        """Return the derivative matrix (n, n) of one element."""
        return _reference(self.degree)[1] * (2.0 / (self.breaks[element + 1] - self.breaks[element]))

    def derivative(self, values: Array) -> Array:
        """Return the derivatives (e, n, ...) of nodal `values` (e, n, ...)."""
        scale = (2.0 / np.diff(self.breaks)).reshape(-1, *[1] * (values.ndim - 1))
        return scale * np.einsum("mn,en...->em...", _reference(self.degree)[1], values)

    def coefficients(self, values: Array) -> Array:
        """Return the Chebyshev coefficients (e, n, ...) of nodal `values` (e, n, ...)."""
        return np.einsum("kn,en...->ek...", _reference(self.degree)[2], values)

    def integral(self, values: Array) -> float:
        """Return the integral over all elements of nodal `values` (e, n)."""
        even = np.arange(0, self.degree + 1, 2)
        weight = 1.0 / (1.0 - even.astype(float) ** 2)
        return float(np.diff(self.breaks) @ (self.coefficients(values)[:, even] @ weight))

    def at(self, values: Array, radii: Array) -> Array:
        """Return nodal `values` (e, n, k) at `radii` (m,), as (m, k); a break belongs to its inner side."""
        element = np.clip(np.searchsorted(self.breaks, radii) - 1, 0, self.breaks.size - 2)
        low, high = self.breaks[element], self.breaks[element + 1]
        basis = chebyshev.chebvander((2.0 * radii - low - high) / (high - low), self.degree)
        return np.einsum("mk,mkc->mc", basis, self.coefficients(values)[element])

    def split(self, values: Array) -> Array:
        """Return values (m, k) at the distinct nodes as element values (e, n, k)."""
        return values[np.arange(self.breaks.size - 1)[:, None] * self.degree + np.arange(self.degree + 1)]

    def join(self, values: Array) -> Array:
        """Return element values (e, n, k), continuous at the breaks, at the distinct nodes (m, k)."""
        return np.concatenate([values[:, :-1].reshape(-1, values.shape[-1]), values[-1, -1:]])
