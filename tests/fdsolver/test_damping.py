"""The damping rules against a plain rendering of Eqs. (67) to (73), on a small system of linear springs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from fdsolver import damping
from tests.dense import mass_matrix, node_matrices

NI, NJ = 3, 4
SIZE = 3 * NI * NJ
NO_CAP = 1e9
# both sides do the same sums in another order: rounding, amplified a little by every step
TIGHT = {"rtol": 0.0, "atol": 1e-12}


@dataclass
class Springs:
    """Force -K r of a system whose frequencies against its masses are given; as `effects.Force`."""

    stiffness: np.ndarray

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        f[:] = -(self.stiffness @ r.ravel()).reshape(r.shape)
        return np.array([0.5 * float(r.ravel() @ self.stiffness @ r.ravel()), 0.0, 0.0])


@dataclass
class System:
    """Springs, nodal masses, and their modes: K mode = w m mode, columns of `modes` with m-norm one."""

    force: Springs
    mass: np.ndarray
    inverse: np.ndarray
    squares: np.ndarray
    modes: np.ndarray


def system(squares: np.ndarray, seed: int = 0) -> System:
    """Random full 3 x 3 masses at every node, and springs with the given eigenvalues w against them."""
    random = np.random.default_rng(seed)
    blocks = random.standard_normal((NI * NJ, 3, 3))
    blocks = blocks @ blocks.transpose(0, 2, 1) + np.eye(3)
    mass, inverse = planes(blocks), planes(np.linalg.inv(blocks))
    root = np.linalg.cholesky(mass_matrix(mass))
    basis = np.linalg.qr(random.standard_normal((SIZE, SIZE)))[0]
    stiffness = root @ basis @ np.diag(squares) @ basis.T @ root.T
    return System(Springs(stiffness), mass, inverse, squares, np.linalg.solve(root.T, basis))


def planes(blocks: np.ndarray) -> np.ndarray:
    """(n, 3, 3) as (6, ni, nj): xx, yy, zz, xy, xz, yz."""
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    return np.array([blocks[:, a, b] for a, b in pairs]).reshape(6, NI, NJ)


SQUARES = np.geomspace(1e-3, 2.5, SIZE)


class Plain:
    """Eqs. (67) to (73) as they are printed, h = 1, with the rules of this project on top."""

    def __init__(self, spring: System, rule: str, constant: float, r: np.ndarray) -> None:
        self.spring, self.rule, self.constant = spring, rule, constant
        self.r, self.v = r.ravel().copy(), np.zeros(SIZE)
        self.viscosity, self.since, self.peaks, self.time, self.rising = 0.0, 0, [], 0, False
        self.m = mass_matrix(spring.mass)

    def force(self) -> np.ndarray:
        return -self.spring.force.stiffness @ self.r

    def kinetic(self) -> float:
        return float(self.v @ self.m @ self.v) / 2.0  # [72]

    def block(self, steps: int) -> None:
        for k in range(steps):
            f, kinetic = self.force(), self.kinetic()
            if self.rule == "adaptive" and k == steps - 1:
                quotient = float(self.v @ self.spring.force.stiffness @ self.v) / (2.0 * kinetic)
                self.viscosity = min(2.0 * math.sqrt(max(quotient, 0.0)), 1.0)
            c = {"adaptive": self.viscosity, "viscous": self.constant}.get(self.rule, 0.0)
            if self.since == 0:
                self.v = np.linalg.solve(2.0 * self.m, f)  # [70]
            else:
                self.v = np.linalg.solve(
                    (1.0 + c / 2.0) * self.m, (1.0 - c / 2.0) * self.m @ self.v + f
                )  # [68]
            self.r = self.r + self.v
            self.time, self.since = self.time + 1, self.since + 1
            rising, self.rising = self.rising, self.kinetic() >= kinetic
            if rising and not self.rising:
                self.peak(f)

    def peak(self, f: np.ndarray) -> None:
        far_enough = self.rule == "kinetic" and self.since >= 10
        if self.rule == "kinetic-published" or far_enough:
            self.r = self.r - 1.5 * self.v + np.linalg.solve(2.0 * self.m, f)  # [73]
            self.v, self.since = np.zeros(SIZE), 0
            self.peaks.append(self.time)


def run(spring: System, rule: str, constant: float, start: np.ndarray, blocks: list[int]):
    """The engine's own motion; returns r, v, restarts of every block, viscosity and steps since the last restart."""
    r, v = start.copy(), np.zeros_like(start)
    f, old = np.zeros_like(start), np.zeros_like(start)
    viscosity, since, rising, restarts = 0.0, 0, False, []
    for steps in blocks:
        spring.force(r, f)
        found, viscosity, since, rising, _ = damping.advance(
            spring.force,
            r,
            v,
            spring.mass,
            spring.inverse,
            f,
            old,
            (rule, constant),
            viscosity,
            since,
            rising,
            steps,
            NO_CAP,
        )
        restarts.append(found)
    return r, v, restarts, viscosity, since


