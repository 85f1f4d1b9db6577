"""The bending constants: exact for quadratic fields, condensed at free edges, blind to rigid motion."""

from __future__ import annotations

import dataclasses
from functools import lru_cache

import numpy as np
import pytest

from fdsolver import meshes
from fdsolver.curvature import CurvatureConstants, curvature_constants
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from tests import reference
from tests.sample_meshes import inside, sheared, small_meshes

SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=0.5)
MESHES = small_meshes()
QUADRATICS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0, -0.3, 0.6]])
TINY = 1e-30  # amplitude of an imaginary deflection: the response is linear to the last bit

SUPPORTS = {
    "free": {},
    "one clamped": {"left": "clamped", "hole": "clamped", "outer": "clamped"},
    "all clamped": dict.fromkeys(("left", "right", "top", "bottom", "hole", "inner", "outer"), "clamped"),
}


def constants(grid: Grid, supports: str = "free", sheet: Sheet = SHEET) -> CurvatureConstants:
    named = {name: support for name, support in SUPPORTS[supports].items() if name in grid.edges}
    return curvature_constants(grid, sheet, named)


def flat(grid: Grid) -> np.ndarray:
    """The undeformed sheet in space, scaled."""
    return np.pad(grid.u / grid.length_mm, ((0, 0), (0, 0), (0, 1)))


def moduli(grid: Grid, sheet: Sheet = SHEET) -> np.ndarray:
    """D of Eq. 24 for (b11, b22, b12) per Y h L^2."""
    nu = sheet.poisson
    plate = (sheet.thickness_mm / grid.length_mm) ** 2 / (12 * (1 - nu**2))
    return plate * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 2 * (1 - nu)]])


def linear_response(deflection: np.ndarray, grid: Grid, k: CurvatureConstants) -> np.ndarray:
    """(b1, b2, <b12>) of a small deflection (ni, nj) of the flat sheet, by the nonlinear formulas."""
    r = flat(grid).astype(complex)
    r[..., 2] = 1j * TINY * deflection
    b1, b2 = reference.node_curvatures(r, grid, k)
    return np.stack([b1, b2, reference.node_twist(reference.zone_twist(r, grid), grid)]).imag / TINY


def twist_response(deflection: np.ndarray, grid: Grid) -> np.ndarray:
    """b12 of every zone for a small deflection."""
    r = flat(grid).astype(complex)
    r[..., 2] = 1j * TINY * deflection
    return reference.zone_twist(r, grid).imag / TINY


def quadratic(grid: Grid, q: np.ndarray, centre: np.ndarray | None = None) -> np.ndarray:
    """q11 x^2/2 + q22 y^2/2 + q12 x y about a point, scaled."""
    x, y = np.moveaxis(grid.u / grid.length_mm - (0.0 if centre is None else centre), 2, 0)
    return q[0] * x**2 / 2 + q[1] * y**2 / 2 + q[2] * x * y


def measured(grid: Grid, k: CurvatureConstants, i: int, j: int) -> list[int]:
    """Which of (b1, b2, <b12>) enter at a node."""
    ends1, ends2 = not grid.closed and i in (0, grid.ni - 1), j in (0, grid.nj - 1)
    missing = [ends1 and not k.clamped1[i, j], ends2 and not k.clamped2[i, j], False]
    return [row for row in range(3) if not missing[row]]


def node_stiffness(grid: Grid, k: CurvatureConstants, i: int, j: int) -> tuple[np.ndarray, float]:
    """K and Ks at a node, from the response to three fields about it, by matrix algebra."""
    centre = grid.u[i, j] / grid.length_mm
    response = np.stack(
        [linear_response(quadratic(grid, q, centre), grid, k)[:, i, j] for q in np.eye(3)], axis=1
    )
    rows = measured(grid, k, i, j)
    area = grid.node_area[i, j] / grid.length_mm**2
    flexibility = response @ np.linalg.solve(moduli(grid), response.T)
    stiffness = np.zeros((3, 3))
    stiffness[np.ix_(rows, rows)] = area * np.linalg.inv(flexibility[np.ix_(rows, rows)])
    return stiffness, area / flexibility[2, 2]


