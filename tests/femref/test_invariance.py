"""Where a mesh lies, how it is turned and what its unit is must not change a factor."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from femref.buckle import smallest_factors
from femref.meshes import annulus, rectangle
from femref.plate_matrices import PlateSpace, bending_stiffness, geometric_stiffness
from femref.sheet_mesh import Circle, PlateMaterial, SheetMesh

STRESS = np.array([[-1.0, 0.4], [0.4, 0.2]])
MATERIAL = PlateMaterial(1000.0, 0.3, 1.0)


def factor(
    sheet: SheetMesh, supports: dict[str, str], stress: np.ndarray, element: str = "argyris"
) -> np.ndarray:
    space = PlateSpace(sheet, MATERIAL, supports, element)
    matrices = bending_stiffness(space), geometric_stiffness(space, stress)
    return smallest_factors(*matrices, 3, 1e-3).factor[:3]


def moved(sheet: SheetMesh, turn: np.ndarray, shift: tuple[float, float], size: float) -> SheetMesh:
    """The mesh turned, enlarged and shifted in its own coordinates, which then are in units of L / size."""
    p = size * (turn @ sheet.mesh.p) + np.array(shift)[:, None]
    circles = {
        name: Circle(
            (shift[0] + size * circle.centre[0], shift[1] + size * circle.centre[1]), size * circle.radius
        )
        for name, circle in sheet.circles.items()
    }
    mesh = type(sheet.mesh)(p, sheet.mesh.t)
    assert np.array_equal(mesh.facets, sheet.mesh.facets)
    return dataclasses.replace(sheet, mesh=mesh, circles=circles, length_mm=sheet.length_mm / size)


@pytest.mark.parametrize("angle", [0.0, 0.7])
@pytest.mark.parametrize(
    ("shift", "size"), [((100.0, -40.0), 1.0), ((0.0, 0.0), 50.0)], ids=["shifted", "scaled"]
)
@pytest.mark.parametrize("shape", ["rectangle", "annulus"])
def test_place_direction_and_unit_do_not_matter(
    shape: str, shift: tuple[float, float], size: float, angle: float
) -> None:
    sheet = rectangle(130.0, 100.0, 60, grading=0.5) if shape == "rectangle" else annulus(40.0, 100.0, 60)
    supports = (
        {"left": "pinned", "bottom": "clamped"}
        if shape == "rectangle"
        else {"inner": "pinned", "outer": "clamped"}
    )
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    there = factor(moved(sheet, turn, shift, size), supports, turn @ STRESS @ turn.T)
    # a shift of 100 sides costs two digits of the vertices' distances; monomials about the origin lose the answer
    assert there == pytest.approx(factor(sheet, supports, STRESS), rel=1e-9)


def test_rectangles_may_not_be_turned() -> None:
    sheet = rectangle(130.0, 100.0, 60, cells="rectangles")
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    with pytest.raises(ValueError, match="parallel to the axes"):
        factor(moved(sheet, turn, (0.0, 0.0), 1.0), {"left": "pinned"}, STRESS, "bogner-fox-schmit")
