"""Strips that bend in one direction, against closed forms: roll-up by an end moment, and the elastica.

nu = 0, so that a strip does not curl across.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse import bsr_array, coo_array
from scipy.special import ellipe, ellipk

from femref.assembly import SheetEnergy
from femref.bicubic import Mesh, flat, hermite
from femref.held import Mirrors, Support, given_values, held_by_supports
from femref.loads import predicted
from femref.newton import NewtonSettings, Outcome, minimise
from femref.postbuckle import SheetProblem, solve
from femref.reactions import reactions

YOUNG, WIDTH = 100.0, 0.3


@dataclass(frozen=True)
class WithCouple(SheetEnergy):
    """A sheet whose edge x = x_max carries a couple about the y axis, N mm / mm: -couple times the turn of the edge."""

    couple: float = 0.0
    turn: float = 0.0  # near which the angle of the edge is counted
    points: tuple = field(default=tuple(0.5 + 0.5 * np.polynomial.legendre.leggauss(4)[0]))

    def _edge(self, q):
        """Interpolation (points, unknowns) of r,x along the edge, its x and z parts, weights."""
        height = np.diff(self.mesh.y)[0]
        functions = hermite(np.array(self.points), *[np.full(4, v) for v in (height, *self.mesh.lengths[1])])[
            :, 0
        ]
        number = np.arange(q.size).reshape(q.shape)[-1, :, 2:, :].reshape(4, 3)
        weight = 0.5 * np.polynomial.legendre.leggauss(4)[1] * height
        slopes = functions @ q.ravel()[number]
        return functions, number, slopes, weight

    def value(self, q):
        _, _, slopes, weight = self._edge(q)
        angle = np.arctan2(slopes[:, 2], slopes[:, 0])
        angle += 2.0 * np.pi * np.round((self.turn - angle) / (2.0 * np.pi))
        return super().value(q) - self.couple * float(weight @ angle)

    def gradient(self, q):
        functions, number, slopes, weight = self._edge(q)
        gradient = super().gradient(q).ravel()
        size = slopes[:, 0] ** 2 + slopes[:, 2] ** 2
        for k, part in ((0, -slopes[:, 2] / size), (2, slopes[:, 0] / size)):
            gradient[number[:, k]] -= self.couple * (weight * part) @ functions
        return gradient.reshape(q.shape)

    def hessian(self, q):
        functions, number, slopes, weight = self._edge(q)
        x, z = slopes[:, 0], slopes[:, 2]
        size2 = (x**2 + z**2) ** 2
        second = {(0, 0): 2.0 * x * z, (2, 2): -2.0 * x * z, (0, 2): z**2 - x**2, (2, 0): z**2 - x**2}
        rows, columns, values = [], [], []
        for (k, m), part in second.items():
            block = -self.couple * functions.T @ ((weight * part / size2)[:, None] * functions)
            i, j = np.meshgrid(number[:, k], number[:, m], indexing="ij")
            rows, columns, values = [*rows, i.ravel()], [*columns, j.ravel()], [*values, block.ravel()]
        added = coo_array(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(q.size, q.size)
        )
        return bsr_array(super().hessian(q) + added.tocsr())


def rolled(elements: int, thickness: float, turns: float, steps: int) -> tuple[float, float]:
    """Turn of the end (over 2 pi) and stretch of a strip of length 1 under the moment of `turns` turns."""
    mesh = Mesh(np.linspace(0.0, 1.0, elements + 1), np.array([0.0, WIDTH]))
    held = held_by_supports(mesh, {"left": Support("clamped")})
    q = flat(mesh)
    for step in range(1, steps + 1):
        angle = 2.0 * np.pi * turns * step / steps
        stretch = np.sqrt(1.0 - (thickness * angle) ** 2 / 6.0)
        couple = YOUNG * thickness**3 / 12.0 * stretch**2 * angle
        energy = WithCouple(mesh, YOUNG, 0.0, thickness, couple=couple, turn=angle)
        found = minimise(energy, q, ~held, NewtonSettings(tolerance=1e-11))
        assert found.outcome is Outcome.CONVERGED, f"step {step}: {found.outcome.value} {found.residual:.1e}"
        q = found.q
    slope = q[-1, 0, 2] / mesh.lengths[0][-1]
    end = np.arctan2(slope[2], slope[0])
    end += 2.0 * np.pi * np.round((angle - end) / (2.0 * np.pi))
    return end / (2.0 * np.pi), float(np.hypot(slope[0], slope[2]))


def test_an_end_moment_rolls_a_strip_to_the_turn_of_the_closed_form():
    """E / (Y h) = (l^2 - 1)^2 / 8 + h^2 (l k)^2 / 24 per area, k = turn / length: l^2 = 1 - h^2 k^2 / 6, and the
    moment Y h^3 / 12 l^2 k turns the end by k. Half a circle here.
    """
    thickness, turns = 0.02, 0.5
    errors = []
    for elements in (4, 8):
        turn, stretch = rolled(elements, thickness, turns, steps=4)
        errors.append(abs(turn - turns))
    wanted = np.sqrt(1.0 - (2.0 * np.pi * turns * thickness) ** 2 / 6.0)
    print(f"errors of the turn {errors}, of the stretch {stretch - wanted:.1e}")
    assert errors[-1] < 2e-4  # a cubic spans 22.5 degrees of arc
    assert np.log2(errors[0] / errors[1]) > 3.0  # fourth order in the limit
    assert stretch == pytest.approx(wanted, abs=3e-4)  # the strip's own shortening is 6.6e-4


LENGTH, THIN = 1.0, 1e-2


def elastica(shortening: float) -> tuple[float, float]:
    """Height over length and load over Euler's, of an inextensible pinned strip shortened by a part of its length.

    Love 1927, sections 262 to 263: with k = sin(half the end's angle), shortening 2 - 2 E / K, height k / K, load
    (2 K / pi)^2.
    """
    m = brentq(lambda m: 2.0 - 2.0 * ellipe(m) / ellipk(m) - shortening, 1e-6, 0.9)
    return np.sqrt(m) / ellipk(m), (2.0 * ellipk(m) / np.pi) ** 2


def pinned_strip(mirrors: Mirrors, shortening: float) -> SheetProblem:
    """A strip of length 1, thirty-two elements, shortened by a part of its length."""
    half, move = 0.5 * LENGTH, 0.5 * shortening * LENGTH
    x = np.linspace(0.0 if mirrors.x else -half, half, 17 if mirrors.x else 33)
    y = np.linspace(0.0, 0.1, 2) if mirrors.y else np.array([-0.1, 0.1])
    supports = {"right": Support("pinned", (-move, 0.0, 0.0))}
    if not mirrors.x:
        supports["left"] = Support("pinned", (move, 0.0, 0.0))
    return SheetProblem(Mesh(x, y), YOUNG, 0.0, THIN, supports, mirrors)


@pytest.mark.parametrize("mirrors", [Mirrors(), Mirrors(1, 1)])
def test_a_shortened_strip_buckles_into_the_elastica(mirrors):
    """From flat by its lowest mode, at three times the critical load, and on to a tenth of its length."""
    settings = NewtonSettings(tolerance=1e-10)
    critical = np.pi**2 * THIN**2 / 12.0
    (start,) = solve(pinned_strip(mirrors, 3.0 * critical), settings, levels=1)
    assert start.converged and start.flat is not None and start.flat.negative == 1
    q = start.state.q
    shortening = 0.1
    for part in np.geomspace(3.0 * critical, shortening, 9)[1:]:
        problem = pinned_strip(mirrors, part)
        energy, held = problem.energy(), problem.held()
        q = predicted(energy, q, given_values(problem.mesh, problem.supports, 1.0), held, ~held)
        found = minimise(energy, q, ~held, settings)
        assert found.outcome is Outcome.CONVERGED, f"at {part:.3g}: {found.outcome.value}"
        q = found.q
    height, load = elastica(shortening)
    middle = 0 if mirrors.x else 16
    assert abs(q[middle, 0, 0, 2]) == pytest.approx(
        height * LENGTH, rel=1e-3
    )  # the load shortens it by 8e-5, of 0.1
    width = 0.1 if mirrors.y else 0.2
    euler = np.pi**2 * YOUNG * THIN**3 / 12.0 / LENGTH**2 * width
    force, _ = reactions(energy, q, ["right"])["right"]
    assert -force[0] == pytest.approx(load * euler, rel=1e-3)  # of the order of the strain of the load