def some_start(seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((3, NI, NJ))


@pytest.mark.parametrize("rule", damping.RULES)
def test_motion_follows_the_printed_equations(rule: str) -> None:
    spring, start, blocks = system(SQUARES), some_start(), [10] * 30
    plain = Plain(spring, rule, 0.05, start)
    for steps in blocks:
        plain.block(steps)
    r, v, restarts, viscosity, since = run(spring, rule, 0.05, start, blocks)
    np.testing.assert_allclose(r.ravel(), plain.r, **TIGHT)
    np.testing.assert_allclose(v.ravel(), plain.v, **TIGHT)
    assert (sum(restarts), since) == (len(plain.peaks), plain.since)
    assert bool(plain.peaks) == rule.startswith("kinetic")
    assert np.abs(plain.r).max() > 1e-6  # still moving: the comparison says something
    if rule == "adaptive":
        assert viscosity == pytest.approx(plain.viscosity, rel=1e-8)  # a difference of forces of like size


@pytest.mark.parametrize("rule", damping.RULES)
def test_first_step_from_rest_is_half_a_kick(rule: str) -> None:
    """[70]: 2 m v = f, whatever the viscosity."""
    spring, start = system(SQUARES), some_start()
    f = np.zeros_like(start)
    spring.force(start, f)
    r, v, *_ = run(spring, rule, 0.7, start, [1])
    expected = np.linalg.solve(2.0 * mass_matrix(spring.mass), f.ravel())
    np.testing.assert_allclose(v.ravel(), expected, **TIGHT)
    np.testing.assert_array_equal(r, start + v)


def test_published_restart_is_at_the_estimated_peak() -> None:
    """One mode, r = a cos(omega t): the kinetic energy peaks at r = 0, and [73] comes as near as half a step."""
    mode, omega = 5, 0.05
    squares = SQUARES.copy()
    squares[mode] = omega**2
    spring = system(squares)
    amplitude = 0.3
    start = (amplitude * spring.modes[:, mode]).reshape(3, NI, NJ)
    quarter = math.ceil(math.pi / 2 / omega)
    r, v, restarts, _, since = run(spring, "kinetic-published", 0.0, start, [1] * (quarter + 3))
    peak = restarts.index(1)
    assert abs(peak + 1 - math.pi / 2 / omega) < 2.0
    r, v, restarts, _, since = run(spring, "kinetic-published", 0.0, start, [1] * (peak + 1))
    assert np.all(v == 0.0)
    assert since == 0
    left = np.linalg.norm(r) / np.linalg.norm(start)
    assert left < omega  # it moves by omega of the amplitude per step there


def test_robust_restart_stays_between_points_of_the_path_at_capped_speed() -> None:
    """Where the speed is capped the force says nothing about the last step: [73] would throw the nodes far off."""
    spring, cap = system(np.full(SIZE, 2.5)), 1.0
    start = 1e3 * some_start()
    start[:, 1, 2] *= 0.1 * cap / np.linalg.norm(start[:, 1, 2])
    arrival = (
        cap * start / np.linalg.norm(start, axis=0)
    )  # outward: the far nodes turn about, the near one slows down
    r, v, f, old = start.copy(), arrival.copy(), np.zeros_like(start), np.zeros_like(start)
    spring.force(r, f)
    restarts, *_ = damping.advance(
        spring.force, r, v, spring.mass, spring.inverse, f, old, ("kinetic", 0.0), 0.0, 50, True, 1, cap
    )
    assert restarts == 1
    np.testing.assert_allclose(r, start - arrival / 2.0, rtol=0.0, atol=1e-10)  # rounding of 1e3
    assert not v.any()


@pytest.mark.parametrize("omega", [0.02, 0.3])
def test_adaptive_viscosity_is_twice_the_frequency_of_the_motion(omega: float) -> None:
    squares = SQUARES.copy()
    squares[7] = omega**2
    spring = system(squares)
    _, _, _, viscosity, _ = run(spring, "adaptive", 0.0, spring.modes[:, 7].reshape(3, NI, NJ), [10])
    assert viscosity == pytest.approx(2.0 * omega, rel=1e-9)  # difference of forces: 1e-16 / omega^2


def test_adaptive_viscosity_damps_no_motion_away_from_an_unstable_state() -> None:
    squares = SQUARES.copy()
    squares[7] = -1e-3
    spring = system(squares)
    start = spring.modes[:, 7].reshape(3, NI, NJ)
    _, _, _, viscosity, _ = run(spring, "adaptive", 0.0, start, [10])
    assert viscosity == 0.0
    # and where the motion is stiff it stays below the largest value
    spring = system(np.full(SIZE, 2.5))
    assert run(spring, "adaptive", 0.0, some_start(), [10])[3] == damping.LARGEST_VISCOSITY


def test_robust_restarts_keep_their_distance() -> None:
    """A system with one fast and many slow modes peaks all the time; the printed rule restarts each time."""
    spring, start = system(SQUARES), some_start(4)
    times = {
        rule: np.flatnonzero(run(spring, rule, 0.0, start, [1] * 400)[2])
        for rule in ("kinetic", "kinetic-published")
    }
    assert len(times["kinetic"]) > 5
    assert np.diff(times["kinetic"]).min() >= damping.APART
    assert np.diff(times["kinetic-published"]).min() < damping.APART


@pytest.mark.parametrize("rule", damping.RULES)
def test_every_rule_comes_to_rest(rule: str) -> None:
    spring, start = system(np.geomspace(1e-2, 2.5, SIZE)), some_start()
    r, *_ = run(spring, rule, 0.1, start, [10] * 200)
    # the slowest mode, omega = 0.1, falls by exp(-0.05 t) under the constant viscosity; t = 2000. Peaks that were no
    # peaks once restarted the kinetic rule every 10 steps, which some modes survived for good.
    assert np.abs(r).max() < 1e-8 * np.abs(start).max()


def test_velocity_is_capped_and_nan_is_not_hidden_by_it() -> None:
    spring, start = system(SQUARES), some_start()
    f, inverse = np.zeros_like(start), spring.inverse
    spring.force(start, f)
    f[1, 2, 3] = np.nan
    r, v = start.copy(), np.zeros_like(start)
    power = damping.step(r, v, inverse, f, 0.0, 1e-3, 1.0)
    assert math.isnan(power)
    broken = np.isnan(v)
    assert broken[:, 2, 3].all() and broken.sum() == 3
    speeds = np.linalg.norm(np.where(broken, 0.0, v), axis=0)
    assert speeds.max() == pytest.approx(1e-3, rel=1e-15)
    # a capped node keeps its direction
    wanted = np.einsum("nab,bn->an", node_matrices(inverse), f.reshape(3, -1))
    shares = v.reshape(3, -1) / wanted
    np.testing.assert_allclose(shares, shares[:1] * np.ones((3, 1)), rtol=1e-12)


@pytest.mark.parametrize("threads", [2, 3])
def test_bands_of_rows_make_the_bits_of_one_thread(threads: int) -> None:
    spring, start = system(SQUARES), some_start()
    f = np.zeros_like(start)
    spring.force(start, f)
    states = []
    for bands in (1, threads):
        r, v = start.copy(), 0.3 * start
        power = damping.step(r, v, spring.inverse, f, 0.2, 0.05, 1.0, bands)
        states.append((r, v, power))
    (r, v, power), (other_r, other_v, other_power) = states
    assert power == other_power
    assert np.array_equal(r, other_r) and np.array_equal(v, other_v)
    assert not np.array_equal(r, start)


def test_kinetic_energy_and_nodal_products() -> None:
    spring, v = system(SQUARES), some_start()
    expected = float(v.ravel() @ mass_matrix(spring.mass) @ v.ravel())
    found = damping.twice_kinetic(v.reshape(3, -1), spring.mass.reshape(6, -1))
    assert found == pytest.approx(expected, rel=1e-13)
    product = np.einsum("nab,bn->an", node_matrices(spring.mass), v.reshape(3, -1)).reshape(v.shape)
    np.testing.assert_allclose(damping.times(spring.mass, v), product, **TIGHT)


def test_constant_viscosity_is_that_of_the_longest_wave() -> None:
    """A wave that spans n nodes and moves a node per step has omega = pi / n."""
    assert damping.rule("viscous", 50) == ("viscous", pytest.approx(2.0 * math.pi / 50))


def test_an_unknown_rule_is_refused() -> None:
    with pytest.raises(ValueError, match="adaptive, kinetic, kinetic-published, viscous, not 'magic'"):
        damping.rule("magic", 50)
