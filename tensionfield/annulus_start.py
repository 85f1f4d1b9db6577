"""Coarse equilibrium of the annulus: the relaxed energy of linear elements, at its minimum.

Newton's method finds it, with a shift of the diagonal that makes the matrix positive definite. It needs no
start of its own and no load steps, and finds the order of the bands; shooting and collocation start from it.
Each element has one quadrature point, so the energy has an error of second order in the element size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from tensionfield.annulus_energy import Array, States, energy, force_and_tangent, zone_state
from tensionfield.annulus_problem import ScaledAnnulus

MAX_STEPS = 500
GRADIENT_TOLERANCE = 1e-13  # over the stress; rounding is near 1e-16
STEP_TOLERANCE = 1e-13  # over the outer radius; a Newton step this small is rounding
ENERGY_ROUNDING = 1e-14  # of the sum over the elements
SMALLEST_SHIFT, LARGEST_SHIFT = 1e-14, 1e12  # over the largest diagonal entry


@dataclass(frozen=True)
class CoarseAnnulus:
    """Nodal fields of the discrete minimum, scaled.

    radius : (n,) reference radii of the nodes.
    field : (n, 3) deformed radius, turn (radians) and height.
    line : (n - 1, 4) line derivatives at the element midpoints.
    state : (n - 1,) zone states of the elements.
    energy : energy over 2 pi Y h (outer radius)^2.
    at_rest : whether the minimisation came to rest.
    """

    radius: Array
    field: Array
    line: Array
    state: States
    energy: float
    at_rest: bool


def element_lines(radius: Array, field: Array) -> Array:
    """Return the midpoint line derivatives (n - 1, 4) of the nodal `field` (n, 3) at the radii (n,)."""
    size, middle = np.diff(radius), 0.5 * (radius[1:] + radius[:-1])
    slope = np.diff(field, axis=0) / size[:, None]
    r_middle = 0.5 * (field[1:, 0] + field[:-1, 0])
    return np.column_stack([slope[:, 0], r_middle * slope[:, 1], slope[:, 2], r_middle / middle])


def _element_systems(radius: Array, field: Array, poisson: float) -> tuple[Array, Array]:
    """Return the gradient (n - 1, 6) and tangent (n - 1, 6, 6) of the element energies."""
    size, middle = np.diff(radius), 0.5 * (radius[1:] + radius[:-1])
    line = element_lines(radius, field)
    force, tangent = force_and_tangent(line, poisson, zone_state(line, poisson))
    weight = middle * size
    turn = np.diff(field[:, 1]) / size
    r_middle = 0.5 * (field[1:, 0] + field[:-1, 0])
    jacobian = np.zeros((size.size, 4, 6))
    for side, sign in ((0, -1.0), (3, 1.0)):
        jacobian[:, 0, side] = sign / size
        jacobian[:, 1, side] = 0.5 * turn
        jacobian[:, 1, side + 1] = sign * r_middle / size
        jacobian[:, 2, side + 2] = sign / size
        jacobian[:, 3, side] = 0.5 / middle
    gradient = np.einsum("e,ek,eki->ei", weight, force, jacobian)
    matrix = np.swapaxes(jacobian, 1, 2) @ tangent @ jacobian
    for i in (0, 3):  # r phi' is a product: its second derivative couples r with phi
        for j, sign in ((1, -1.0), (4, 1.0)):
            mixed = force[:, 1] * 0.5 * sign / size
            matrix[:, i, j] += mixed
            matrix[:, j, i] += mixed
    return gradient, weight[:, None, None] * matrix


def _assemble(gradients: Array, matrices: Array) -> tuple[Array, Array]:
    """Return the gradient (3 m,) and the lower banded matrix (6, 3 m) of the m inner nodes."""
    count = gradients.shape[0] - 1
    gradient = gradients[:-1, 3:] + gradients[1:, :3]
    diagonal = matrices[:-1, 3:, 3:] + matrices[1:, :3, :3]
    coupling = matrices[1:-1, 3:, :3]
    band = np.zeros((6, 3 * count))
    for i in range(3):
        for j in range(3):
            if i >= j:
                band[i - j, j::3] = diagonal[:, i, j]
            band[3 + i - j, j : 3 * (count - 1) : 3] = coupling[:, i, j]
    return gradient.ravel(), band


def initial_field(problem: ScaledAnnulus, radius: Array) -> Array:
    """Return (n, 3) fields that meet the rims: radius and height linear in R, the turn linear in log R."""
    share = (radius - problem.inner) / (1.0 - problem.inner)
    turn = problem.twist * np.log(radius) / np.log(problem.inner)
    r = problem.r_inner + share * (problem.r_outer - problem.r_inner)
    return np.column_stack([r, turn, (1.0 - share) * problem.lift])


def _total_energy(problem: ScaledAnnulus, radius: Array, field: Array) -> float:
    line = element_lines(radius, field)
    density = energy(line, problem.poisson, zone_state(line, problem.poisson))
    return float(np.sum(0.5 * np.diff(radius**2) * density))


def coarse_annulus(problem: ScaledAnnulus, elements: int = 160) -> CoarseAnnulus:
    """Minimise the relaxed energy over piecewise linear fields.

    elements : number of elements, graded geometrically from rim to rim.
    """
    radius = np.geomspace(problem.inner, 1.0, elements + 1)
    radius[0], radius[-1] = problem.inner, 1.0
    field = initial_field(problem, radius)
    value, shift, at_rest = _total_energy(problem, radius, field), 1e-3, False
    for _ in range(MAX_STEPS):
        gradient, band = _assemble(*_element_systems(radius, field, problem.poisson))
        # the root of the energy measures the stress
        if np.max(np.abs(gradient)) <= GRADIENT_TOLERANCE * np.sqrt(value):
            at_rest = True
            break
        lowered = _lowered(problem, radius, field, value, gradient, band, shift)
        if lowered is None:
            break
        new_field, value, shift = lowered
        at_rest = bool(np.max(np.abs(new_field - field)) < STEP_TOLERANCE)
        field = new_field
        if at_rest:
            break
        shift = 0.1 * shift if shift > SMALLEST_SHIFT else 0.0
    line = element_lines(radius, field)
    return CoarseAnnulus(radius, field, line, zone_state(line, problem.poisson), value, at_rest)


def _lowered(
    problem: ScaledAnnulus,
    radius: Array,
    field: Array,
    value: float,
    gradient: Array,
    band: Array,
    shift: float,
) -> tuple[Array, float, float] | None:
    """Return a field of no higher energy by a shifted Newton step, its energy, and the shift that it took.

    Returns None if no shift is large enough.
    """
    scale = np.max(band[0])
    while shift < LARGEST_SHIFT:
        shifted = band.copy()
        shifted[0] += shift * scale
        try:
            step = cho_solve_banded((cholesky_banded(shifted, lower=True), True), -gradient)
        except LinAlgError:  # not positive definite
            shift = max(4.0 * shift, 100.0 * SMALLEST_SHIFT)
            continue
        trial = field.copy()
        trial[1:-1] += step.reshape(-1, 3)
        if np.all(trial[:, 0] > 0.0):
            new_value = _total_energy(problem, radius, trial)
            if new_value <= value * (1.0 + ENERGY_ROUNDING):
                return trial, new_value, shift
        shift = max(4.0 * shift, 100.0 * SMALLEST_SHIFT)
    return None
