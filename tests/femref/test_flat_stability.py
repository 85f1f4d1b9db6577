"""Stability of finitely strained flat sheets: Euler's strip in closed form, and rotations, which bend nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

from femref.flat_stability import FlatSheet, covariant_bending, window
from femref.meshes import rectangle
from femref.plate_matrices import PlateSpace, bending_stiffness
from femref.prestress import PlaneProblem, PlaneState
from femref.sheet_mesh import PlateMaterial

WIDTH, HEIGHT, THICKNESS = 30.0, 50.0, 4.0
CORK = PlateMaterial(10.0, 0.0, THICKNESS)  # without lateral strain a pushed strip stays homogeneous


def strip(nodes: int, support: str = "pinned") -> FlatSheet:
    def top(position: np.ndarray, load: float) -> np.ndarray:
        return np.stack([0.0 * position[0], np.full_like(position[0], -load * HEIGHT)])

    return FlatSheet(
        rectangle(WIDTH, HEIGHT, nodes),
        CORK,
        {"bottom": support, "top": support},
        {"bottom": lambda position, _: 0.0 * position, "top": top},
    )


def euler(half_waves: float) -> float:
    """Shortening (part of the height) at which h S + h^3 / 12 (m pi / L)^2 = 0 with S = Y (l^2 - 1) / 2."""
    return 1.0 - math.sqrt(1.0 - THICKNESS**2 / 6.0 * (half_waves * math.pi / HEIGHT) ** 2)


@pytest.mark.parametrize(("support", "half_waves"), [("pinned", 1.0), ("clamped", 2.0)])
def test_a_pushed_strip_buckles_at_eulers_finite_strain(support: str, half_waves: float) -> None:
    wanted = euler(half_waves)
    flat = strip(45, support)
    # Newton's 1e-12, and quintics on a tenth of a wave
    assert flat.crossing(0.5 * wanted, 1.5 * wanted) == pytest.approx(wanted, rel=1e-5)


def test_the_verdict_counts_modes_and_gives_the_neutral_thickness() -> None:
    flat = strip(45)
    load = 1.05 * euler(2.0)
    found = flat.verdict(load)
    stretch = 1.0 - load
    neutral = math.sqrt(6.0 * (1.0 - stretch**2)) * HEIGHT / math.pi
    assert found.thickness_mm == pytest.approx(neutral, rel=1e-4)
    assert found.factor == pytest.approx((THICKNESS / neutral) ** 2, rel=2e-4)
    # m = 1 and 2 along; across, waves of a free strip only add energy, but its torsion mode comes before m = 2
    assert found.unstable >= 2
    before = flat.verdict(0.5 * euler(1.0))
    assert before.factor > 1.0 and before.unstable == 0


def test_tension_is_stable_at_any_thickness() -> None:
    found = strip(45).verdict(-0.2)
    assert found.factor == math.inf and found.unstable == 0 and found.thickness_mm == 0.0


def test_no_crossing_is_said() -> None:
    with pytest.raises(ValueError, match="no crossing between"):
        strip(15).crossing(0.001, 0.002)


def test_window_gives_both_ends_and_how_far_they_moved() -> None:
    """Pushed strips never become stable again; the same end twice shows the bookkeeping."""
    wanted = euler(1.0)
    bracket = (0.8 * wanted, 1.3 * wanted)
    found = window(strip, (15, 45), (bracket, bracket))
    assert found.appearance == pytest.approx(wanted, rel=1e-5)
    assert found.appearance == found.disappearance and found.appearance_error == found.disappearance_error
    assert 0.0 < found.appearance_error < 0.01 * wanted


def _deformed(x: np.ndarray) -> np.ndarray:
    """A cubic plane map, which cubic elements hold exactly."""
    return np.stack(
        [1.2 * x[0] + 0.3 * x[1] ** 2 + 0.1 * x[0] * x[1], 0.9 * x[1] - 0.2 * x[0] ** 2 + 0.2 * x[0]]
    )


def test_rotating_a_deformed_sheet_out_of_its_plane_bends_nothing() -> None:
    """w = a . x(X) is a rotation: its b_ab vanish because of Gamma, although its second derivatives do not."""
    sheet = rectangle(40.0, 50.0, 20)
    space = PlateSpace(sheet, CORK, {})
    problem = PlaneProblem(sheet, CORK, {}, space.points)
    x = problem.basis.doflocs
    unknowns = np.empty(problem.basis.N)
    for component, dofs in enumerate(problem._components):
        unknowns[dofs] = (_deformed(x) - x)[component, dofs]
    gradient = np.asarray(problem.basis.interpolate(unknowns).grad)
    state = PlaneState(gradient, gradient, np.zeros((0, 2)), {}, 0.0, 0.0, unknowns)
    bending = covariant_bending(space, problem, state)
    plain = bending_stiffness(space)
    for direction in ([1.0, 0.0], [0.4, -0.7]):
        w = space.basis.project(
            lambda place, a=direction: a[0] * _deformed(place)[0] + a[1] * _deformed(place)[1]
        )
        energy, naive = w @ bending @ w, w @ plain @ w
        assert abs(energy) < 1e-10 * naive  # rounding of second derivatives of quintics
