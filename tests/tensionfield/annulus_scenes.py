"""The annuli of these tests, and the relaxed energy written down a second time, in Cartesian coordinates."""

from __future__ import annotations

import functools

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import NDArray

from tensionfield.annulus import AnnulusProblem, AnnulusSolution, solve_annulus

Array = NDArray[np.float64]


def annulus(
    inner: float = 62.5,
    poisson: float = 0.31,
    lift: float = 0.0,
    twist: float = 0.0,
    grow: tuple[float, float] = (0.0, 0.0),
    outer: float = 250.0,
) -> AnnulusProblem:
    """The annulus of the paper's size, material and an assumed thickness, under the given load (mm, degrees)."""
    return AnnulusProblem(inner, outer, 3500.0, poisson, 0.025, lift, twist, *grow)


PAPER = annulus(lift=125.0, twist=90.0)

# name -> problem, states of the bands from the inside
SCENES: dict[str, tuple[AnnulusProblem, tuple[int, ...]]] = {
    "paper": (PAPER, (2, 1, 2)),
    "lift": (annulus(lift=125.0), (2,)),
    "small lift": (annulus(lift=5.0), (2,)),
    "lift downwards": (annulus(lift=-300.0), (2,)),
    "twist": (annulus(twist=10.0), (1, 2)),
    "large twist": (annulus(twist=90.0), (2, 1, 2)),
    "small twist": (annulus(twist=0.5, poisson=0.5), (1, 2)),
    "shrink": (annulus(grow=(-2.5, 0.0)), (1, 2)),
    "large shrink": (annulus(grow=(-40.0, 0.0)), (1, 2)),
    "stretched": (annulus(grow=(0.0, 20.0)), (2,)),
    "lift, outer rim shrunk": (annulus(lift=125.0, grow=(0.0, -20.0)), (2, 1)),
    "lift, inner rim grown": (annulus(lift=125.0, grow=(10.0, 0.0)), (2,)),
    "pre-stretched twist": (annulus(twist=20.0, grow=(0.0, 10.0)), (1, 2)),
    "everything": (annulus(lift=60.0, twist=-40.0, grow=(-5.0, 8.0)), (1, 2)),
    "small hole": (annulus(inner=5.0, lift=125.0, twist=90.0), (2, 1, 2)),
    "narrow ring": (annulus(inner=200.0, lift=125.0, twist=90.0), (2,)),
    "narrow ring, twist": (annulus(inner=225.0, twist=0.5), (1,)),
    "nu 0, lift": (annulus(poisson=0.0, lift=125.0), (2,)),
    # the switch function is zero at the inner rim, and its rounded sign says nothing about the band beside it
    "nu 0, lift, wide hole": (annulus(inner=150.40220940969834, poisson=0.0, lift=-88.01029422367012), (2,)),
    "nu 0": (annulus(poisson=0.0, lift=125.0, twist=90.0), (1,)),
    "nu 0, both rims wrinkled": (annulus(inner=6.6, poisson=0.0, lift=200.0, twist=-9.3), (1, 2, 1)),
    "nu -0.5": (annulus(poisson=-0.5, lift=125.0, twist=90.0), (1,)),
    "nu -0.2": (annulus(poisson=-0.2, lift=125.0, twist=60.0), (1,)),
    "nu 0.5": (annulus(poisson=0.5, lift=125.0, twist=90.0), (2,)),
}


@functools.cache
def solved(problem: AnnulusProblem, method: str = "shooting") -> AnnulusSolution:
    """The solution of a problem, found once for all tests."""
    return solve_annulus(problem, method)


def density(slopes: NDArray, r: NDArray | float, radius: Array, poisson: float, tense: bool) -> NDArray:
    """Relaxed energy per reference area over Y h from the Cartesian deformation gradient at the angle zero.

    slopes : (3, m) r', phi', z'; `slopes` and `r` may be complex, for derivatives by complex steps.
    """
    turn = 0.7  # any: the energy does not depend on the turn itself
    out, around = np.array([np.cos(turn), np.sin(turn), 0.0]), np.array([-np.sin(turn), np.cos(turn), 0.0])
    radial = np.outer(out, slopes[0]) + np.outer(around, r * slopes[1]) + np.outer([0.0, 0.0, 1.0], slopes[2])
    hoop = np.outer(around, r / radius)
    c11, c22, c12 = (radial**2).sum(0), (hoop**2).sum(0), (radial * hoop).sum(0)
    root = np.sqrt(((c11 + c22) / 2) ** 2 - (c11 * c22 - c12**2))
    major, minor = ((c11 + c22) / 2 + root - 1) / 2, ((c11 + c22) / 2 - root - 1) / 2
    if not tense:
        return major**2 / 2
    c, mu = poisson / (1 - poisson**2), 1 / (2 * (1 + poisson))
    return (c * (major + minor) ** 2 + 2 * mu * (major**2 + minor**2)) / 2


def bands(solution: AnnulusSolution) -> list[tuple[float, float, int]]:
    """Ends (mm) and state of every band."""
    problem = solution.problem
    edges = (problem.inner_radius_mm, *solution.switch_radii_mm, problem.outer_radius_mm)
    return list(zip(edges[:-1], edges[1:], solution.states, strict=True))


def interpolated(solution: AnnulusSolution, low: float, high: float, degree: int = 20) -> list[Chebyshev]:
    """Chebyshev interpolants of r, phi, z (mm, radians) between two radii of one band, mm.

    Their derivatives are the slopes, found without the solver's own.
    """
    return [
        Chebyshev.interpolate(lambda x, i=i: solution.position(np.clip(x, low, high))[i], degree, [low, high])
        for i in range(3)
    ]
