"""The annulus by shooting: its first-order system integrated from rim to rim, split at the switches.

With the momenta of `annulus_momenta` the torque G and the axial force Q are constants, and what is left is

    r' = a_r,   p' = R P_phi phi' + dW/d(r / R),   phi' = a_phi / r,   z' = a_z.

The three unknowns p(inner), G and Q follow from the three conditions at the outer rim by Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import OdeSolution, solve_ivp

from tensionfield.annulus_bands import ScaledSolution, merged, starts
from tensionfield.annulus_energy import TENSE, WRINKLED, Array, force_and_tangent
from tensionfield.annulus_momenta import Momenta, Slope
from tensionfield.annulus_problem import NoAnnulusSolution, ScaledAnnulus
from tensionfield.annulus_start import CoarseAnnulus

MAX_NEWTON = 30
MAX_BANDS = 20
SWITCH_ROUNDING, FIRST_STEP = 1e-14, 1e-6  # of strains near 1; a step over which it changes by more
AXIS = 1e-6  # deformed radius, over the outer radius, that counts as the axis
DIFFERENCE = (
    1e-6  # relative step of the Jacobian: halfway between rounding and curvature at the loose tolerance
)
LOOSE = 1e-9  # relative tolerance of the integrator while searching
TIGHT = 3e-3  # the same at the end, over the tolerance; 1e-11 leaves the integrator just above rounding


@dataclass(frozen=True)
class Band:
    """One integrated band: its state, its ends, and the dense r, p, phi, z, energy (5,) in between."""

    state: int
    low: float
    high: float
    path: OdeSolution


def _branch(momenta: Momenta, state: int) -> Callable[[float, float, float], Slope]:
    return momenta.tense if state == TENSE else momenta.wrinkled


def _rates(momenta: Momenta, state: int) -> Callable[[float, Array], list[float]]:
    """Return the right side of the first-order system of one state."""
    branch = _branch(momenta, state)

    def rates(radius: float, y: Array) -> list[float]:
        r, p = float(y[0]), float(y[1])
        a = branch(radius, r, p)
        turn = a.turn / r
        return [a.radial, momenta.torque / r * turn + a.hoop_force, turn, a.axial, a.energy * radius]

    return rates


def _events(momenta: Momenta, state: int) -> tuple[Callable[[float, Array], float], ...]:
    """Return the ends of a band: the zero of the switch function, and a sheet that runs into its axis."""
    branch = _branch(momenta, state)

    def switch(radius: float, y: Array) -> float:
        return branch(radius, float(y[0]), float(y[1])).switch

    def axis(radius: float, y: Array) -> float:
        return float(y[0]) - AXIS

    # solve_ivp reads these attributes; the direction keeps it from stopping at the switch where a band starts
    switch.terminal = axis.terminal = True  # type: ignore[attr-defined]
    switch.direction = -1.0 if state == TENSE else 1.0  # type: ignore[attr-defined]
    return switch, axis


def _first_state(momenta: Momenta, radius: float, y: Array) -> int:
    """Return the state beside the inner rim, from the switch function at the rim or just beyond.

    At the rim it is zero for nu = 0 without twist and growth, and its rounded sign says nothing.
    """
    switch = momenta.tense(radius, float(y[0]), float(y[1])).switch
    if abs(switch) < SWITCH_ROUNDING:
        rate = _rates(momenta, TENSE)(radius, y)
        step = FIRST_STEP * radius
        switch = momenta.tense(
            radius + step, float(y[0]) + step * rate[0], float(y[1]) + step * rate[1]
        ).switch
    return TENSE if switch > 0.0 else WRINKLED


def shoot(problem: ScaledAnnulus, unknown: Array, tolerance: float) -> list[Band]:
    """Integrate from the inner rim with p, G, Q = `unknown` (3,), and return the bands.

    Raises NoAnnulusSolution if the sheet runs into its axis or the bands do not end.
    """
    momenta = Momenta(problem.poisson, float(unknown[1]), float(unknown[2]))
    radius, y = problem.inner, np.array([problem.r_inner, unknown[0], problem.twist, problem.lift, 0.0])
    state = _first_state(momenta, radius, y)
    load = float(np.max(np.abs(unknown)))  # the size of the stresses, small under small loads
    scale = np.array([1.0, load, 1.0, 1.0, load**2])
    bands: list[Band] = []
    while radius < 1.0:
        result = solve_ivp(
            _rates(momenta, state),
            (radius, 1.0),
            y,
            method="DOP853",
            rtol=tolerance,
            atol=1e-2 * tolerance * scale,
            events=_events(momenta, state),
            dense_output=True,
            max_step=(1.0 - problem.inner) / 12.0,
        )
        on_axis = result.t_events is None or result.t_events[1].size > 0
        if not result.success or result.sol is None or on_axis or len(bands) == MAX_BANDS:
            raise NoAnnulusSolution("an integration across the annulus left the range of the relaxed energy")
        bands.append(Band(state, radius, float(result.t[-1]), result.sol))
        radius, y, state = float(result.t[-1]), result.y[:, -1], TENSE + WRINKLED - state
    return bands


def _miss(problem: ScaledAnnulus, bands: list[Band]) -> Array:
    """Return the errors of r, phi, z (3,) at the outer rim."""
    y = bands[-1].path(1.0)
    return np.array([y[0] - problem.r_outer, y[2], y[3]])


def _jacobian(problem: ScaledAnnulus, unknown: Array, miss: Array) -> Array:
    """Return the derivative (3, 3) of the errors at the outer rim, by one-sided differences."""
    step = DIFFERENCE * float(np.max(np.abs(unknown)))
    columns = [(_miss(problem, shoot(problem, unknown + step * e, LOOSE)) - miss) / step for e in np.eye(3)]
    return np.stack(columns, axis=1)


def _first_guess(problem: ScaledAnnulus, coarse: CoarseAnnulus) -> Array:
    """Return p at the inner rim, G and Q (3,) of the coarse equilibrium."""
    force, _ = force_and_tangent(coarse.line, problem.poisson, coarse.state)
    middle = 0.5 * (coarse.radius[1:] + coarse.radius[:-1])
    p = middle * force[:, 0]
    inner = p[0] + (p[1] - p[0]) * (problem.inner - middle[0]) / (middle[1] - middle[0])
    torque = middle**2 * coarse.line[:, 3] * force[:, 1]
    return np.array([inner, torque.mean(), (middle * force[:, 2]).mean()])


def _improved(problem: ScaledAnnulus, unknown: Array, miss: Array, step: Array) -> tuple[Array, Array]:
    """Take a Newton step, shortened until the sheet can be integrated and the error falls."""
    for _ in range(30):
        try:
            new_miss = _miss(problem, shoot(problem, unknown + step, LOOSE))
        except NoAnnulusSolution:
            step = 0.5 * step
            continue
        if np.linalg.norm(new_miss) < np.linalg.norm(miss):
            return unknown + step, new_miss
        step = 0.5 * step
    raise NoAnnulusSolution("shooting across the annulus did not converge")


def _search(problem: ScaledAnnulus, unknown: Array) -> tuple[Array, Array]:
    """Return p, G, Q that meet the outer rim to the loose tolerance, and the Jacobian there."""
    miss = _miss(problem, shoot(problem, unknown, LOOSE))
    for _ in range(MAX_NEWTON):
        jacobian = _jacobian(problem, unknown, miss)
        if np.max(np.abs(miss)) < 100.0 * LOOSE:
            return unknown, jacobian
        step = np.asarray(np.linalg.solve(jacobian, -miss), dtype=np.float64)
        unknown, miss = _improved(problem, unknown, miss, step)
    raise NoAnnulusSolution("shooting across the annulus did not converge")


def _polish(
    problem: ScaledAnnulus, unknown: Array, jacobian: Array, tolerance: float
) -> tuple[Array, list[Band]]:
    """Return p, G, Q at the tight tolerance and their bands, by Broyden's updates of the Jacobian."""
    tight = max(TIGHT * tolerance, 3e-14)
    bands = shoot(problem, unknown, tight)
    miss = _miss(problem, bands)
    best = unknown, bands, float(np.max(np.abs(miss)))
    for _ in range(MAX_NEWTON):
        step = np.linalg.solve(jacobian, -miss)
        unknown = unknown + step
        bands = shoot(problem, unknown, tight)
        new_miss = _miss(problem, bands)
        size = float(np.max(np.abs(new_miss)))
        if size < best[2]:
            best = unknown, bands, size
        elif best[2] < tolerance:
            return best[0], best[1]  # rounding: the error no longer falls
        if size == 0.0:
            return unknown, bands
        jacobian = jacobian + np.outer(new_miss - miss - jacobian @ step, step) / (step @ step)
        miss = new_miss
    raise NoAnnulusSolution("shooting across the annulus did not reach its last digits")


