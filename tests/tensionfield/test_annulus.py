"""The exact annulus: two methods, the closed form, reactions, units and refusals."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from tensionfield.annulus import AnnulusProblem, AnnulusSolution, wrinkled_stretch
from tests.tensionfield.annulus_scenes import PAPER, SCENES, annulus, bands, solved

METHODS = ("shooting", "collocation")
# Both methods hold 12 digits of the outer radius; their results differ by sums of roundings below this.
AGREEMENT = 1e-11


@pytest.mark.parametrize("name", SCENES)
def test_both_methods_agree_and_find_the_states(name: str) -> None:
    problem, states = SCENES[name]
    shot, collocated = (solved(problem, method) for method in METHODS)
    assert shot.states == collocated.states == states
    size = problem.outer_radius_mm
    assert shot.switch_radii_mm == pytest.approx(collocated.switch_radii_mm, rel=0.0, abs=AGREEMENT * size)
    assert shot.energy_N_mm == pytest.approx(collocated.energy_N_mm, rel=AGREEMENT)
    stiffness = 2.0 * math.pi * problem.young_MPa * problem.thickness_mm * size
    major = shot.stretches(size)[0] - 1.0  # forces are compared with that of the sheet's own strain
    assert abs(shot.axial_force_N - collocated.axial_force_N) <= AGREEMENT * stiffness * major
    assert abs(shot.torque_N_mm - collocated.torque_N_mm) <= AGREEMENT * stiffness * size * major
    radii = np.linspace(problem.inner_radius_mm, size, 173)
    for unit, one, other in zip(
        (size, 1.0, size), shot.position(radii), collocated.position(radii), strict=True
    ):
        assert np.max(np.abs(one - other)) <= AGREEMENT * unit
    for one, other in zip(shot.stretches(radii), collocated.stretches(radii), strict=True):
        assert np.max(np.abs(one - other)) <= AGREEMENT


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", SCENES)
def test_rims_are_where_the_problem_puts_them(name: str, method: str) -> None:
    problem, _ = SCENES[name]
    solution = solved(problem, method)
    r, phi, z = solution.position([problem.inner_radius_mm, problem.outer_radius_mm])
    grown = (
        problem.inner_radius_mm + problem.inner_grow_mm,
        problem.outer_radius_mm + problem.outer_grow_mm,
    )
    assert r == pytest.approx(grown, rel=1e-12)
    assert phi == pytest.approx([math.radians(problem.twist_deg), 0.0], rel=1e-12, abs=1e-12)
    assert z == pytest.approx([problem.lift_mm, 0.0], rel=1e-12, abs=1e-12 * problem.outer_radius_mm)


@pytest.mark.parametrize("method", METHODS)
def test_the_papers_annulus_is_tense_beside_both_rims(method: str) -> None:
    solution = solved(PAPER, method)
    assert solution.states == (2, 1, 2)
    # the digits on which the two methods agree
    assert solution.switch_radii_mm == pytest.approx((70.47311933279, 144.899579732), rel=1e-11)
    assert solution.C_mm == pytest.approx(163.85076546002, rel=1e-12)
    assert solution.t_mm == pytest.approx(-48.17664780241, rel=1e-12)
    assert solution.torque_N_mm == pytest.approx(4339832.560695, rel=1e-12)
    assert solution.axial_force_N == pytest.approx(37307.56107647, rel=1e-12)
    assert solution.energy_N_mm == pytest.approx(4089122.714224, rel=1e-12)
    assert solution.warnings == ()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", [name for name, (_, states) in SCENES.items() if 1 in states])
def test_the_closed_form_holds_in_the_innermost_wrinkled_band(name: str, method: str) -> None:
    problem, states = SCENES[name]
    solution = solved(problem, method)
    low, high, _ = bands(solution)[states.index(1)]
    radii = np.linspace(low, high, 50)[1:-1]
    stretch, constant, lever = solution.stretches(radii)[0], solution.C_mm, solution.t_mm
    assert constant is not None and lever is not None
    force = stretch * (stretch**2 - 1.0) / 2.0
    # the strain is a difference of numbers near 1, so f has the rounding of 1 over the strain
    rounding = 1e-12 / np.min(stretch - 1.0)
    assert constant**2 / force**2 + lever**2 / stretch**2 == pytest.approx(radii**2, rel=max(rounding, 1e-11))
    assert wrinkled_stretch(radii, constant, lever) == pytest.approx(stretch, rel=1e-11)


@pytest.mark.parametrize("name", [name for name, (_, states) in SCENES.items() if 1 in states])
def test_reactions_follow_from_the_two_constants(name: str) -> None:
    problem, states = SCENES[name]
    solution = solved(problem)
    constant, lever = solution.C_mm, solution.t_mm
    assert constant is not None and lever is not None
    stiffness = 2.0 * math.pi * problem.thickness_mm * problem.young_MPa
    assert solution.torque_N_mm == pytest.approx(-stiffness * constant * lever, rel=1e-12)
    # m_z from the slope of the straight tension line: the chord between two points of the band, along the line
    low, high, _ = bands(solution)[states.index(1)]
    start, end = (_tension_line(solution, low, radius) for radius in (low, high))
    m_z = (end - start)[2] / np.linalg.norm(end - start)
    assert solution.axial_force_N == pytest.approx(
        -stiffness * constant * m_z, rel=1e-9, abs=1e-9 * stiffness
    )


@pytest.mark.parametrize("name", ["paper", "large twist", "shrink", "nu 0", "lift, outer rim shrunk"])
def test_tension_lines_are_straight_after_deformation(name: str) -> None:
    problem, states = SCENES[name]
    solution = solved(problem)
    low, high, _ = bands(solution)[states.index(1)]
    points = np.array([_tension_line(solution, low, radius) for radius in np.linspace(low, high, 7)])
    chord = (points[-1] - points[0]) / np.linalg.norm(points[-1] - points[0])
    across = points - points[0]
    across -= np.outer(across @ chord, chord)
    # the quadrature of the line's angle has 40 points: its error is below rounding
    assert np.max(np.abs(across)) <= 1e-10 * problem.outer_radius_mm


def _tension_line(solution: AnnulusSolution, low: float, radius: float) -> np.ndarray:
    """Position (mm) at `radius` of the tension line that starts at `low` and the angle zero.

    In the reference its angle grows by tan(alpha) / R, with sin(alpha) = t / (R l).
    """
    node, weight = np.polynomial.legendre.leggauss(40)
    radii = low + 0.5 * (radius - low) * (node + 1.0)
    sine = solution.t_mm / (radii * solution.stretches(radii)[0])
    angle = 0.5 * (radius - low) * float(weight @ (sine / np.sqrt(1.0 - sine**2) / radii))
    r, phi, z = (float(value) for value in solution.position(radius))
    return np.array([r * math.cos(phi + angle), r * math.sin(phi + angle), z])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["paper", "everything", "nu 0", "lift, outer rim shrunk"])
def test_reactions_are_derivatives_of_the_energy(name: str, method: str) -> None:
    problem, _ = SCENES[name]
    solution = solved(problem, method)
    radians = 180.0 / math.pi
    for key, step, reaction in (
        ("lift_mm", 4.0, solution.axial_force_N),
        ("twist_deg", 1.0, solution.torque_N_mm / radians),
    ):
        changes = []
        for part in (1.0, 0.5, 0.25):
            low, high = (
                solved(
                    dataclasses.replace(problem, **{key: getattr(problem, key) + sign * part * step}), method
                )
                for sign in (-1.0, 1.0)
            )
            changes.append((high.energy_N_mm - low.energy_N_mm) / (2.0 * part * step))
        fourth = [(4.0 * fine - coarse) / 3.0 for coarse, fine in zip(changes[:-1], changes[1:], strict=True)]
        sixth = (16.0 * fourth[1] - fourth[0]) / 15.0
        # the last correction of the extrapolation bounds its error; the floor is rounding over the smallest step
        error = abs(sixth - fourth[1]) + 1e-11 * solution.energy_N_mm / step
        assert error <= 1e-6 * max(abs(reaction), solution.energy_N_mm / 100.0)
        assert abs(sixth - reaction) <= error


@pytest.mark.parametrize("method", METHODS)
def test_a_mirrored_load_mirrors_the_answer(method: str) -> None:
    one = solved(PAPER, method)
    other = solved(dataclasses.replace(PAPER, lift_mm=-125.0, twist_deg=-90.0), method)
    assert other.torque_N_mm == pytest.approx(-one.torque_N_mm, rel=1e-12)
    assert other.axial_force_N == pytest.approx(-one.axial_force_N, rel=1e-12)
    assert other.t_mm == pytest.approx(-one.t_mm, rel=1e-12)
    assert one.torque_N_mm > 0.0 and one.axial_force_N > 0.0 and one.t_mm < 0.0


@pytest.mark.parametrize("method", METHODS)
def test_units_scale(method: str) -> None:
    one = solved(PAPER, method)
    other = solved(AnnulusProblem(0.625, 2.5, 70.0, 0.31, 0.01, 1.25, 90.0), method)
    stress, thickness, size = 70.0 / 3500.0, 0.01 / 0.025, 0.01
    assert other.energy_N_mm == pytest.approx(one.energy_N_mm * stress * thickness * size**2, rel=1e-12)
    assert other.torque_N_mm == pytest.approx(one.torque_N_mm * stress * thickness * size**2, rel=1e-12)
    assert other.axial_force_N == pytest.approx(one.axial_force_N * stress * thickness * size, rel=1e-12)
    assert other.C_mm == pytest.approx(size * one.C_mm, rel=1e-12)
    assert other.switch_radii_mm == pytest.approx(
        [size * radius for radius in one.switch_radii_mm], rel=1e-11
    )
    assert other.stresses(1.0)[0] == pytest.approx(stress * one.stresses(100.0)[0], rel=1e-11)


def test_a_sheet_without_wrinkles_has_no_constants() -> None:
    solution = solved(annulus(lift=125.0))
    assert solution.states == (2,) and solution.switch_radii_mm == ()
    assert solution.C_mm is None and solution.t_mm is None
    assert solution.torque_N_mm == 0.0


def test_results_have_the_shape_of_the_radii() -> None:
    solution = solved(PAPER)
    for shape in ((), (0,), (3,), (2, 3)):
        radii = np.full(shape, 100.0)
        results = (
            *solution.position(radii),
            *solution.stretches(radii),
            *solution.stresses(radii),
            solution.state(radii),
        )
        assert all(np.shape(result) == shape for result in results)
    with pytest.raises(ValueError, match="between the rims"):
        solution.stretches([62.0, 100.0])
    with pytest.raises(ValueError, match="between the rims"):
        solution.position(float("nan"))
