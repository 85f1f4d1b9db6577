"""Bogner-Fox-Schmit bicubic fields on tensor-product meshes, C1 throughout (Bogner, Fox and Schmit 1965).

A field f(x, y) carries four values at each node: f, f,y, f,x and f,xy, the derivatives times the nodal lengths of the
mesh so that all four have the unit of f. Inside an element f is a tensor product of cubic Hermite polynomials.

The mesh coordinates are Cartesian, or polar with x the angle (closed) and y the radius. Field components are Cartesian
in both cases.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

KINDS = 4  # f, f,y, f,x, f,xy
# Per direction: exact to degree 7, while the largest products of the bending energy of a flat sheet have degree 6.
GAUSS_POINTS = 4


@dataclass(frozen=True)
class Mesh:
    """A tensor-product mesh.

    x : (ni,) float64, rising, mm; if `polar` the angle in rad of a whole ring, its first line not repeated.
    y : (nj,) float64, rising, mm; if `polar` the radius.
    """

    x: np.ndarray
    y: np.ndarray
    polar: bool = False

    def __post_init__(self) -> None:
        for name, axis in (("x", self.x), ("y", self.y)):
            if len(axis) < 2 or not (np.isfinite(axis).all() and (np.diff(axis) > 0.0).all()):
                raise ValueError(f"{name} must be at least two finite, rising numbers")

    @property
    def shape(self) -> tuple[int, int]:
        """Nodes along x and along y."""
        return len(self.x), len(self.y)

    @property
    def unknowns(self) -> int:
        """Nodal values of a field of three components, supported ones included."""
        return 3 * KINDS * len(self.x) * len(self.y)

    @cached_property
    def breaks(self) -> tuple[np.ndarray, np.ndarray]:
        """Ends of the elements along x and along y; a closed x ends one turn after its start."""
        return (np.append(self.x, self.x[0] + 2.0 * np.pi) if self.polar else self.x), self.y

    @cached_property
    def lengths(self) -> tuple[np.ndarray, np.ndarray]:
        """Nodal lengths along x (ni,) and y (nj,): means of the adjacent elements, the scales of derivatives."""
        along_x = _nodal_mean(np.diff(self.breaks[0]), self.polar)
        return along_x[: len(self.x)], _nodal_mean(np.diff(self.y), False)

    @cached_property
    def axis_tables(self) -> tuple[AxisTable, AxisTable]:
        """Hermite functions at the Gauss points along x and along y."""
        return tuple(  # type: ignore[return-value]
            _axis_table(breaks, lengths) for breaks, lengths in zip(self.breaks, self.lengths, strict=True)
        )


@dataclass(frozen=True)
class AxisTable:
    """Hermite functions of one axis at the Gauss points of its elements.

    values : (elements, points, 3, 4) float64. Derivatives of order 0, 1, 2 of the four functions: value and slope at
        the lower end, value and slope at the upper end. weight, place : (elements, points), mm (rad).
    """

    values: np.ndarray
    weight: np.ndarray
    place: np.ndarray


def _nodal_mean(elements: np.ndarray, closed: bool) -> np.ndarray:
    before, after = np.append(elements[0], elements), np.append(elements, elements[-1])
    if closed:
        before[0], after[-1] = elements[-1], elements[0]
    return 0.5 * (before + after)


def hermite(t: np.ndarray, length: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Derivatives of order 0, 1, 2 of the cubic Hermite functions of an element, (..., 3, 4).

    t : (...) in [0, 1], place in the element. length : of the element. lower, upper : nodal lengths at its ends, the
    scales of the slopes.
    """
    t, length, a, b = np.broadcast_arrays(t, length, length / lower, length / upper)
    rows = (
        (1 - t * t * (3 - 2 * t), a * t * (1 - t) ** 2, t * t * (3 - 2 * t), b * t * t * (t - 1)),
        (-6 * t * (1 - t), a * (1 - t) * (1 - 3 * t), 6 * t * (1 - t), b * t * (3 * t - 2)),
        (12 * t - 6, a * (6 * t - 4), 6 - 12 * t, b * (6 * t - 2)),
    )
    by_order = [np.stack(row, axis=-1) / length[..., None] ** order for order, row in enumerate(rows)]
    return np.stack(by_order, axis=-2)


