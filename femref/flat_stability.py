"""Is the flat sheet stable at a finite stretch? Its out-of-plane tangent, and where that becomes singular.

Second variation of Koiter's energy at a plane state x(X), w small: n = (-F^-T grad w, 1), so that b_ab = n . r,ab is

    b_ab = w,ab - Gamma^l_ab w,l ,    Gamma^l_ab = (F^-1)_lk x_k,ab ,

    2 E = integral of  h S_ab w,a w,b + h^3/12 (c (tr b)^2 + 2 mu b : b) ,    S the second Piola stress at x.

No stress resultant of bending enters, for it vanishes at the flat state. The plane state does not depend on the
thickness, and the tangent is h K + h^3 B: with the smallest positive factor m of B w = -m K w the sheet is unstable
exactly if its h^2 m < 1, so one plane state decides for every thickness.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from scipy.sparse import csc_array, csr_array
from skfem import BilinearForm

from femref.buckle import NoBuckling, factors_below, guess_of, smallest_factors
from femref.plate_matrices import PlateSpace, geometric_stiffness
from femref.prestress import Movement, PlaneProblem, PlaneState, finite_state
from femref.sheet_mesh import PlateMaterial, SheetMesh

_MOST_SECANTS = 30
_Value = TypeVar("_Value")


@dataclass(frozen=True)
class Verdict:
    """The flat state at one load.

    factor : smallest positive multiple of its membrane stress at which it buckles; infinite without compression.
    unstable : number of modes with negative energy. thickness_mm : the least at which this plane state is stable.
    """

    load: float
    factor: float
    unstable: int
    thickness_mm: float


class FlatSheet:
    """A sheet of triangles that stays flat under finite strain; plane states are remembered as starts for others."""

    def __init__(
        self,
        sheet: SheetMesh,
        material: PlateMaterial,
        supports: Mapping[str, str],
        movements: Mapping[str, Movement],
    ) -> None:
        self.space = PlateSpace(sheet, material, supports)
        self.problem = PlaneProblem(sheet, material, movements, self.space.points)
        self._states: dict[float, PlaneState] = {}
        self._factors: dict[float, float] = {}

    def state(self, load: float) -> PlaneState:
        """The plane equilibrium at a load, from the nearest one known. Raises NoPrestress."""
        if load not in self._states:
            near = _nearest(self._states, load)
            self._states[load] = finite_state(self.problem, load, None if near is None else near.unknowns)
        return self._states[load]

    def matrices(self, load: float) -> tuple[csc_array, csc_array]:
        """Bending and geometric part of the out-of-plane tangent, (free, free) each, per Y h."""
        state = self.state(load)
        return covariant_bending(self.space, self.problem, state), geometric_stiffness(
            self.space, state.stress
        )

    def verdict(self, load: float) -> Verdict:
        """Stability of the flat state at a load. Raises NoPrestress, NotCertified."""
        factor = self.factor(load)
        unstable = factors_below(*self.matrices(load), 1.0) if factor < 1.0 else 0
        return Verdict(load, factor, unstable, self.space.material.thickness_mm / math.sqrt(factor))

    def factor(self, load: float) -> float:
        """`Verdict.factor` alone."""
        if load not in self._factors:
            near = _nearest(self._factors, load)
            try:
                rough = guess_of(self.space, self.state(load).stress)
                guess = 3.0 * rough if near is None or math.isinf(near) else 1.2 * near
                self._factors[load] = float(smallest_factors(*self.matrices(load), 1, guess).factor[0])
            except NoBuckling:
                self._factors[load] = math.inf
        return self._factors[load]

    def crossing(self, low: float, high: float, tolerance: float = 1e-6) -> float:
        """The load between two at which the flat state changes its stability.

        Raises ValueError if it is stable, or unstable, at both.
        """
        return _root(lambda load: math.log(self.factor(load)), low, high, tolerance)


def _nearest(known: Mapping[float, _Value], load: float) -> _Value | None:
    """The value at the nearest load, None if there is none."""
    return known[min(known, key=lambda other: abs(other - load))] if known else None


def covariant_bending(space: PlateSpace, problem: PlaneProblem, state: PlaneState) -> csc_array:
    """(free, free) bending stiffness about a plane deformed state: the form of b_ab above."""
    material = space.material
    c, two_mu, scale = material.c, material.two_mu, material.bending(space.sheet.length_mm)
    deformation = state.gradient + np.eye(2)[:, :, None, None]
    inverse = np.moveaxis(np.linalg.inv(np.moveaxis(deformation, (0, 1), (-2, -1))), (-2, -1), (0, 1))
    connection = np.einsum("lkcq,kabcq->labcq", inverse, second_derivatives(problem, state.gradient))

    @BilinearForm
    def form(w, v, data):  # type: ignore[no-untyped-def]
        g = data["connection"]

        def curvature(f):  # type: ignore[no-untyped-def]
            return f.hess - g[0] * f.grad[0] - g[1] * f.grad[1]

        b, d = curvature(w), curvature(v)
        trace_b, trace_d = b[0, 0] + b[1, 1], d[0, 0] + d[1, 1]
        product = b[0, 0] * d[0, 0] + 2.0 * b[0, 1] * d[0, 1] + b[1, 1] * d[1, 1]
        return scale * (c * trace_b * trace_d + two_mu * product)

    return space.reduce(csr_array(form.assemble(space.basis, connection=connection)))


def second_derivatives(problem: PlaneProblem, gradient: np.ndarray) -> np.ndarray:
    """(2, 2, 2, cells, points) u_k,ab of cubic displacements on triangles, by differentiating their gradient.

    gradient : (2, 2, cells, points) at the quadrature points, quadratic in each triangle.
    """
    x, y = problem.points[0]
    one, zero = np.ones_like(x), np.zeros_like(x)
    monomials = np.stack([one, x, y, x * x, x * y, y * y])
    slopes = np.stack([[zero, one, zero, 2.0 * x, y, zero], [zero, zero, one, zero, x, 2.0 * y]])
    # local coordinates -> mesh coordinates: affine in each triangle
    jacobian = np.moveaxis(problem.basis.mapping.DF(problem.points[0][:, :1])[..., 0], -1, 0)
    coefficients = np.einsum("kacq,qm->kacm", gradient, np.linalg.pinv(monomials))
    second = np.einsum("kacm,dmq,cdb->kabcq", coefficients, slopes, np.linalg.inv(jacobian), optimize=True)
    return 0.5 * (second + second.transpose(0, 2, 1, 3, 4))


@dataclass(frozen=True)
class Window:
    """The range of loads in which the flat sheet is unstable, and how far the last refinement moved its ends."""

    appearance: float
    appearance_error: float
    disappearance: float
    disappearance_error: float
    vertices: tuple[int, ...]


def window(
    make: Callable[[int], FlatSheet], vertices: Sequence[int], brackets: Sequence[tuple[float, float]]
) -> Window:
    """Loads at which the flat sheet becomes unstable and stable again, on a sequence of meshes.

    make : vertex count -> FlatSheet. vertices : at least two counts, ascending. brackets : loads about either end.
    """
    ends = []
    for count in vertices:
        flat = make(count)
        ends.append([flat.crossing(*bracket) for bracket in brackets])
        brackets = [_about(end, *bracket) for end, bracket in zip(ends[-1], brackets, strict=True)]
    (before, before_2), (last, last_2) = ends[-2:]
    return Window(last, abs(last - before), last_2, abs(last_2 - before_2), tuple(vertices))


def _about(load: float, low: float, high: float) -> tuple[float, float]:
    """A narrower bracket round the end found on a coarser mesh."""
    return max(low, 0.8 * load), min(high, 1.2 * load)


def _root(function: Callable[[float], float], low: float, high: float, tolerance: float) -> float:
    """A root in a bracket by the Illinois form of the secant rule (Dowell and Jarratt 1971)."""
    at_low, at_high = function(low), function(high)
    if not at_low * at_high <= 0.0:
        raise ValueError(
            f"the flat state has the same stability at {low:g} and {high:g}: no crossing between them"
        )
    for _ in range(_MOST_SECANTS):
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        if not math.isfinite(middle):  # no compression at one end: its factor is infinite
            middle = 0.5 * (low + high)
        value = function(middle)
        if value == 0.0 or abs(high - low) < tolerance * abs(middle):
            return middle
        if value * at_high < 0.0:
            low, at_low = high, at_high
        else:
            at_low *= 0.5
        step = abs(middle - high)
        high, at_high = middle, value
        if step < tolerance * abs(middle):
            return middle
    return high
