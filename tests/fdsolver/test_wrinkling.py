"""The relaxed membrane in two fields: its matrices, its central path, and the law in which it ends."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigvalsh, solve_sylvester, sqrtm

from fdsolver import symmetric, wrinkling
from fdsolver.level import Level
from fdsolver.material import Sheet
from fdsolver.problem import Problem
from fdsolver.tangent import tangent
from tensionfield.relaxed import TENSION_FIELD
from tests.sample_meshes import small_meshes

NU = 0.31
THIN = Sheet(young_MPa=3500.0, poisson=NU, thickness_mm=0.05)
RANDOM = np.random.default_rng(11)


def full(a: tuple[float, float, float]) -> np.ndarray:
    return np.array([[a[0], a[2]], [a[2], a[1]]])


def triple(a: np.ndarray) -> tuple[float, float, float]:
    return a[0, 0], a[1, 1], a[0, 1]


def definite(smallest: float = 1e-2) -> np.ndarray:
    q, _ = np.linalg.qr(RANDOM.standard_normal((2, 2)))
    return q @ np.diag([1.0, smallest]) @ q.T


@pytest.mark.parametrize("smallest", [1.0, 1e-2, 1e-6])
def test_matrices_are_those_of_linear_algebra(smallest: float) -> None:
    """Against numpy and scipy; an eigenvalue smallest times the other costs its inverse in rounding."""
    a, b = definite(smallest), definite(smallest)
    change = RANDOM.standard_normal((2, 2))
    change += change.T
    rtol = 1e-13 / smallest
    np.testing.assert_allclose(full(symmetric.inverse(triple(a))), np.linalg.inv(a), rtol=rtol)
    w = full(symmetric.mean(triple(a), triple(b)))
    np.testing.assert_allclose(w @ np.linalg.inv(a) @ w, b, rtol=rtol, atol=rtol)
    np.testing.assert_allclose(full(symmetric.root(triple(a))), sqrtm(a), rtol=rtol, atol=rtol)
    np.testing.assert_allclose(full(symmetric.between(triple(a), triple(change))), a @ change @ a, rtol=1e-12)
    product = full(symmetric.symmetric_product(triple(a), triple(change)))
    np.testing.assert_allclose(product, (a @ change + change @ a) / 2, rtol=1e-12, atol=1e-15)
    divided = full(symmetric.divided(triple(change), triple(a)))
    np.testing.assert_allclose(divided, solve_sylvester(a, a, 2.0 * change), rtol=rtol, atol=rtol)
    least = eigvalsh(change, a)[0]
    expected = -1.0 / least if least < 0.0 else np.inf
    assert symmetric.longest(triple(a), triple(change)) == pytest.approx(expected, rel=rtol)


class Place:
    """A crumpled state of a small mesh, in the plane or in space."""

    def __init__(self, name: str, components: int) -> None:
        self.grid = small_meshes()[name]
        self.level = Level(Problem(THIN, {}, self.grid, lambda n: self.grid), TENSION_FIELD, self.grid, 1)
        random = np.random.default_rng(4)
        r = self.level.scaled(self.level.flat * [1.03, 0.98, 1.0])
        r += (
            0.03
            * random.uniform(-1.0, 1.0, r.shape)
            * np.sqrt(self.grid.node_area.min())
            / self.grid.length_mm
        )
        self.r, self.zone = np.ascontiguousarray(r[:components]), self.level.force.zone
        self.S, self.B, self.none = np.zeros((3, 3, *self.zone.shape[1:]))


class Smooth:
    """Energy and force of a point of the central path: min over B of W(E + B) - m log det B, zone by zone."""

    node = None

    def __init__(self, place: Place, m: float) -> None:
        self.place, self.m, self.closed = place, m, place.grid.closed

    def __call__(self, r: np.ndarray, f: np.ndarray) -> float:
        zone, s, b, none = self.place.zone, self.place.S, self.place.B, self.place.none
        wrinkling.centre(r, zone, NU, self.m, s, b)
        wrinkling.newton_force(r, zone, NU, self.m, s, b, none, none, f)
        membrane = 0.5 * (s[0] ** 2 + s[1] ** 2 - 2.0 * NU * s[0] * s[1] + 2.0 * (1.0 + NU) * s[2] ** 2)
        return float((zone[4] * (membrane - self.m * np.log(b[0] * b[1] - b[2] ** 2))).sum())


@pytest.mark.parametrize("name", small_meshes())
@pytest.mark.parametrize("components", [2, 3])
def test_step_on_the_central_path_is_newtons(name: str, components: int) -> None:
    """There force and matrix are gradient and tangent of one smooth energy."""
    place = Place(name, components)
    smooth = Smooth(place, 1e-3)
    f, beside, r = np.empty_like(place.r), np.empty_like(place.r), place.r
    field, step = np.random.default_rng(5).standard_normal(r.shape), 1e-6
    ahead, behind = (smooth(r + sign * step * field, beside) for sign in (1.0, -1.0))
    smooth(r, f)
    assert (behind - ahead) / (2.0 * step) == pytest.approx(float(np.vdot(f, field)), rel=1e-6)
    values = np.zeros((place.grid.ni, place.grid.nj, 3, 3, components, components))
    wrinkling.newton_matrix(r, place.zone, NU, place.S, place.B, values)
    expected = tangent(smooth, r, range(components)).values
    # the third derivatives times the square of the step over sqrt(m) and over a cell: 3e-6 on the narrowest cells
    np.testing.assert_allclose(values, expected, rtol=0.0, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("components", [2, 3])
def test_changes_satisfy_the_linearised_equations(components: int) -> None:
    """Off the path: stress against strain, S B = m 1 about the scaling, and both with their second-order terms."""
    place = Place("annulus", components)
    s, b, zone, m = place.S, place.B, place.zone, 2e-4
    wrinkling.centre(place.r, zone, NU, 1e-3, s, b)
    random = np.random.default_rng(6)
    s *= random.uniform(0.7, 1.3, s.shape[1:])
    b *= random.uniform(0.7, 1.3, b.shape[1:])
    p = 1e-3 * random.standard_normal(place.r.shape)
    c, q = 1e-5 * random.standard_normal((2, *s.shape))
    ds, db = np.zeros_like(s), np.zeros_like(b)
    most = wrinkling.changes(place.r, p, zone, NU, m, s, b, c, q, ds, db)
    shares = []
    for i, j in np.ndindex(s.shape[1:]):
        S, B, dS, dB = (full(x[:, i, j]) for x in (s, b, ds, db))
        w = full(symmetric.mean(tuple(b[:, i, j]), symmetric.inverse(tuple(s[:, i, j]))))
        left, right = dB + w @ dS @ w, m * np.linalg.inv(S) - B - full(c[:, i, j])
        np.testing.assert_allclose(left, right, rtol=0.0, atol=1e-11 * np.abs(w @ w).max())
        shares += [-1.0 / min(eigvalsh(dS, S)[0], -1e-9), -1.0 / min(eigvalsh(dB, B)[0], -1e-9)]
    assert most == pytest.approx(min(shares), rel=1e-9)


def test_second_order_terms_are_what_a_step_leaves() -> None:
    """q is the quadratic part of Green's strain; c is dS dB where both share their directions with S and B."""
    place = Place("uniform", 2)
    wrinkling.centre(place.r, place.zone, NU, 1e-3, place.S, place.B)
    ds, db, (c, q) = 0.1 * place.S, -0.2 * place.B, np.zeros((2, *place.S.shape))
    p = 1e-3 * np.random.default_rng(7).standard_normal(place.r.shape)
    wrinkling.second_order(p, place.zone, place.S, place.B, ds, db, c, q)
    # S^-1 (dS dB) of the same directions: 0.1 x -0.2 of B
    np.testing.assert_allclose(c, -0.02 * place.B, rtol=1e-9, atol=1e-12)
    sums = []
    for share in (0.0, 1.0, -1.0):
        s, b = np.zeros_like(place.S), np.zeros_like(place.B)
        wrinkling.centre(place.r + share * p, place.zone, NU, 1e-3, s, b)
        gaps = [s[0] - NU * s[1] - b[0], s[1] - NU * s[0] - b[1], (1.0 + NU) * s[2] - b[2]]
        sums.append(np.array(gaps))
    np.testing.assert_allclose(q, 0.5 * (sums[1] + sums[2]) - sums[0], rtol=0.0, atol=1e-12)


def test_central_path_ends_in_the_relaxed_law() -> None:
    """With m nearly zero the force is that of Pipkin's energy: sqrt(m) times a cell's width apart, at most."""
    place = Place("annulus", 3)
    relaxed, path = np.zeros_like(place.r), np.zeros_like(place.r)
    place.level.force(place.r, relaxed)
    Smooth(place, 1e-18)(place.r, path)
    np.testing.assert_allclose(path, relaxed, rtol=0.0, atol=1e-8 * np.abs(relaxed).max())
    assert (place.S[0] * place.S[1] - place.S[2] ** 2 >= 0.0).all()
