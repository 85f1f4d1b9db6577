"""The annulus by Chebyshev collocation of its second-order equilibrium equations, with moving band limits.

Unknown are the nodal r, phi, z. With the momenta p = R dW/dr', G = R r dW/d(r phi'), Q = R dW/dz'

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

from tensionfield.annulus_bands import ScaledSolution, runs, starts
from tensionfield.annulus_chebyshev import Elements
from tensionfield.annulus_energy import Array, States, energy, switch_function
from tensionfield.annulus_equations import linearised, lines, newton_step
from tensionfield.annulus_limits import Bands, moved
from tensionfield.annulus_problem import NoAnnulusSolution, ScaledAnnulus
from tensionfield.annulus_start import CoarseAnnulus

MAX_NEWTON = 40
MAX_MOVES = 30
DEGREE = 20
# change of log R and of the line derivatives over one element, coarsest first
VARIATIONS = (0.4, 0.2, 0.1)
MAX_ELEMENTS = 200  # beyond this a solution takes seconds
RESOLVED = 0.01  # share of the last Chebyshev coefficients of the slopes, over the tolerance


@dataclass(frozen=True)
class Collocated:
    """Nodal fields and slopes (e, n, 3) in equilibrium, with the state (e, 1) of every element."""

    elements: Elements
    branch: States
    field: Array
    slope: Array

    def fields_at(self, radii: Array) -> Array:
        """Return r, phi, z (..., 3) at `radii` (...)."""
        radii = np.asarray(radii)
        return self.elements.at(self.field, radii.ravel()).reshape(*radii.shape, 3)

    def lines_at(self, radii: Array) -> Array:
        """Return the line derivatives (m, 4) at `radii` (m,)."""
        slope = self.elements.at(self.slope, radii)
        r = self.elements.at(self.field, radii)[:, 0]
        return np.column_stack([slope[:, 0], r * slope[:, 1], slope[:, 2], r / radii])


def _variation(coarse: CoarseAnnulus) -> Callable[[Array], Array]:
    """Return how much log R and the line derivatives have changed from the inner rim to a radius."""
    middle = 0.5 * (coarse.radius[1:] + coarse.radius[:-1])
    change = np.linalg.norm(np.diff(coarse.line, axis=0), axis=1) + np.diff(np.log(middle))
    total = np.concatenate([[0.0], np.cumsum(change)])
    return lambda radii: np.interp(radii, middle, total)


def _elements(
    bands: Bands, inner: float, variation: Callable[[Array], Array], largest: float
) -> tuple[Elements, States]:
    """Return elements that respect the band limits, and the state (e, 1) of each.

    Within a band the `variation` is shared equally by as many elements as keep it below `largest`.
    """
    edges, breaks, branch = bands.edges(inner), [inner], []
    for low, high, state in zip(edges[:-1], edges[1:], bands.states, strict=True):
        radii = np.linspace(low, high, 2000)
        share = variation(radii) + 1e-3 * (
            radii - low
        )  # strictly increasing beyond the outermost midpoints too
        count = max(1, int(np.ceil((share[-1] - share[0]) / largest)))
        targets = np.linspace(share[0], share[-1], count + 1)[1:-1]
        breaks += [*np.interp(targets, share, radii), high]
        branch += [state] * count
    if len(branch) > MAX_ELEMENTS:
        raise NoAnnulusSolution("the fields of the annulus are too steep for collocation")
    return Elements(np.array(breaks), DEGREE), np.array(branch)[:, None]


def _equilibrium(elements: Elements, branch: States, field: Array, poisson: float) -> Collocated:
    """Solve the collocation equations from the nodal `field` (e, n, 3), whose rim values are kept.

    The slopes are summed up from those of the Newton steps: in a narrow element they would lose digits as
    differences of the nodal values, but the steps become small.
    """

    def derivative(nodal: Array) -> Array:
        return elements.derivative(nodal - nodal[:, :1])

    values, previous = elements.join(field), np.inf
    slope = derivative(elements.split(values))
    for _ in range(MAX_NEWTON):
        try:
            step = newton_step(elements, elements.split(values), slope, poisson, branch)
        except (np.linalg.LinAlgError, ValueError):  # singular, or no longer finite
            break
        size = float(np.max(np.abs(step)))
        if not np.isfinite(size):
            break
        step *= min(1.0, 0.1 / size) if size > 0.0 else 1.0
        values, slope = values + step, slope + derivative(elements.split(step))
        # Newton's steps fall quadratically: one that no longer falls is rounding
        if size < 1e-15 or (size < 1e-8 and size >= 0.25 * previous):
            return Collocated(elements, branch, elements.split(values), slope)
        previous = size
    raise NoAnnulusSolution("the collocation equations of the annulus did not converge")


def _solve(
    problem: ScaledAnnulus, coarse: CoarseAnnulus, largest: float, tolerance: float
) -> tuple[Collocated, Bands]:
    """Solve on elements with at most the variation `largest`, and move the limits until they rest."""
    states, changes = runs(coarse.state)
    bands = Bands(tuple(states), tuple(float(coarse.radius[i]) for i in changes))
    field: Callable[[Array], Array] = CubicSpline(coarse.radius, coarse.field)
    variation = _variation(coarse)
    for _ in range(MAX_MOVES):
        elements, branch = _elements(bands, problem.inner, variation, largest)
        solved = _equilibrium(elements, branch, field(elements.radius), problem.poisson)
        new = moved(_switch(solved, problem.poisson), bands, problem.inner)
        if new.states == bands.states:
            shift = max((abs(a - b) for a, b in zip(new.limits, bands.limits, strict=True)), default=0.0)
            if shift <= tolerance:
                return solved, bands
        bands, field = new, solved.fields_at
    raise NoAnnulusSolution("the limits of the wrinkled bands of the annulus did not settle")


def _switch(solved: Collocated, poisson: float) -> Callable[[Array], Array]:
    return lambda radii: switch_function(solved.lines_at(radii), poisson)


def _unresolved(solved: Collocated) -> float:
    """Return the largest share of the last Chebyshev coefficients in the slopes of any element."""
    size = np.abs(solved.elements.coefficients(solved.slope))
    return float(np.max(size[:, -2:]) / np.max(size))


def collocate(problem: ScaledAnnulus, tolerance: float) -> ScaledSolution:
    """Solve the annulus by collocation, on finer elements if the fields need them.

    tolerance : largest last change of a band limit, and a hundred times the largest share of the last Chebyshev
        coefficients of the slopes.

    Raises NoAnnulusSolution for slack zones and where Newton's method, the limits or the resolution fail.
    """
    failure = NoAnnulusSolution("the fields of the annulus are too steep for collocation")
    for coarse in starts(problem):
        for largest in VARIATIONS:
            try:
                solved, bands = _solve(problem, coarse, largest, tolerance)
            except NoAnnulusSolution as error:
                failure = error
                continue
            if _unresolved(solved) <= RESOLVED * tolerance:
                return _collected(solved, bands, problem)
    raise failure


def _collected(solved: Collocated, bands: Bands, problem: ScaledAnnulus) -> ScaledSolution:
    elements, field = solved.elements, solved.field
    momenta = linearised(elements, field, solved.slope, problem.poisson, solved.branch).momenta
    length = np.diff(elements.breaks)
    mean = np.einsum("e,enc->c", length, momenta) / (length.sum() * (DEGREE + 1))
    density = energy(lines(elements, field, solved.slope), problem.poisson, solved.branch)
    return ScaledSolution(
        switches=bands.limits,
        states=bands.states,
        torque=float(mean[1]),
        axial=float(mean[2]),
        energy=elements.integral(density * elements.radius),
        fields=solved.fields_at,
        lines=solved.lines_at,
    )