@lru_cache
def node_twist_shares(name: str) -> np.ndarray:
    """Ks of every node, zero on kinks, (ni, nj)."""
    grid = MESHES[name]
    k = constants(grid)
    shares = [node_stiffness(grid, k, i, j)[1] for i, j in np.ndindex(grid.ni, grid.nj)]
    on_kink = np.any(np.abs(grid.xi[:, None] - np.array(grid.breaks)) < 1e-9, axis=1)
    return np.where(on_kink[:, None], 0.0, np.reshape(shares, (grid.ni, grid.nj)))


@pytest.mark.parametrize("supports", SUPPORTS)
@pytest.mark.parametrize("name", MESHES)
def test_constants_are_those_of_the_measured_response(name: str, supports: str) -> None:
    grid = MESHES[name]
    k = constants(grid, supports)
    shares = np.zeros(grid.u.shape[:2])
    for i, j in np.ndindex(grid.ni, grid.nj):
        stiffness, twist = node_stiffness(grid, k, i, j)
        on_kink = any(abs(grid.xi[i] - value) < 1e-9 for value in grid.breaks)
        shares[i, j] = 0.0 if on_kink else twist * k.twist_weight[i, j]
        rest = stiffness[2, 2] - shares[i, j] / k.twist_weight[i, j]
        expected = [stiffness[0, 0], stiffness[0, 1], stiffness[1, 1], stiffness[0, 2], stiffness[1, 2], rest]
        found = [entry[i, j] for entry in (k.K11, k.K12, k.K22, k.K13, k.K23, k.K33_rest)]
        # inverses of 3 x 3 matrices with condition numbers up to 1e4
        assert found == pytest.approx(expected, rel=0, abs=1e-11 * np.abs(stiffness).max()), f"node {i}, {j}"
    np.testing.assert_allclose(k.C33, sum(reference.zones(shares, grid.closed)), rtol=1e-11)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("q", QUADRATICS, ids=str)
def test_quadratic_fields_have_their_exact_energy_at_every_inner_node(name: str, q: np.ndarray) -> None:
    """Exact but for the spread of the twists of a node's zones, which no combination of means can see."""
    grid = MESHES[name]
    k = constants(grid)
    b1, b2, b3 = linear_response(quadratic(grid, q), grid, k)
    mean_square = reference.node_twist(twist_response(quadratic(grid, q), grid) ** 2, grid)
    energy = k.K11 * b1**2 / 2 + k.K12 * b1 * b2 + k.K22 * b2**2 / 2
    energy += (k.K13 * b1 + k.K23 * b2) * b3 + (k.K33_rest + node_twist_shares(name)) * b3**2 / 2
    exact = grid.node_area / grid.length_mm**2 * (q @ moduli(grid) @ q) / 2
    # rounding of second differences of coordinates, 1e-16 / 1e-3, times the worst condition number of R, 1e3
    np.testing.assert_allclose(energy[inside(grid)], exact[inside(grid)], rtol=1e-9)
    if name in ("uniform", "skewed"):
        np.testing.assert_allclose(mean_square, b3**2, rtol=1e-10, atol=1e-20)


@pytest.mark.parametrize("tangent", [0.0, 0.6])
@pytest.mark.parametrize("q", QUADRATICS, ids=str)
def test_energy_of_a_free_parallelogram(q: np.ndarray, tangent: float) -> None:
    """On equal zones every node has the least energy of the curvatures that it measures, in closed form."""
    grid = sheared(meshes.rectangle(20.0, 12.0, 110), tangent)
    k = constants(grid)
    amplitude = 1e-6  # relative error of the linear limit: its square
    r = flat(grid)
    r[..., 2] = amplitude * quadratic(grid, q)
    first, second = np.array([[1.0, 0.0], np.array([tangent, 1.0]) / np.hypot(tangent, 1.0)])
    projections = [np.outer(first, first), np.outer(second, second), np.outer(first, second)]
    rows = np.array([[p[0, 0], p[1, 1], p[0, 1] + p[1, 0]] for p in projections])  # of unit steps
    expected = 0.0
    for i, j in np.ndindex(grid.ni, grid.nj):
        seen = rows[measured(grid, k, i, j)]
        flexibility = seen @ np.linalg.solve(moduli(grid), seen.T)
        density = (seen @ q) @ np.linalg.solve(flexibility, seen @ q) / 2
        expected += grid.node_area[i, j] / grid.length_mm**2 * density
    energy = reference.bending_energy(r, grid, k) / amplitude**2
    assert energy == pytest.approx(expected, rel=1e-8)


