"""Plane prestress: homogeneous states exactly, reactions in balance with the energy, Newton's tangent."""

from __future__ import annotations

import numpy as np
import pytest

from femref.meshes import annulus, rectangle
from femref.plate_matrices import PlateSpace
from femref.prestress import Movement, PlaneProblem, finite_state, linear_state
from femref.sheet_mesh import PlateMaterial, SheetMesh

WIDTH, HEIGHT = 40.0, 100.0
RUBBER = PlateMaterial(2.0, 0.5, 0.1)


def problem(sheet: SheetMesh, material: PlateMaterial, movements: dict[str, Movement]) -> PlaneProblem:
    space = PlateSpace(sheet, material, {}, "argyris" if sheet.mesh.t.shape[0] == 3 else "bogner-fox-schmit")
    return PlaneProblem(sheet, material, movements, space.points)


def pull(by: float) -> dict[str, Movement]:
    def top(position: np.ndarray, load: float) -> np.ndarray:
        return np.stack([0.0 * position[0], np.full_like(position[0], load * by)])

    return {"bottom": lambda position, _: 0.0 * position, "top": top}


def affine(matrix: np.ndarray) -> Movement:
    return lambda position, load: load * (matrix @ position)


@pytest.mark.parametrize("cells", ["triangles", "rectangles"])
def test_linear_pull_without_hindrance_is_homogeneous(cells: str) -> None:
    material = PlateMaterial(2.0, 0.0, 0.1)  # Poisson's ratio 0: the held edges hinder nothing
    found = linear_state(problem(rectangle(WIDTH, HEIGHT, 60, cells=cells), material, pull(3.0)))
    wanted = np.zeros_like(found.stress)
    wanted[1, 1] = 0.03
    assert np.abs(found.stress - wanted).max() < 1e-13  # rounding
    force = 2.0 * 0.1 * WIDTH * 0.03
    assert found.reaction_N["top"] == pytest.approx((0.0, force, 0.0), abs=1e-12)
    assert found.reaction_N["bottom"] == pytest.approx((0.0, -force, 0.0), abs=1e-12)
    assert found.energy_N_mm == pytest.approx(0.5 * force * 3.0, rel=1e-12)


@pytest.mark.parametrize("cells", ["triangles", "rectangles"])
def test_finite_affine_edges_give_the_affine_state(cells: str) -> None:
    """All edges moved by one matrix: F is that matrix, S follows from the law by hand."""
    matrix = np.array([[0.08, 0.2], [-0.05, 0.3]])
    sheet = rectangle(WIDTH, HEIGHT, 60, cells=cells)
    found = finite_state(problem(sheet, RUBBER, dict.fromkeys(sheet.edges, affine(matrix))))
    deformation = np.eye(2) + matrix
    strain = 0.5 * (deformation.T @ deformation - np.eye(2))
    stress = (0.5 * np.trace(strain) * np.eye(2) + 0.5 * strain) / 0.75  # nu = 1/2: c = 2/3, 2 mu = 2/3 of Y
    assert np.abs(found.stress - stress[:, :, None, None]).max() < 1e-12
    assert found.displacement_mm == pytest.approx(sheet.positions_mm @ matrix.T, abs=1e-11)
    area = WIDTH * HEIGHT * 0.1 * 2.0
    assert found.energy_N_mm == pytest.approx(0.5 * area * (stress * strain).sum(), rel=1e-12)


@pytest.mark.parametrize("finite", [False, True], ids=["linear", "finite"])
def test_the_pull_is_the_derivative_of_the_energy(finite: bool) -> None:
    """Clapeyron and virtual work: the displacement-driven reaction, not an integral of edge stresses."""
    plane = problem(rectangle(WIDTH, HEIGHT, 80, grading=0.5), RUBBER, pull(20.0))
    solve = finite_state if finite else linear_state
    step = 1e-4
    energies = [solve(plane, 1.0 + k * step).energy_N_mm for k in (-1, 1)]
    found = solve(plane, 1.0)
    work = (energies[1] - energies[0]) / (2.0 * step)
    assert found.reaction_N["top"][1] * 20.0 == pytest.approx(work, rel=1e-7)  # central differences: step^2
    total = np.sum(list(found.reaction_N.values()), axis=0)
    assert np.abs(total).max() < 1e-10 * found.reaction_N["top"][1] * HEIGHT


