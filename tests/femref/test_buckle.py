"""Factors of whole sheets: against one-dimensional solutions, dense eigenvalues and counts of inertia."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csc_array

from femref import buckle
from femref.buckle import NoBuckling, distance_bounds, factors_below, guess_of, shift_after, smallest_factors
from femref.meshes import annulus, rectangle, rectangle_with_hole
from femref.parity import parities
from femref.plate_matrices import PlateSpace, bending_stiffness, geometric_stiffness
from femref.prestress import PlaneProblem, linear_state
from femref.sheet_mesh import PlateMaterial
from tests.femref.rings import ring_factors

KAPTON = PlateMaterial(3500.0, 0.31, 0.025)
STRESS = np.array([[3.0, 0.5], [0.5, -0.02]])  # strong tension, weak compression: as in a pulled sheet


def small_pencil() -> tuple[csc_array, csc_array, PlateSpace]:
    sheet = rectangle(130.0, 100.0, 50)
    space = PlateSpace(sheet, KAPTON, {"left": "pinned", "right": "clamped"})
    return bending_stiffness(space), geometric_stiffness(space, STRESS), space


def test_matrices_are_symmetric_and_bending_is_positive() -> None:
    bending, geometric, _ = small_pencil()
    for matrix in (bending, geometric):
        assert abs(matrix - matrix.T).max() < 1e-14 * abs(matrix).max()  # rounding of the assembly
    assert np.linalg.eigvalsh(bending.toarray())[0] > 0.0


def test_factors_are_those_of_the_dense_pencil_and_none_is_missing() -> None:
    bending, geometric, space = small_pencil()
    dense = eigh(-geometric.toarray(), bending.toarray(), eigvals_only=True)
    wanted = np.sort(1.0 / dense[dense > 0.0])
    stress = np.broadcast_to(STRESS[:, :, None, None], (2, 2, *space.basis.dx.shape))
    found = smallest_factors(bending, geometric, 8, guess_of(space, stress))
    count = len(found.factor)
    assert count >= 8 and found.certified
    assert found.factor == pytest.approx(wanted[:count], rel=1e-8)
    assert found.residual < 1e-9
    middle = np.sqrt(wanted[4] * wanted[5])
    assert factors_below(bending, geometric, middle) == 5


@pytest.mark.parametrize("wrong", [0.0, 1e-3])
def test_distance_bounds_hold_and_are_sharp_for_a_wrong_factor(wrong: float) -> None:
    """A mode whose factor is 1e-4 off is as far as that from the true one; a wrong mode only widens the bound."""
    bending, geometric, _ = small_pencil()
    dense, modes = eigh(-geometric.toarray(), bending.toarray())
    positive = dense > 0.0
    wanted, modes = 1.0 / dense[positive], modes[:, positive]
    chosen = np.argsort(wanted)[:3]
    shape = modes[:, chosen] + wrong * np.abs(modes[:, chosen]).max() * np.sin(np.arange(len(modes)))[:, None]
    bounds = distance_bounds(bending, geometric, wanted[chosen] * (1.0 + 1e-4), shape)
    if wrong:
        assert (bounds > 1.01e-4).all()
    else:
        assert bounds == pytest.approx(1e-4, rel=1e-6)  # rounding, a hundredth of a millionth of it


def test_distance_bounds_are_measured_by_the_energy_of_bending() -> None:
    """Two modes of factors 1 and 10, a million times apart in stiffness, the first with 1e-5 of the second in it.

    r = K w + f G w = ((1 - f) w1, 1e6 (1 - f / 10) w2), its square in the norm of K^-1 over that of w in K by hand.
    """
    bending, geometric = csc_array(np.diag([1.0, 1e6])), csc_array(np.diag([-1.0, -1e5]))
    factor, shape = np.array([1.0 + 1e-4]), np.array([[1.0], [1e-5]])
    square = (1e-8 + 1e6 * (1e-5 * (1.0 - factor[0] / 10.0)) ** 2) / (1.0 + 1e6 * 1e-10)
    assert distance_bounds(bending, geometric, factor, shape) == pytest.approx(np.sqrt(square), rel=1e-9)


def test_the_residual_is_that_of_the_worst_factor(monkeypatch: pytest.MonkeyPatch) -> None:
    bending, geometric, _ = small_pencil()
    bounds = np.array([1e-9, 7e-9, 2e-9])
    monkeypatch.setattr(buckle, "distance_bounds", lambda *_: bounds)
    assert smallest_factors(bending, geometric, 3, 1e-5).residual == 7e-9


@pytest.mark.parametrize("guess", [1e-12, 1e6])
def test_any_first_guess_finds_them(guess: float) -> None:
    bending, geometric, _ = small_pencil()
    expected = smallest_factors(bending, geometric, 3, 1e-5).factor[:3]
    assert smallest_factors(bending, geometric, 3, guess).factor[:3] == pytest.approx(expected, rel=1e-9)


def test_tension_alone_has_no_factor() -> None:
    _, _, space = small_pencil()
    tension = np.broadcast_to(
        np.array([[1.0, 0.0], [0.0, 0.5]])[:, :, None, None], (2, 2, *space.basis.dx.shape)
    )
    with pytest.raises(NoBuckling, match="nowhere compressed"):
        guess_of(space, tension)


def test_shift_goes_into_the_widest_gap() -> None:
    known = np.array([1.0, 2.0, 2.01, 2.9, 3.0])
    assert 2.01 < shift_after(known, 2) < 2.9
    assert shift_after(known, 5) > 3.0


def ring(nodes: int) -> np.ndarray:
    sheet = annulus(62.5, 250.0, nodes, grading=0.5)
    space = PlateSpace(sheet, KAPTON, {"inner": "pinned", "outer": "pinned"})

    def shrink(position: np.ndarray, load: float) -> np.ndarray:
        return -2.5 * load * position / np.linalg.norm(position, axis=0)

    movements = {"inner": shrink, "outer": lambda position, _: 0.0 * position}
    stress = linear_state(PlaneProblem(sheet, KAPTON, movements, space.points)).stress
    matrices = bending_stiffness(space), geometric_stiffness(space, stress)
    return smallest_factors(*matrices, 6, 7.5e-5).factor[:6]


def test_pinned_ring_buckles_as_its_waves_do_one_by_one() -> None:
    """Straight facets for circles: second order, and no paradox (a polygon pinned along its sides never converges)."""
    wanted = np.repeat(
        [ring_factors(62.5, 250.0, (-2.5, 0.0), 0.025, 0.31, waves)[0] for waves in (6, 7, 8)], 2
    )
    coarse, fine = ring(160), ring(600)
    assert fine == pytest.approx(wanted, rel=0.01)  # 50 facets to a circle
    assert np.abs(fine / wanted - 1.0).max() < 0.4 * np.abs(coarse / wanted - 1.0).max()


def test_modes_have_parities_and_a_double_factor_is_resolved() -> None:
    sheet = rectangle(100.0, 100.0, 81)
    space = PlateSpace(sheet, KAPTON, dict.fromkeys(sheet.edges, "pinned"))
    matrices = bending_stiffness(space), geometric_stiffness(space, -np.eye(2))
    found = smallest_factors(*matrices, 3, 6e-8)
    modes = space.vertex_heights(found.shape)
    result = parities(sheet.mesh, found.factor, modes)
    # modes (1,1); (1,2) and (2,1), a double factor
    assert found.factor[2] / found.factor[1] == pytest.approx(1.0, abs=1e-9)
    assert result.clear() == "mirror_x"
    assert sorted(np.round(result.correlation["mirror_x"][1:3]).tolist()) == [-1.0, 1.0]
    assert np.abs(np.abs(result.correlation["mirror_x"][:3]) - 1.0).max() < 1e-9


@pytest.mark.parametrize(
    "sheet",
    [
        rectangle(40.0, 100.0, 300, grading=0.7, aspect=2.0),
        annulus(62.5, 250.0, 300),
        rectangle_with_hole(50.0, 125.0, 15.0, 400),
    ],
    ids=["rectangle", "annulus", "hole"],
)
def test_meshes_cover_the_sheet_and_map_onto_themselves(sheet) -> None:
    x, y = sheet.positions_mm[sheet.cells].transpose(2, 0, 1)
    area = 0.5 * ((x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0]))
    assert area.min() > 0.0
    sectors = {name: len(facets) for name, facets in sheet.edges.items()}
    exact = {
        "rectangle": lambda: 4000.0,
        "annulus": lambda: (
            0.5 * sectors["inner"] * np.sin(2 * np.pi / sectors["inner"]) * (250.0**2 - 62.5**2)
        ),
    }
    if "hole" in sheet.edges:
        hole = sheet.positions_mm[np.unique(sheet.mesh.facets[:, sheet.edges["hole"]])]
        assert np.linalg.norm(hole, axis=1) == pytest.approx(15.0, rel=1e-12)
        assert 6250.0 - np.pi * 15.0**2 < area.sum() < (6250.0 - np.pi * 15.0**2) * 1.003
    else:
        assert area.sum() == pytest.approx(
            exact["annulus" if "inner" in sheet.edges else "rectangle"](), rel=1e-12
        )
    boundary = np.sort(np.concatenate(list(sheet.edges.values())))
    assert np.array_equal(boundary, np.sort(sheet.mesh.boundary_facets()))
    modes = np.ones((sheet.mesh.nvertices, 1))
    assert set(parities(sheet.mesh, np.ones(1), modes).correlation) == {"mirror_x", "mirror_y", "half_turn"}
    ordered = {tuple(sorted(cell)) for cell in sheet.mesh.t.T.tolist()}
    from scipy.spatial import cKDTree

    image = cKDTree(sheet.mesh.p.T).query((sheet.mesh.p * [[-1.0], [1.0]]).T)[1]
    assert {tuple(sorted(cell)) for cell in image[sheet.mesh.t].T.tolist()} == ordered


def test_a_pinned_circle_allows_what_vanishes_on_the_circle() -> None:
    """w = r^2 - R^2 is zero on the circle, not on its facets: its value and derivatives at the vertices stay free."""
    sheet = annulus(62.5, 250.0, 100)
    space = PlateSpace(sheet, KAPTON, {"outer": "pinned"})
    x, y = sheet.mesh.p
    one, zero = np.ones_like(x), np.zeros_like(x)
    wanted = np.zeros(space.basis.N)
    wanted[space.basis.dofs.nodal_dofs] = [x * x + y * y - 1.0, 2 * x, 2 * y, 2 * one, zero, 2 * one]
    kept = space.free @ (space.free.T @ wanted)
    assert np.abs(kept - wanted).max() < 1e-12  # a projection onto orthonormal columns, to rounding