def test_a_free_strip_bends_with_its_beam_stiffness() -> None:
    """Condensed: the long edges carry no moment, so they bend with Y h^3 / 12, not with D."""
    grid = meshes.rectangle(20.0, 12.0, 110)
    k = constants(grid)
    b1 = linear_response(quadratic(grid, np.array([1.0, 0.0, 0.0])), grid, k)[0]
    beam = (SHEET.thickness_mm / grid.length_mm) ** 2 / 12
    density = k.K11 * b1**2 / (grid.node_area / grid.length_mm**2)
    np.testing.assert_allclose(density[1:-1, [0, -1]], beam, rtol=1e-10)
    np.testing.assert_allclose(density[1:-1, 1:-1], beam / (1 - SHEET.poisson**2), rtol=1e-10)


def test_a_strip_that_curls_freely_has_its_beam_energy_throughout() -> None:
    """Anticlastic bending z = (x^2 - nu y^2)/2 has no moment across: Y h^3/24 per area at every node."""
    grid = meshes.rectangle(20.0, 12.0, 110)
    k = constants(grid)
    b1, b2, _ = linear_response(quadratic(grid, np.array([1.0, -SHEET.poisson, 0.0])), grid, k)
    density = (k.K11 * b1**2 / 2 + k.K12 * b1 * b2 + k.K22 * b2**2 / 2) / (grid.node_area / grid.length_mm**2)
    np.testing.assert_allclose(density[1:-1], (SHEET.thickness_mm / grid.length_mm) ** 2 / 24, rtol=1e-10)


@pytest.mark.parametrize("name", ["uniform", "biased", "annulus"])
@pytest.mark.parametrize("supports", ["free", "all clamped"])
def test_no_cross_terms_on_orthogonal_meshes(name: str, supports: str) -> None:
    k = constants(MESHES[name], supports)
    assert k.orthogonal
    assert not (k.K13.any() or k.K23.any() or k.K33_rest.any())
    assert not constants(MESHES["skewed"]).orthogonal


@pytest.mark.parametrize("name", MESHES)
def test_flat_sheets_have_no_bending_energy_however_stretched_and_turned(name: str) -> None:
    grid = MESHES[name]
    k = constants(grid)
    random = np.random.default_rng(5)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    stretch = np.array([[1.3, 0.2, 0.0], [-0.1, 0.8, 0.0], [0.0, 0.0, 1.0]])
    bent = flat(grid)
    bent[..., 2] = 0.1 * quadratic(grid, QUADRATICS[4])
    scale = reference.bending_energy(bent, grid, k)
    # (rounding of coordinates, 1e-16 / bent second differences, 1e-5 in the smallest zones)^2
    assert reference.bending_energy(flat(grid) @ (turn @ stretch).T + 0.3, grid, k) < 1e-22 * scale
    assert reference.bending_energy(bent @ turn.T, grid, k) == pytest.approx(scale, rel=1e-12)


@pytest.mark.parametrize("name", MESHES)
def test_only_rigid_deflections_cost_no_energy(name: str) -> None:
    """All other modes cost energy, the checkerboard more than any smooth one."""
    grid = MESHES[name]
    k = constants(grid)
    units = np.eye(grid.ni * grid.nj).reshape(-1, grid.ni, grid.nj)
    b = np.array([linear_response(unit, grid, k) for unit in units])
    b12 = np.array([twist_response(unit, grid) for unit in units])
    moment = np.array(
        [
            k.K11 * b[:, 0] + k.K12 * b[:, 1] + k.K13 * b[:, 2],
            k.K12 * b[:, 0] + k.K22 * b[:, 1] + k.K23 * b[:, 2],
            k.K13 * b[:, 0] + k.K23 * b[:, 1] + k.K33_rest * b[:, 2],
        ]
    )
    hessian = np.einsum("cnij,mcij->nm", moment, b) + np.einsum("nij,ij,mij->nm", b12, k.C33, b12)
    modes = np.linalg.eigvalsh(hessian)
    assert np.all(np.abs(modes[:3]) < 1e-12 * modes[-1])
    # the softest elastic mode of so few cells is about (cells per side)^-4 of the stiffest
    assert modes[3] > 1e-7 * modes[-1]
    checkerboard = (-1.0) ** np.add.outer(np.arange(grid.ni), np.arange(grid.nj)).ravel()
    assert checkerboard @ hessian @ checkerboard > np.trace(hessian)