def test_linear_state_is_the_limit_of_small_finite_ones() -> None:
    plane = problem(rectangle(WIDTH, HEIGHT, 100), RUBBER, pull(20.0))
    small = 1e-6
    finite, linear = finite_state(plane, small), linear_state(plane, small)
    # they part by the square of the strain, 2e-7, relative to it
    assert np.abs(finite.stress - linear.stress).max() < 1e-5 * np.abs(linear.stress).max()


@pytest.mark.parametrize("farther", [1e-4, 1e-3, 1e-2])
def test_a_state_does_not_depend_on_the_near_one_that_it_started_from(farther: float) -> None:
    """What a well converged neighbour leaves as a force is rounding; Newton's steps must not be measured by it."""
    plane = problem(rectangle(WIDTH, HEIGHT, 100, grading=0.5), RUBBER, pull(10.0))
    near = finite_state(plane, 1.0, finite_state(plane, 1.0).unknowns)
    from_near, cold = (finite_state(plane, 1.0 + farther, start) for start in (near.unknowns, None))
    # forces of 1e-12 of Y; compression in a wrinkling sheet is a thousandth of its tension
    assert np.abs(from_near.stress - cold.stress).max() < 1e-9 * np.abs(cold.stress).max()


def test_turning_a_sheet_strains_nothing() -> None:
    angle = 1.1
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) - np.eye(2)
    sheet = rectangle(WIDTH, HEIGHT, 60)
    edges = dict.fromkeys(("bottom", "top"), affine(turn))
    found = finite_state(problem(sheet, RUBBER, edges))
    assert np.abs(found.stress).max() < 1e-12


def test_ring_under_radial_displacement_has_lames_stresses() -> None:
    inner, outer, grow = 62.5, 250.0, -2.5
    material = PlateMaterial(3500.0, 0.31, 0.025)
    errors = []
    for nodes in (120, 480):
        sheet = annulus(inner, outer, nodes)

        def shrink(position: np.ndarray, load: float) -> np.ndarray:
            return load * grow * position / np.linalg.norm(position, axis=0)

        found = linear_state(
            problem(sheet, material, {"inner": shrink, "outer": lambda position, _: 0.0 * position})
        )
        a, b = np.linalg.solve([[inner, 1 / inner], [outer, 1 / outer]], [grow, 0.0])
        radius = np.linalg.norm(sheet.positions_mm, axis=1)
        wanted = a * radius + b / radius
        radial = (sheet.positions_mm * found.displacement_mm).sum(axis=1) / radius
        errors.append(np.abs(radial - wanted).max())
        moment = found.reaction_N["inner"][2]
        assert abs(moment) < 1e-9 * 3500.0 * 0.025 * outer  # no torque without a turn
    assert errors[1] < 0.35 * errors[0] < 0.35 * 0.01 * 2.5  # a polygon for a circle: second order


@pytest.mark.parametrize("load", [0.0, 0.8])
def test_newtons_tangent_is_the_derivative_of_the_force(load: float) -> None:
    from femref.prestress import _force_and_tangent

    plane = problem(rectangle(WIDTH, HEIGHT, 20), RUBBER, pull(30.0))
    generator = np.random.default_rng(1)
    state = plane.given(load) + 0.01 * generator.standard_normal(plane.basis.N)
    direction = generator.standard_normal(plane.basis.N)
    step = 0.01
    at = {k: _force_and_tangent(plane, state + k * step * direction)[0] for k in (-2, -1, 1, 2)}
    difference = (8.0 * (at[1] - at[-1]) - (at[2] - at[-2])) / (12.0 * step)
    exact = _force_and_tangent(plane, state)[1] @ direction
    # the force is cubic in the displacements, for which this difference is exact: rounding over the step remains
    assert np.abs(difference - exact).max() < 1e-11 * np.abs(exact).max()
