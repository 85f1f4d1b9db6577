"""Buckling of rings and of a plate with a hole: against Bessel functions, and in the limit of no hole."""

from __future__ import annotations

import numpy as np
import pytest

from femref.buckle import smallest_factors
from femref.meshes import annulus, rectangle_with_hole
from femref.plate_matrices import PlateSpace, bending_stiffness, geometric_stiffness
from femref.sheet_mesh import PlateMaterial, SheetMesh
from tests.femref.rings import isotropic_factors, ring_factors

MATERIAL = PlateMaterial(1000.0, 0.31, 1.0)
INNER, OUTER = 25.0, 100.0
SUPPORTS = [("clamped", "clamped"), ("pinned", "clamped"), ("clamped", "pinned"), ("pinned", "pinned")]


def coefficients(sheet: SheetMesh, supports: dict[str, str], stress: np.ndarray, guess: float) -> np.ndarray:
    """The first factors N / D, per mm^2, under a homogeneous stress. guess : about the third."""
    space = PlateSpace(sheet, MATERIAL, supports)
    unit = MATERIAL.thickness_mm**2 / (12.0 * (1.0 - MATERIAL.poisson**2))
    found = smallest_factors(bending_stiffness(space), geometric_stiffness(space, stress), 3, guess * unit)
    return found.factor[:3] / unit


@pytest.mark.parametrize("supports", SUPPORTS, ids="-".join)
def test_rings_have_the_factors_of_bessel_functions(supports: tuple[str, str]) -> None:
    """Straight facets for circles: second order, whatever the support."""
    exact = isotropic_factors(INNER, OUTER, supports, MATERIAL.poisson)[:3]
    held = dict(zip(("inner", "outer"), supports, strict=True))
    errors = []
    for nodes in (160, 600):
        sheet = annulus(INNER, OUTER, nodes, grading=0.5)
        found = coefficients(sheet, held, -np.eye(2), exact[2])
        errors.append(np.abs(found / exact - 1.0).max())
    assert errors[1] < 7.5e-3  # of 50 facets to a circle; (facet / radius)^2 / 2
    assert errors[1] < 0.35 * errors[0]  # 160 to 600 vertices: 0.27 of the error


def test_bessel_functions_and_polynomials_agree_on_a_pinned_ring() -> None:
    """The displacement u = -e R of both circles is isotropic compression, N = Y h e / (1 - nu)."""
    strain, thickness, nu = 1e-4, 0.5, 0.31
    grow = (-strain * INNER, -strain * OUTER)
    polynomial = [ring_factors(INNER, OUTER, grow, thickness, nu, waves)[0] for waves in (0, 1, 2)]
    unit = thickness**2 / 12.0 / (1.0 - nu**2) * (1.0 - nu) / strain  # factor of N / D = 1 per mm^2
    exact = isotropic_factors(INNER, OUTER, ("pinned", "pinned"), nu)[[0, 1, 3]]
    assert np.array(polynomial) == pytest.approx(unit * exact, rel=1e-8)  # 24 terms


def test_a_narrow_clamped_ring_is_a_clamped_strip() -> None:
    """4 pi^2 / width^2, the column's, up to about the square of width over radius."""
    exact = isotropic_factors(97.0, 100.0, ("clamped", "clamped"), 0.31)[0]
    assert exact == pytest.approx(4.0 * np.pi**2 / 3.0**2, rel=2.0 * 0.03**2)


def test_a_vanishing_hole_leaves_the_factors_of_the_plate() -> None:
    """Bryan's 4 and 6.25 of the simply supported square; what a free hole changes goes with its area."""
    unit = np.pi**2 / 100.0**2
    held = dict.fromkeys(("left", "right", "bottom", "top"), "pinned")
    stress = np.array([[-1.0, 0.0], [0.0, 0.0]])
    large, small = (
        coefficients(rectangle_with_hole(100.0, 100.0, radius, 300), held, stress, 8.0 * unit)[:2] / unit
        for radius in (2.0, 1.0)
    )
    assert small == pytest.approx([4.0, 6.25], rel=3e-3)
    assert (4.0 - large[0]) / (4.0 - small[0]) == pytest.approx(4.0, rel=0.1)  # a finite element's error
