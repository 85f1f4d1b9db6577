"""The annulus by Chebyshev collocation of its second-order equilibrium equations, with moving band limits.

Unknown are the nodal r, phi, z. With the momenta p = R dW/dr', G = R r dW/d(r phi'), Q = R dW/dz' the
equations

    p' = R dW/d(r phi') phi' + dW/d(r / R),    G' = 0,    Q' = 0

hold at the inner nodes of every element, and the momenta are continuous from element to element. Every band
keeps one smooth branch of the relaxed energy. A limit misplaced by d changes the fields outside the misplaced
strip by O(d^2) only, because the two branches and their stresses agree at the switch; so moving each limit to
the zero of the switch function after every Newton solve converges quadratically.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from tensionfield.annulus_bands import ScaledSolution, runs, start
from tensionfield.annulus_chebyshev import Elements
from tensionfield.annulus_energy import TENSE, WRINKLED, Array, States, energy, switch_function
from tensionfield.annulus_equations import linearised, lines, newton_system
from tensionfield.annulus_problem import NoAnnulusSolution, ScaledAnnulus
from tensionfield.annulus_start import CoarseAnnulus

MAX_NEWTON = 40
MAX_MOVES = 30
DEGREE = 20
SPLITS = (1.5, 1.2, 1.08)  # largest ratio of the two radii of an element, coarsest first
RESOLVED = 0.1  # share of the last Chebyshev coefficients, over the tolerance
SAMPLES = 400  # points per band at which the sign of the switch function is read


@dataclass(frozen=True)
class Bands:
    """States of the bands from the inside, and the radii between them."""

    states: tuple[int, ...]
    limits: tuple[float, ...]

    def edges(self, inner: float) -> tuple[float, ...]:
        """Return the radii of all band ends, rims included."""
        return (inner, *self.limits, 1.0)


@dataclass(frozen=True)
class Collocated:
    """Nodal fields (e, n, 3) in equilibrium, with the state (e, 1) of every element."""

    elements: Elements
    branch: States
    field: Array

    def fields_at(self, radii: Array) -> Array:
        """Return r, phi, z (..., 3) at `radii` (...)."""
        radii = np.asarray(radii)
        return self.elements.at(self.field, radii.ravel()).reshape(*radii.shape, 3)

    def lines_at(self, radii: Array) -> Array:
        """Return the line derivatives (m, 4) at `radii` (m,)."""
        slope = self.elements.at(self.elements.derivative(self.field), radii)
        r = self.elements.at(self.field, radii)[:, 0]
        return np.column_stack([slope[:, 0], r * slope[:, 1], slope[:, 2], r / radii])


def _elements(bands: Bands, inner: float, ratio: float) -> tuple[Elements, States]:
    """Return elements that respect the band limits, and the state (e, 1) of each."""
    edges, breaks, branch = bands.edges(inner), [inner], []
    for low, high, state in zip(edges[:-1], edges[1:], bands.states, strict=True):
        count = max(1, int(np.ceil(np.log(high / low) / np.log(ratio))))
        breaks += [*np.geomspace(low, high, count + 1)[1:-1], high]
        branch += [state] * count
    return Elements(np.array(breaks), DEGREE), np.array(branch)[:, None]


def _equilibrium(elements: Elements, branch: States, field: Array, poisson: float) -> Collocated:
    """Solve the collocation equations from the nodal `field` (e, n, 3), whose rim values are kept."""
    values, previous = elements.join(field), np.inf
    for _ in range(MAX_NEWTON):
        residual, jacobian = newton_system(elements, elements.split(values), poisson, branch)
        try:
            step = np.linalg.solve(jacobian.reshape(residual.size, -1), -residual.ravel()).reshape(-1, 3)
        except np.linalg.LinAlgError:
            break
        size = float(np.max(np.abs(step)))
        if not np.isfinite(size):
            break
        values[1:-1] += step * min(1.0, 0.1 / size)
        # Newton's steps fall quadratically: one that no longer falls is rounding
        if size < 1e-14 or (size < 1e-8 and size >= 0.25 * previous):
            return Collocated(elements, branch, elements.split(values))
        previous = size
    raise NoAnnulusSolution("the collocation equations of the annulus did not converge")


def _moved(solved: Collocated, bands: Bands, problem: ScaledAnnulus) -> Bands:
    """Return the bands between the sign changes of the switch function of a solution."""

    def switch(radius: float) -> float:
        return float(switch_function(solved.lines_at(np.array([radius])), problem.poisson)[0])

    edges = bands.edges(problem.inner)
    radii = np.concatenate(
        [np.linspace(a, b, SAMPLES)[1:-1] for a, b in zip(edges[:-1], edges[1:], strict=True)]
    )
    values = switch_function(solved.lines_at(radii), problem.poisson)
    # a sign change shallower than this is rounding of the strains, not a band
    depth = 1e-11 + 1e-9 * float(np.max(np.abs(values)))
    signs = np.where(values > 0.0, TENSE, WRINKLED)
    states, changes = runs(signs)
    parts = np.split(np.abs(values), changes)
    deep = [bool(np.max(part) > depth) for part in parts]
    for index, (part, keep) in enumerate(zip(np.split(np.arange(values.size), changes), deep, strict=True)):
        if not keep:
            signs[part] = states[index - 1] if index else states[min(1, len(states) - 1)]
    states, changes = runs(signs)
    limits = [_zero(switch, radii[i - 1], radii[i], bands.limits, signs[i - 1]) for i in changes]
    return Bands(tuple(states), tuple(limits))


def _zero(
    switch: Callable[[float], float], low: float, high: float, limits: tuple[float, ...], state_below: int
) -> float:
    """Return the zero of the switch function between `low` and `high`, where its signs differ.

    Its values on the two sides of a present limit in between come from different branches, and the zero is
    looked for on the side whose sign has changed; a limit at which neither sign has changed is the zero
    already.
    """
    for limit in limits:
        if low < limit < high:
            sign = 1.0 if state_below == TENSE else -1.0
            above = float(np.nextafter(limit, 2.0))
            if sign * switch(limit) < 0.0:
                high = limit
            elif sign * switch(above) > 0.0:
                low = above
            else:
                return limit
    return float(brentq(switch, low, high, xtol=1e-16, rtol=1e-15))


def _solve(
    problem: ScaledAnnulus, coarse: CoarseAnnulus, ratio: float, tolerance: float
) -> tuple[Collocated, Bands]:
    """Solve with elements whose radii differ by at most the factor `ratio`."""
    states, changes = runs(coarse.state)
    bands = Bands(tuple(states), tuple(float(coarse.radius[i]) for i in changes))
    spline = CubicSpline(coarse.radius, coarse.field)
    field: Callable[[Array], Array] = spline
    for _ in range(MAX_MOVES):
        elements, branch = _elements(bands, problem.inner, ratio)
        solved = _equilibrium(elements, branch, field(elements.radius), problem.poisson)
        moved = _moved(solved, bands, problem)
        shift = np.inf
        if moved.states == bands.states:
            shift = max((abs(a - b) for a, b in zip(moved.limits, bands.limits, strict=True)), default=0.0)
        if shift <= tolerance:
            return solved, bands
        bands, field = moved, solved.fields_at
    raise NoAnnulusSolution("the limits of the wrinkled bands of the annulus did not settle")


def _unresolved(solved: Collocated) -> float:
    """Return the largest share of the last Chebyshev coefficients in the fields of any element."""
    size = np.abs(solved.elements.coefficients(solved.field))
    return float(np.max(size[:, -2:]) / np.max(size))


def collocate(problem: ScaledAnnulus, tolerance: float) -> ScaledSolution:
    """Solve the annulus by collocation, on finer elements if the fields need them.

    tolerance : largest last change of a band limit, and tenfold the largest share of the last Chebyshev
        coefficients.

    Raises NoAnnulusSolution for slack zones and where Newton's method, the limits or the resolution fail.
    """
    coarse = start(problem)
    for ratio in SPLITS:
        solved, bands = _solve(problem, coarse, ratio, tolerance)
        if _unresolved(solved) <= RESOLVED * tolerance:
            return _collected(solved, bands, problem)
    raise NoAnnulusSolution("the fields of the annulus are too steep for the collocation elements")


def _collected(solved: Collocated, bands: Bands, problem: ScaledAnnulus) -> ScaledSolution:
    elements, field = solved.elements, solved.field
    momenta = linearised(elements, field, problem.poisson, solved.branch).momenta
    length = np.diff(elements.breaks)
    mean = np.einsum("e,enc->nc", length, momenta) / length.sum()
    density = energy(lines(elements, field)[0], problem.poisson, solved.branch)
    return ScaledSolution(
        switches=bands.limits,
        states=bands.states,
        torque=float(np.mean(mean[:, 1])),
        axial=float(np.mean(mean[:, 2])),
        energy=elements.integral(density * elements.radius),
        fields=solved.fields_at,
        lines=solved.lines_at,
    )