def _axis_table(breaks: np.ndarray, lengths: np.ndarray) -> AxisTable:
    points, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    t, length = 0.5 * (1.0 + points), np.diff(breaks)[:, None]
    lower = lengths[: len(length), None]
    upper = np.take(lengths, np.arange(1, len(length) + 1), mode="wrap")[:, None]
    values = hermite(t[None, :], length, lower, upper)
    return AxisTable(values, 0.5 * length * weights, breaks[:-1, None] + length * t)


def from_function(mesh: Mesh, function: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Nodal values (ni, nj, 4, k) of a field.

    function : (x, y) arrays (ni, nj) -> (4, ni, nj, k): f, f,y, f,x, f,xy with respect to the mesh coordinates.
    """
    x, y = np.meshgrid(mesh.x, mesh.y, indexing="ij")
    values = np.moveaxis(np.asarray(function(x, y), dtype=float), 0, 2)
    return np.ascontiguousarray(values * derivative_scales(mesh)[..., None])


def flat(mesh: Mesh) -> np.ndarray:
    """Nodal values (ni, nj, 4, 3) of the undeformed sheet, mm (of a polar mesh: its Hermite interpolant)."""

    def cartesian(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        one, zero = np.ones_like(x), np.zeros_like(x)
        return np.array([[x, y, zero], [zero, one, zero], [one, zero, zero], [zero] * 3]).transpose(
            0, 2, 3, 1
        )

    def polar(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        c, s, zero = np.cos(x), np.sin(x), np.zeros_like(x)
        rows = [[y * c, y * s, zero], [c, s, zero], [-y * s, y * c, zero], [-s, c, zero]]
        return np.array(rows).transpose(0, 2, 3, 1)

    return from_function(mesh, polar if mesh.polar else cartesian)


def evaluate(
    mesh: Mesh, values: np.ndarray, x: np.ndarray, y: np.ndarray, order_x: int = 0, order_y: int = 0
) -> np.ndarray:
    """The field, or a derivative of it, at scattered places (m,) of the mesh coordinates; (m, k).

    values : (ni, nj, 4, k). order_x, order_y : 0 to 2. Raises ValueError for a place outside the mesh.
    """
    i, along_x = _located(mesh.breaks[0], mesh.lengths[0], np.asarray(x, dtype=float), order_x)
    j, along_y = _located(mesh.breaks[1], mesh.lengths[1], np.asarray(y, dtype=float), order_y)
    result = np.zeros((len(i), values.shape[3]))
    for a in range(2):
        for b in range(2):
            corner = values[(i + a) % mesh.shape[0], j + b]
            weight = along_x[:, 2 * a : 2 * a + 2, None] * along_y[:, None, 2 * b : 2 * b + 2]
            result += np.einsum("md,mdk->mk", weight.reshape(-1, KINDS), corner)
    return result


def transfer(mesh: Mesh, values: np.ndarray, other: Mesh) -> np.ndarray:
    """Nodal values of the field on another mesh of the same sheet: exact if that mesh refines this one."""

    def sampled(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        parts = [
            evaluate(mesh, values, x.ravel(), y.ravel(), order_x, order_y).reshape(*x.shape, -1)
            for order_x, order_y in ((0, 0), (0, 1), (1, 0), (1, 1))
        ]
        return np.stack(parts)

    return from_function(other, sampled)


def _located(
    breaks: np.ndarray, lengths: np.ndarray, place: np.ndarray, order: int
) -> tuple[np.ndarray, np.ndarray]:
    """Element (m,) of each place and its four functions there (m, 4)."""
    slack = 1e-9 * (breaks[-1] - breaks[0])
    if place.size and not (breaks[0] - slack <= place.min() and place.max() <= breaks[-1] + slack):
        raise ValueError(f"a place lies outside the mesh, from {breaks[0]:g} to {breaks[-1]:g}")
    element = np.clip(np.searchsorted(breaks, place, side="right") - 1, 0, len(breaks) - 2)
    length = breaks[element + 1] - breaks[element]
    upper = np.take(lengths, element + 1, mode="wrap")
    functions = hermite((place - breaks[element]) / length, length, lengths[element], upper)
    return element, functions[:, order]


def derivative_scales(mesh: Mesh) -> np.ndarray:
    """(ni, nj, 4): what turns f, f,y, f,x, f,xy into nodal values."""
    x, y = mesh.lengths[0][:, None], mesh.lengths[1][None, :]
    return np.stack(np.broadcast_arrays(np.ones_like(x * y), y, x, x * y), axis=-1)
