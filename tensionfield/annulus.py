"""The exact annulus: the axisymmetric relaxed membrane between two displaced rims.

Two methods that share only the problem and a coarse start give the same answer to about 12 digits:
event-split shooting of the first-order system in the momenta (`annulus_shooting`), and Chebyshev collocation
of the second-order equations in the displacements with moving band limits (`annulus_collocation`).

Inside a wrinkled band the tension lines are straight, and the major stretch l follows from two constants
(Taylor, Bertoldi & Steigmann 2014, section 4.4; Steigmann 1990):

    R^2 = C^2 / f(l)^2 + t^2 / l^2,   f(l) = l (l^2 - 1) / 2,   R f cos(alpha) = C,   R l sin(alpha) = t,

with alpha the angle from the radius to the tension direction in the reference.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fdsolver.material import Sheet
from tensionfield.annulus_bands import ScaledSolution
from tensionfield.annulus_collocation import collocate
from tensionfield.annulus_energy import TENSE, WRINKLED, Array, force_and_tangent, principal_strains
from tensionfield.annulus_momenta import excess
from tensionfield.annulus_problem import AnnulusProblem, NoAnnulusSolution, scaled
from tensionfield.annulus_shooting import solve_by_shooting

__all__ = ["AnnulusProblem", "AnnulusSolution", "NoAnnulusSolution", "solve_annulus", "wrinkled_stretch"]

METHODS = {"shooting": solve_by_shooting, "collocation": collocate}
# below the smaller one rounding decides, above the larger one the switches are no longer those of the problem
TOLERANCES = (1e-12, 1e-6)
WARNING_SAMPLES = 400


@dataclass(frozen=True)
class AnnulusSolution:
    """The relaxed equilibrium of an annulus, as functions of the reference radius.

    problem : what was solved.
    switch_radii_mm : radii at which the state changes, ascending, mm.
    states : state of each band from the inside, 1 wrinkled, 2 tense; one more than switch_radii_mm.
    C_mm, t_mm : the two constants of the law in the innermost wrinkled band, mm; None without one. With the
        tension direction pointing outward, t is negative for a positive twist.
    torque_N_mm, axial_force_N : what the inner support exerts on the sheet about and along the axis; positive
        for a positive twist and lift. The outer support exerts the opposite.
    energy_N_mm : relaxed membrane energy, N mm.
    warnings : sentences on results that need care; empty without any.
    """

    problem: AnnulusProblem
    switch_radii_mm: tuple[float, ...]
    states: tuple[int, ...]
    C_mm: float | None
    t_mm: float | None
    torque_N_mm: float
    axial_force_N: float
    energy_N_mm: float
    warnings: tuple[str, ...]
    _scaled: ScaledSolution = field(repr=False, compare=False)

    def _radii(self, radius_mm: ArrayLike) -> Array:
        """Return `radius_mm` in outer radii; raise ValueError outside the sheet."""
        radius = np.asarray(radius_mm, dtype=np.float64)
        low, high = self.problem.inner_radius_mm, self.problem.outer_radius_mm
        if not np.all((radius >= low) & (radius <= high)):
            raise ValueError(f"radii must lie between the rims, {low} to {high} mm")
        return radius / high

    def _lines(self, radius_mm: ArrayLike) -> Array:
        radii = self._radii(radius_mm)
        return self._scaled.lines(radii.ravel()).reshape(*radii.shape, 4)

    def position(self, radius_mm: ArrayLike) -> tuple[Array, Array, Array]:
        """Return deformed radius (mm), turn (radians) and height (mm) at the reference radii; height 0 at the
        outer rim.

        Every result has the shape of `radius_mm`, as in the methods below. Raises ValueError outside the
        sheet.
        """
        unit = self.problem.outer_radius_mm
        fields = self._scaled.fields(self._radii(radius_mm))
        return unit * fields[..., 0], fields[..., 1], unit * fields[..., 2]

    def stretches(self, radius_mm: ArrayLike) -> tuple[Array, Array]:
        """Return the major and minor principal stretches of the mean deformation, wrinkles smoothed out."""
        major, minor = principal_strains(self._lines(radius_mm))
        return np.sqrt(1.0 + 2.0 * major), np.sqrt(1.0 + 2.0 * minor)

    def stresses(self, radius_mm: ArrayLike) -> tuple[Array, Array]:
        """Return the major and minor second Piola-Kirchhoff stresses, MPa."""
        major, minor = principal_strains(self._lines(radius_mm))
        nu, young = self.problem.poisson, self.problem.young_MPa
        tense = self.state(radius_mm) == TENSE
        biaxial = young / (1.0 - nu**2)
        return (
            np.where(tense, biaxial * (major + nu * minor), young * major),
            np.where(tense, biaxial * (minor + nu * major), 0.0),
        )

    def state(self, radius_mm: ArrayLike) -> NDArray[np.int64]:
        """Return the state, 1 wrinkled or 2 tense."""
        return np.asarray(self.states)[np.searchsorted(self._scaled.switches, self._radii(radius_mm))]


def wrinkled_stretch(radius_mm: ArrayLike, C_mm: float, t_mm: float) -> Array:
    """Return the major stretch of a wrinkled band from its two constants: the root l > 1 of the law above."""
    radius = np.asarray(radius_mm, dtype=np.float64)
    strain = [excess(R, (R - t_mm) * (R + t_mm), C_mm) for R in radius.ravel().tolist()]
    return np.sqrt(1.0 + np.reshape(strain, radius.shape))


def solve_annulus(
    problem: AnnulusProblem, method: str = "shooting", tolerance: float = 1e-11
) -> AnnulusSolution:
    """Solve the axisymmetric relaxed boundary-value problem of an annulus.

    method : "shooting" or "collocation".
    tolerance : largest error of the rim conditions (shooting) or of the switch radii (collocation), over the
        outer radius. Strains are differences of numbers near 1, so relative errors grow as 1e-16 over the
        strain: loads with strains below 1e-6 have fewer than ten digits.

    Raises NoAnnulusSolution where a zone is slack or the sheet closes on its axis, for then the equilibrium
    is not unique, and where the method fails; ValueError for an unknown method or a tolerance that it cannot
    keep.
    """
    if method not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, not {method!r}")
    if not TOLERANCES[0] <= tolerance <= TOLERANCES[1]:
        raise ValueError(f"tolerance must lie between {TOLERANCES[0]} and {TOLERANCES[1]}, not {tolerance}")
    solution = METHODS[method](scaled(problem), tolerance)
    unit, stiffness = problem.outer_radius_mm, 2.0 * pi * problem.young_MPa * problem.thickness_mm
    constant, lever = _constants(solution, problem)
    return AnnulusSolution(
        problem=problem,
        switch_radii_mm=tuple(unit * radius for radius in solution.switches),
        states=solution.states,
        C_mm=constant,
        t_mm=lever,
        # adding zero turns the -0.0 of an unloaded direction into 0.0
        torque_N_mm=-stiffness * unit**2 * solution.torque + 0.0,
        axial_force_N=-stiffness * unit * solution.axial + 0.0,
        energy_N_mm=stiffness * unit**2 * solution.energy,
        warnings=_warnings(solution, problem),
        _scaled=solution,
    )


def _constants(solution: ScaledSolution, problem: AnnulusProblem) -> tuple[float | None, float | None]:
    """Return C and t, mm, of the innermost wrinkled band from the stress vector at its middle."""
    if WRINKLED not in solution.states:
        return None, None
    unit = problem.outer_radius_mm
    edges = (problem.inner_radius_mm / unit, *solution.switches, 1.0)
    band = solution.states.index(WRINKLED)
    radius = np.array([0.5 * (edges[band] + edges[band + 1])])
    line = solution.lines(radius)
    force = force_and_tangent(line, problem.poisson, WRINKLED)[0][0]
    constant = float(radius[0] * np.linalg.norm(force[:3]))
    return unit * constant, unit * solution.torque / constant + 0.0


def _warnings(solution: ScaledSolution, problem: AnnulusProblem) -> tuple[str, ...]:
    """Return the sentences of `AnnulusSolution.warnings`."""
    sheet = Sheet(problem.young_MPa, problem.poisson, problem.thickness_mm)
    line = solution.lines(
        np.linspace(problem.inner_radius_mm / problem.outer_radius_mm, 1.0, WARNING_SAMPLES)
    )
    largest = sqrt(1.0 + 2.0 * float(np.max(principal_strains(line)[0])))
    limit = sheet.natural_width_limit
    found = []
    if largest > limit < inf:
        found.append(
            f"a stretch of {largest:.4g} passes sqrt(1 + 1/nu) = {limit:.4g}: the material law has no "
            "natural width there, and the sheet counts as tense"
        )
    if problem.lift_mm == 0.0 and np.any(line[:, 0] < 0.0):
        found.append("the flat sheet folds over itself: it covers a part of the plane twice")
    return tuple(found)
