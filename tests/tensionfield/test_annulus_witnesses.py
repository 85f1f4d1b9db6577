"""The exact annulus against witnesses that share none of its equations: the energy written down in Cartesian
coordinates, a minimisation on fine grids, and classical small-strain solutions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from tensionfield.annulus import AnnulusSolution
from tensionfield.annulus_energy import energy as relaxed_energy
from tensionfield.annulus_energy import force_and_tangent, zone_state
from tensionfield.annulus_momenta import Momenta
from tensionfield.annulus_problem import scaled
from tensionfield.annulus_start import coarse_annulus, element_lines
from tests.tensionfield.annulus_scenes import SCENES, annulus, bands, density, interpolated, solved

METHODS = ("shooting", "collocation")
COMPLEX = 1e-30  # step of complex-step derivatives: no difference is taken, so no digits are lost


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", SCENES)
def test_fields_are_in_equilibrium(name: str, method: str) -> None:
    """Momenta of the independent energy: constant torque and axial force, balanced and continuous radial force."""
    problem, _ = SCENES[name]
    solution = solved(problem, method)
    parts = [part for band in bands(solution) if (part := _momenta(solution, *band)) is not None]
    stiffness = 2.0 * math.pi * problem.young_MPa * problem.thickness_mm
    for part in parts:
        assert np.max(np.abs(part.balance)) <= part.tolerance
        assert np.max(np.abs(stiffness * part.axial + solution.axial_force_N)) <= stiffness * part.tolerance
        torque_tolerance = stiffness * part.tolerance * problem.outer_radius_mm
        assert np.max(np.abs(stiffness * part.torque + solution.torque_N_mm)) <= torque_tolerance
    for inner, outer in zip(parts[:-1], parts[1:], strict=True):
        assert abs(outer.first - inner.last) <= inner.tolerance + outer.tolerance


@dataclass(frozen=True)
class _BandMomenta:
    """Momenta over Y h of one band: the radial ones at its ends, R P_z (mm) and R r P_phi (mm^2) everywhere.

    balance : errors of the radial balance over parts of the band, mm.
    tolerance : what rounding of the interpolated slopes can make of them, mm.
    """

    first: float
    last: float
    axial: np.ndarray
    torque: np.ndarray
    balance: np.ndarray
    tolerance: float


def _momenta(solution: AnnulusSolution, low: float, high: float, state: int) -> _BandMomenta | None:
    """Return the momenta of one band; None where it is too narrow to be interpolated."""
    size, nu = solution.problem.outer_radius_mm, solution.problem.poisson
    if high - low < 1e-3 * size:
        return None
    edges = np.geomspace(low, high, max(1, math.ceil(math.log(high / low) / math.log(1.2))) + 1)
    node, weight = np.polynomial.legendre.leggauss(24)
    rows, balance = [], []
    for left, right in zip(edges[:-1], edges[1:], strict=True):
        radii = 0.5 * (left + right) + 0.5 * (right - left) * np.array([-1.0, *node, 1.0])
        fields = interpolated(solution, left, right)
        slopes, r = np.array([field.deriv()(radii) for field in fields]), fields[0](radii)
        by_slope = [
            density(slopes + 1j * COMPLEX * unit[:, None], r, radii, nu, state == 2).imag / COMPLEX
            for unit in np.eye(3)
        ]
        by_r = density(slopes, r + 1j * COMPLEX, radii, nu, state == 2).imag / COMPLEX
        rows.append(radii * np.array(by_slope))
        balance.append(
            rows[-1][0, -1] - rows[-1][0, 0] - 0.5 * (right - left) * float(weight @ (radii * by_r)[1:-1])
        )
    p, torque, axial = np.concatenate(rows, axis=1)
    # a slope of degree n loses n^2 = 400 roundings of the positions over the width, and the strain as much; the
    # positions themselves are wrong by the agreement of the two methods, some 1e-14 of the size
    slope_error = 400.0 * 1e-14 * size / min(np.diff(edges))
    stretch = np.max(solution.stretches(edges)[0])  # the force f(l) has the slope 3 l^2 / 2
    return _BandMomenta(p[0], p[-1], axial, torque, np.array(balance), 2.0 * stretch**2 * slope_error * high)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["paper", "lift", "twist", "shrink", "nu -0.5", "everything"])
def test_energy_is_the_integral_of_an_independent_density(name: str, method: str) -> None:
    problem, _ = SCENES[name]
    solution = solved(problem, method)
    total = 0.0
    for low, high, state in bands(solution):
        for left, right in zip(*(lambda e: (e[:-1], e[1:]))(np.geomspace(low, high, 6)), strict=True):
            fields = interpolated(solution, left, right)
            node, weight = np.polynomial.legendre.leggauss(24)
            radii = 0.5 * (left + right) + 0.5 * (right - left) * node
            slopes = np.array([field.deriv()(radii) for field in fields])
            values = density(slopes, fields[0](radii), radii, problem.poisson, state == 2)
            total += 0.5 * (right - left) * float(weight @ (radii * values))
    total *= 2.0 * math.pi * problem.young_MPa * problem.thickness_mm
    assert solution.energy_N_mm == pytest.approx(total, rel=1e-10)


@pytest.mark.parametrize("name", ["paper", "lift", "twist", "shrink", "nu -0.5"])
def test_minimisation_on_fine_grids_extrapolates_to_the_same_energy(name: str) -> None:
    problem, _ = SCENES[name]
    exact = solved(problem)
    stiffness = 2.0 * math.pi * problem.young_MPa * problem.thickness_mm * problem.outer_radius_mm**2
    coarse, middle, fine = (
        stiffness * coarse_annulus(scaled(problem), elements).energy for elements in (250, 500, 1000)
    )
    order = math.log2((coarse - exact.energy_N_mm) / (middle - exact.energy_N_mm))
    assert order == pytest.approx(2.0, abs=0.02)  # midpoint rule and linear elements
    extrapolated = fine + (fine - middle) / 3.0
    # the next term falls by sixteen; a kink of the modulus at a switch inside an element leaves a third-order one
    assert exact.energy_N_mm == pytest.approx(extrapolated, rel=2e-8)


def test_the_coarse_start_is_a_stationary_point_of_its_own_energy() -> None:
    problem = scaled(SCENES["paper"][0])
    coarse = coarse_annulus(problem, 40)
    change = np.sin(np.pi * np.outer(np.linspace(0.0, 1.0, 41), [1.0, 2.0, 3.0]))

    def discrete(step: float) -> float:
        line = element_lines(coarse.radius, coarse.field + step * change)
        values = relaxed_energy(line, problem.poisson, zone_state(line, problem.poisson))
        return float(values @ np.diff(coarse.radius**2) / 2.0)

    assert coarse.at_rest and discrete(0.0) == coarse.energy
    slope = (discrete(1e-6) - discrete(-1e-6)) / 2e-6
    assert abs(slope) < 1e-8  # rounding of the energy over the step is 1e-11


@pytest.mark.parametrize("name", [name for name, (_, states) in SCENES.items() if len(states) > 1])
def test_states_meet_where_the_minor_stress_vanishes(name: str) -> None:
    problem, states = SCENES[name]
    solution = solved(problem, "collocation")
    for radius in solution.switch_radii_mm:
        step = 1e-4 * min(high - low for low, high, _ in bands(solution))
        sides = np.array([radius - step, radius + step])
        major, minor = (0.5 * (stretch**2 - 1.0) for stretch in solution.stretches(sides))
        state = solution.state(sides)
        assert sorted(state) == [1, 2]
        switch = minor + problem.poisson * major
        assert switch[state == 2] > 0.0 > switch[state == 1]
        # continuous, and so small beside the switch; the largest strain is below 4 in all scenes
        assert np.max(np.abs(switch)) <= 1e-2
        major_stress, minor_stress = solution.stresses(sides)
        assert minor_stress[state == 1] == 0.0 < minor_stress[state == 2] <= 1e-2 * problem.young_MPa
        assert np.all(major_stress > 0.0)


def test_poissons_ratio_does_not_matter_where_everything_is_wrinkled() -> None:
    one, other = (solved(annulus(poisson=nu, lift=125.0, twist=90.0)) for nu in (-0.5, -0.7))
    assert one.states == other.states == (1,)
    assert one.energy_N_mm == pytest.approx(other.energy_N_mm, rel=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_a_radial_wrinkled_band_is_a_bundle_of_threads(method: str) -> None:
    """Without a twist the tension lines are radial: R f(l) = C with t = 0, and they shorten by their stretch."""
    solution = solved(annulus(grow=(-40.0, 0.0)), method)
    assert solution.t_mm == 0.0
    radii = np.linspace(62.5, solution.switch_radii_mm[0], 40)
    major = solution.stretches(radii)[0]
    assert radii * major * (major**2 - 1.0) / 2.0 == pytest.approx(np.full(40, solution.C_mm), rel=1e-10)
    node, weight = np.polynomial.legendre.leggauss(40)
    half = 0.5 * (radii[-1] - radii[0])
    length = half * float(weight @ solution.stretches(radii[0] + half * (node + 1.0))[0])
    r = solution.position(radii)[0]
    assert r[-1] - r[0] == pytest.approx(length, rel=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_small_stretch_is_lames_solution(method: str) -> None:
    """Plane-stress annulus with a fixed inner and a moved outer rim; the difference falls with the load."""
    inner, outer, nu, young = 62.5, 250.0, 0.31, 3500.0
    differences = []
    for grow in (1e-2, 1e-3):
        solution = solved(annulus(grow=(0.0, grow)), method)
        slope = grow / (outer - inner**2 / outer)  # u = slope (R - inner^2 / R)
        radii = np.linspace(inner, outer, 9)
        radial, hoop = slope * (1.0 + inner**2 / radii**2), slope * (1.0 - inner**2 / radii**2)
        expected = young / (1.0 - nu**2) * (radial + nu * hoop)
        differences.append(np.max(np.abs(solution.stresses(radii)[0] / expected - 1.0)))
    assert differences[0] < 20.0 * 1e-2 / outer  # a few strains
    assert differences[1] == pytest.approx(0.1 * differences[0], rel=0.01)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("lift", [4.0, 125.0, -400.0])
def test_lift_at_a_third_is_schwerins_membrane(lift: float, method: str) -> None:
    """For nu = 1/3 the radii stay, r = R, and z' falls as R^(-1/3): Schwerin's solution of 1929, here of any size.

    With r = R the hoop strain is zero, so S22 = nu S11; (R S11)' = S22 gives S11 ~ R^(nu - 1), and S11 ~ z'^2 with
    R S11 z' = const gives S11 ~ R^(-2/3). Both agree for nu = 1/3.
    """
    solution = solved(annulus(poisson=1.0 / 3.0, lift=lift), method)
    radii = np.linspace(62.5, 250.0, 41)
    r, phi, z = solution.position(radii)
    inner, outer = 62.5 ** (2.0 / 3.0), 250.0 ** (2.0 / 3.0)
    assert r == pytest.approx(radii, rel=1e-12)
    assert np.all(phi == 0.0)
    assert z == pytest.approx(
        lift * (outer - radii ** (2.0 / 3.0)) / (outer - inner), abs=1e-12 * (250.0 + abs(lift))
    )
    slope = -2.0 / 3.0 * lift * radii ** (-1.0 / 3.0) / (outer - inner)
    major, minor = solution.stresses(radii)
    # strains are differences of numbers near 1
    assert major == pytest.approx(3500.0 / (1.0 - 1.0 / 9.0) * slope**2 / 2.0, rel=1e-10, abs=3500.0 * 1e-14)
    assert minor == pytest.approx(major / 3.0, rel=1e-10, abs=3500.0 * 1e-14)


@pytest.mark.parametrize("tense", [False, True])
def test_energy_derivatives_and_their_inverse(tense: bool) -> None:
    """Force and tangent against complex steps of the independent energy; the momenta lead back to the line."""
    rng = np.random.default_rng(5)
    nu, branch, radius = 0.31, 2 if tense else 1, 0.7
    hoop = rng.uniform(1.02, 1.2, 20) if tense else rng.uniform(0.6, 0.8, 20)
    line = np.column_stack(
        [rng.uniform(0.9, 1.5, 20), rng.uniform(-0.4, 0.4, 20), rng.uniform(-0.9, -0.4, 20), hoop]
    )
    force, tangent = force_and_tangent(line, nu, branch)

    def value(line: np.ndarray) -> np.ndarray:
        slopes = np.stack([line[:, 0], line[:, 1] / (line[:, 3] * radius), line[:, 2]])
        return density(slopes, line[:, 3] * radius, np.full(20, radius), nu, tense)

    assert relaxed_energy(line, nu, branch) == pytest.approx(value(line), rel=1e-12)
    for k in range(4):
        step = np.zeros(4, dtype=complex)
        step[k] = 1j * COMPLEX
        # r phi' is held while r / R moves: `value` divides by the moved r
        assert force[:, k] == pytest.approx(value(line + step).imag / COMPLEX, rel=1e-11, abs=1e-13)
        change = 1e-5 * np.eye(4)[k]
        difference = (
            force_and_tangent(line + change, nu, branch)[0] - force_and_tangent(line - change, nu, branch)[0]
        ) / 2e-5
        # a central difference: its error is the step squared, its rounding 1e-16 over the step
        assert tangent[:, :, k] == pytest.approx(difference, abs=1e-8)
    for a, p in zip(line, force, strict=True):
        r = a[3] * radius
        momenta = Momenta(nu, torque=radius * r * p[1], axial=radius * p[2])
        slope = (momenta.tense if tense else momenta.wrinkled)(radius, r, radius * p[0])
        assert slope[:3] == pytest.approx(a[:3], rel=1e-11, abs=1e-12)
        assert slope.hoop_force == pytest.approx(p[3], rel=1e-11, abs=1e-12)
        assert slope.energy == pytest.approx(float(relaxed_energy(a, nu, branch)), rel=1e-11)
