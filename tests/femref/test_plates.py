"""Classical buckling coefficients k = N b^2 / (pi^2 D) of plates, and the order at which the elements reach them.

Exact: simply supported, uniaxial, (m b / a + a / (m b))^2 (Bryan 1891). The others are asserted to the digits of the
tables (Timoshenko and Gere 1961, chapter 9; Bulson 1970).
"""

from __future__ import annotations

import numpy as np
import pytest

from femref.buckle import smallest_factors
from femref.meshes import rectangle
from femref.plate_matrices import PlateSpace, bending_stiffness, geometric_stiffness
from femref.sheet_mesh import PlateMaterial

UNIAXIAL = np.array([[-1.0, 0.0], [0.0, 0.0]])
SHEAR = np.array([[0.0, 1.0], [1.0, 0.0]])
MATERIAL = PlateMaterial(1000.0, 0.3, 1.0)
SIDE = 100.0


def coefficients(
    element: str, nodes: int, support: str, stress: np.ndarray, length: float = SIDE, count: int = 4
) -> np.ndarray:
    """Buckling coefficients of a plate `length` by SIDE, all edges supported alike, under a homogeneous stress."""
    cells = "rectangles" if element == "bogner-fox-schmit" else "triangles"
    sheet = rectangle(length, SIDE, nodes, cells=cells)
    space = PlateSpace(sheet, MATERIAL, dict.fromkeys(sheet.edges, support), element)
    unit = np.pi**2 * MATERIAL.thickness_mm**2 / (12.0 * (1.0 - MATERIAL.poisson**2) * SIDE**2)
    matrices = bending_stiffness(space), geometric_stiffness(space, stress)
    return smallest_factors(*matrices, count, 12.0 * unit).factor / unit


def test_simply_supported_square_has_the_exact_coefficients() -> None:
    found = coefficients("argyris", 81, "pinned", UNIAXIAL)[:4]
    # quintics on cells of a tenth of the side: the fourth mode has a half-wave of a quarter of it
    assert found == pytest.approx([4.0, 6.25, 100.0 / 9.0, 16.0], rel=2e-6)


@pytest.mark.parametrize(
    ("support", "stress", "published", "digits"),
    [("pinned", SHEAR, 9.325, 5e-4), ("clamped", UNIAXIAL, 10.074, 5e-4), ("clamped", SHEAR, 14.642, 5e-4)],
    ids=["pinned shear", "clamped uniaxial", "clamped shear"],
)
def test_square_plates_have_the_tabulated_coefficients(
    support: str, stress: np.ndarray, published: float, digits: float
) -> None:
    # the tables' last digit; 13 vertices along a side are good to a tenth of that
    assert coefficients("argyris", 169, support, stress)[0] == pytest.approx(published, abs=digits)


def test_elements_agree_with_each_other() -> None:
    """Three elements, one answer: conforming ones from above, Morley from below."""
    triangles = coefficients("argyris", 81, "clamped", SHEAR)[0]
    rectangles = coefficients("bogner-fox-schmit", 289, "clamped", SHEAR)[0]
    morley = coefficients("morley", 1089, "clamped", SHEAR)[0]
    assert triangles < rectangles < triangles * 1.0005  # the error of cubics at h = side / 16 is 1e-4
    assert triangles * 0.97 < morley < triangles  # and of quadratics at h = side / 32 is 2 %


@pytest.mark.parametrize(
    ("element", "nodes", "order"),
    [("argyris", (25, 81), 8), ("bogner-fox-schmit", (25, 81), 4), ("morley", (289, 1089), 2)],
    ids=["argyris", "bogner-fox-schmit", "morley"],
)
def test_factors_converge_at_the_order_of_the_element(
    element: str, nodes: tuple[int, int], order: int
) -> None:
    """Eigenvalues converge at twice the order of the energy norm: 2 (p - 1) for complete polynomials of degree p."""
    sides = []
    for count in nodes:
        cells = "rectangles" if element == "bogner-fox-schmit" else "triangles"
        sides.append(len(np.unique(np.round(rectangle(SIDE, SIDE, count, cells=cells).mesh.p[0], 9))) - 1)
    errors = [abs(coefficients(element, count, "pinned", UNIAXIAL, count=1)[0] - 4.0) for count in nodes]
    measured = np.log(errors[0] / errors[1]) / np.log(sides[1] / sides[0])
    assert measured == pytest.approx(
        order, abs=0.12 * order
    )  # before the limit neighbouring orders still show


@pytest.mark.parametrize(
    ("support", "infinite"), [("pinned", 5.34), ("clamped", 8.98)], ids=["pinned", "clamped"]
)
def test_long_plate_in_shear(support: str, infinite: float) -> None:
    """A plate eight times as long as wide lies above the infinite one by what its ends add, about 4 (b / a)^2."""
    found = coefficients("bogner-fox-schmit", 900, support, SHEAR, length=8.0 * SIDE, count=1)[0]
    assert infinite - 0.005 < found < infinite + 2.0 * 4.0 / 64.0