@pytest.mark.parametrize("poisson", [-0.9, 0.0, 0.5])
def test_every_admissible_poisson_ratio(poisson: float) -> None:
    sheet = dataclasses.replace(SHEET, poisson=poisson)
    grid = MESHES["skewed"]
    k = constants(grid, sheet=sheet)
    q = QUADRATICS[4]
    b1, b2, b3 = linear_response(quadratic(grid, q), grid, k)
    middle = (grid.ni // 2, grid.nj // 2)
    area = grid.node_area[middle] / grid.length_mm**2
    # the exact moments, projected on the mesh lines, are R^-T D q: compare M . q with twice the energy
    b = np.array([b1[middle], b2[middle], b3[middle]])
    twist = k.C33[middle]  # all corners alike inside: C33 = Ks
    stiffness = np.array(
        [
            [k.K11[middle], k.K12[middle], k.K13[middle]],
            [k.K12[middle], k.K22[middle], k.K23[middle]],
            [k.K13[middle], k.K23[middle], k.K33_rest[middle] + twist],
        ]
    )
    assert b @ stiffness @ b == pytest.approx(area * q @ moduli(grid, sheet) @ q, rel=1e-9)


def test_thickness_and_size_scale_as_a_plate() -> None:
    """Per Y h L^2 a plate's stiffness goes with (h/L)^2 and depends on the shape only."""
    grid = MESHES["hole"]
    thin = constants(grid, sheet=dataclasses.replace(SHEET, thickness_mm=0.1))
    thick = constants(grid, sheet=dataclasses.replace(SHEET, thickness_mm=0.2, young_MPa=1.0))
    large = dataclasses.replace(grid, u=10.0 * grid.u, length_mm=10.0 * grid.length_mm)
    same = constants(large, sheet=dataclasses.replace(SHEET, thickness_mm=1.0))
    for name in ("K11", "K12", "K22", "K13", "K23", "K33_rest", "C33"):
        np.testing.assert_allclose(getattr(thick, name), 4.0 * getattr(thin, name), rtol=1e-12)
        # rounding of 10 u / 10 L, magnified by second differences of coordinates
        scale = np.abs(getattr(thin, name)).max()
        np.testing.assert_allclose(getattr(same, name), getattr(thin, name), rtol=0, atol=1e-10 * scale)


def test_a_mesh_whose_lines_nearly_coincide_is_refused() -> None:
    grid = meshes.rectangle(20.0, 12.0, 110)
    constants(sheared(grid, 1.0 / np.tan(np.radians(2.5))))
    with pytest.raises(ValueError, match=r"node \(\d+, \d+\) is degenerate"):
        constants(sheared(grid, 1.0 / np.tan(np.radians(1.5))))


def test_unknown_edges_and_supports_are_refused() -> None:
    grid = MESHES["annulus"]
    with pytest.raises(ValueError, match="no edge 'left'; the edges are inner, outer"):
        curvature_constants(grid, SHEET, {"left": "clamped"})
    with pytest.raises(ValueError, match="support of 'inner' must be clamped or one of"):
        curvature_constants(grid, SHEET, {"inner": "glued"})


def test_the_normal_is_given_at_a_corner_only_if_both_its_edges_are_clamped() -> None:
    """Where a clamped and a free edge meet on one mesh line, the corner is as free as the free edge."""
    grid = MESHES["hole"]
    one = curvature_constants(grid, SHEET, {"left": "clamped"})
    both = curvature_constants(grid, SHEET, {"left": "clamped", "top": "clamped"})
    corners = [tuple(grid.edges["left"][end]) for end in (0, -1)]
    assert [one.clamped2[at] for at in corners] == [False, False]
    assert np.sum(one.clamped2) == len(grid.edges["left"]) - 2
    assert sorted(both.clamped2[at] for at in corners) == [False, True]
    assert not one.clamped1.any() and not both.clamped1.any()