def solve_by_shooting(problem: ScaledAnnulus, tolerance: float) -> ScaledSolution:
    """Solve the annulus by shooting.

    tolerance : largest error of r, phi, z at the outer rim.

    Raises NoAnnulusSolution for slack zones and where no solution is found.
    """
    failure = NoAnnulusSolution("shooting across the annulus did not converge")
    for coarse in starts(problem):
        try:
            unknown, jacobian = _search(problem, _first_guess(problem, coarse))
            return _collected(problem, *_polish(problem, unknown, jacobian, tolerance))
        except NoAnnulusSolution as error:
            failure = error
    raise failure


def _collected(problem: ScaledAnnulus, unknown: Array, bands: list[Band]) -> ScaledSolution:
    momenta = Momenta(problem.poisson, float(unknown[1]), float(unknown[2]))

    def path(radii: Array) -> tuple[Array, NDArray[np.int64]]:
        """Return r, p, phi, z, energy (5, m) and the index of the band (m,)."""
        index = np.searchsorted([band.high for band in bands[:-1]], radii)
        y = np.empty((5, radii.size))
        for i, band in enumerate(bands):
            y[:, index == i] = band.path(radii[index == i]) if np.any(index == i) else 0.0
        return y, index

    def fields(radii: Array) -> Array:
        radii = np.asarray(radii)
        return path(radii.ravel())[0][[0, 2, 3]].T.reshape(*radii.shape, 3)

    def lines(radii: Array) -> Array:
        y, index = path(radii)
        slopes = [
            _branch(momenta, bands[i].state)(float(radius), float(r), float(p))
            for i, radius, r, p in zip(index, radii, y[0], y[1], strict=True)
        ]
        return np.column_stack([np.array([slope[:3] for slope in slopes]).reshape(-1, 3), y[0] / radii])

    ends = [band.high for band in bands[:-1]]
    states, switches = merged([band.state for band in bands], ends, problem.inner)
    return ScaledSolution(
        switches=switches,
        states=states,
        torque=momenta.torque,
        axial=momenta.axial,
        energy=float(bands[-1].path(1.0)[4]),
        fields=fields,
        lines=lines,
    )
