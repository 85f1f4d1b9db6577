"""Stability: classical buckling loads, dense eigenproblems, and unstable equilibria that are left."""

from __future__ import annotations

import dataclasses
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from fdsolver import meshes, planar, stability
from fdsolver.edges import EdgeCondition
from fdsolver.effects import Force, build_force
from fdsolver.grid import Grid
from fdsolver.level import Level
from fdsolver.mass import invert, nodal_masses
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.problem import Problem
from fdsolver.relax import Settings, State, begin
from fdsolver.result import Status
from fdsolver.stability import relax_to_stable, search
from tensionfield.relaxed import TENSION_FIELD
from tests.dense import mass_matrix, tangent
from tests.sample_meshes import small_meshes

SIDE = 20.0
WAVE = np.pi / SIDE  # of the half sine over the length
TIGHT = Settings(tolerance=1e-9)


def at_rest(force: Force, r: np.ndarray, free: np.ndarray) -> State:
    """A state with the masses that a relaxation would give it."""
    state = begin(r)
    state.mass = nodal_masses(force, r, r, force.relaxed)
    invert(state.mass.reshape(6, -1), free.reshape(-1), state.inverse_mass.reshape(6, -1))
    return state


def rim(grid: Grid) -> np.ndarray:
    """(ni, nj) bool: nodes on any edge."""
    nodes = np.zeros((grid.ni, grid.nj), dtype=bool)
    for edge in grid.edges.values():
        nodes[tuple(edge.T)] = True
    return nodes


def uniform(grid: Grid, stretch_x: float, stretch_y: float) -> np.ndarray:
    """The sheet stretched uniformly in its plane, (3, ni, nj) scaled."""
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    return np.stack([stretch_x * x, stretch_y * y, 0.0 * x])


# Classical loads


STRIP_MM = 1.0


def strip(shortening: float, model: Model = KOITER, nodes: int = 400) -> Level:
    """A strip without lateral contraction, simply supported at its ends, which are `shortening` nearer."""
    sheet = Sheet(young_MPa=3500.0, poisson=0.0, thickness_mm=STRIP_MM)
    grid = meshes.rectangle(SIDE, 0.4 * SIDE, nodes)
    move = (-shortening * SIDE, 0.0, 0.0)
    edges = {"left": EdgeCondition("pinned"), "right": EdgeCondition("pinned", move_mm=move)}
    return Level(Problem(sheet, edges, grid, lambda n: grid, perturbation=0.0), model, grid, threads=1)


EULER = WAVE**2 * STRIP_MM**2 / 12.0  # strain at which it buckles


def test_shortened_strip_leaves_its_flat_state_for_the_arch() -> None:
    """Euler: beyond the critical strain the force stays, and the arch A sin(k x) takes up (k A)^2 / 4."""
    level = strip(2.0 * EULER)
    state = begin(level.start())
    assert not state.r[2].any()  # exactly flat: without the kick it would stay there
    status, verdict = relax_to_stable(level, state, TIGHT)
    assert (status, verdict["stable"]) == (Status.CONVERGED, True)
    assert state.kicks == 1
    assert verdict["how"] == stability.FACTOR
    amplitude = np.abs(level.unscaled(state.r)[..., 2]).max()
    expected = 2.0 / WAVE * np.sqrt(EULER)
    # 30 cells: the critical strain is 0.3 % off, the rise that is left over it as much the other way
    assert amplitude == pytest.approx(expected, rel=0.01)
    edge = level.grid.edges["right"]
    f = np.zeros_like(state.r)
    level.force(state.r, f)
    push = f[0][tuple(edge.T)].sum() * level.force_unit
    assert push == pytest.approx(3500.0 * STRIP_MM * 0.4 * SIDE * EULER, rel=0.01)


def test_strip_below_the_load_stays_flat_and_is_stable() -> None:
    level = strip(0.98 * EULER)
    state = begin(level.start())
    status, verdict = relax_to_stable(level, state, TIGHT)
    assert (status, verdict["stable"], state.kicks) == (Status.CONVERGED, True, 0)
    assert not state.r[2].any()
    assert verdict["lowest"] > stability.NEUTRAL


def test_equilibrium_that_kicks_do_not_leave_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stability, "MOST_KICKS", 2)
    monkeypatch.setattr(
        stability, "kick", lambda state, displacement: vars(state).update(kicks=state.kicks + 1)
    )
    level = strip(2.0 * EULER)
    state = begin(level.start())
    status, verdict = relax_to_stable(level, state, TIGHT)
    assert (status, verdict["stable"], state.kicks) == (Status.UNSTABLE_FLAT, False, 2)


def test_membrane_is_examined_but_not_kicked() -> None:
    level = strip(2.0 * EULER, MEMBRANE)
    state = begin(level.start())
    status, verdict = relax_to_stable(level, state, TIGHT)
    assert (status, verdict["stable"], state.kicks) == (Status.CONVERGED, False, 0)
    assert verdict["lowest"] < 0.0
    assert not state.r[2].any()


def test_in_its_plane_the_finest_mesh_alone_is_examined() -> None:
    """Nothing can be kicked out of a plane, so what a coarser mesh would tell serves nobody."""
    spent = []
    for finest in (False, True):
        level = strip(0.98 * EULER, replace(KOITER, out_of_plane=False))
        state = begin(level.start())
        status, verdict = relax_to_stable(level, state, TIGHT, finest=finest)
        assert status is Status.CONVERGED
        assert verdict["stable"] is (True if finest else None)
        spent.append(state.evaluations - state.step)
    assert spent[0] == 0
    assert spent[1] > 0


def test_relaxed_membrane_is_stable_by_nature() -> None:
    level = strip(-0.01, TENSION_FIELD)
    status, verdict = relax_to_stable(level, begin(level.start()), Settings(tolerance=1e-6))
    assert (status, verdict) == (Status.CONVERGED, {"stable": True, "how": stability.CONVEX, "lowest": None})


def test_what_is_not_converged_is_not_judged() -> None:
    level = strip(2.0 * EULER)
    state = begin(level.start())
    state.r[2, 5, 5] += 1e-3
    status, verdict = relax_to_stable(level, state, Settings(tolerance=1e-12, max_steps=20))
    assert (status, verdict["stable"], verdict["lowest"]) == (Status.STEP_LIMIT, None, None)


def test_nearly_planar_states_are_judged_as_planar_and_others_are_searched() -> None:
    level = strip(2.0 * EULER)
    state = at_rest(level.force, level.start(), ~level.fixed)
    state.r[2, 10, 5] = 1e-6
    planar, other = (stability.examine(level, state, flat) for flat in (2e-6, 0.5e-6))
    assert planar.how == stability.EXACT
    assert other.how == stability.BENT
    assert planar.mode is not None
    np.testing.assert_array_equal(planar.mode[:2], 0.0)
    assert np.abs(planar.mode).max() == 1.0


def test_planar_state_is_searched_where_the_exact_way_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planar, "MOST_NODES", 100)
    level = strip(2.0 * EULER)
    verdict = stability.examine(level, at_rest(level.force, level.start(), ~level.fixed))
    assert "Lanczos" in verdict.how
    assert not verdict.stable


# Dense eigenproblems


MESHES = small_meshes()
THICK = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=0.5)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("compression", [0.0, 0.01])
def test_lowest_value_is_that_of_the_dense_eigenproblem(name: str, compression: float) -> None:
    """On a planar state, out of plane, which is where the iteration starts."""
    grid = MESHES[name]
    fixed = rim(grid)
    force = build_force(grid, THICK, KOITER, dict.fromkeys(grid.edges, "pinned"))
    r = uniform(grid, 1.02 if compression == 0.0 else 1.0 - compression, 1.0 - compression)
    state = at_rest(force, r, ~fixed)
    loose = np.concatenate([np.zeros(2 * grid.nodes, dtype=bool), ~fixed.ravel()])
    pair = (matrix[np.ix_(loose, loose)] for matrix in (tangent(force, r), mass_matrix(state.mass)))
    values, vectors = eigh(*pair)
    verdict = search(force, state)
    assert verdict.stable == (values[0] > 0.0)
    # stopped when 50 steps bring less than 5 % (unstable) or 0.1 % (stable); a Ritz value is
    # never below but for the differences behind both
    assert values[0] - 1e-4 * abs(values[0]) <= verdict.lowest <= values[0] + 0.05 * abs(values[0])
    if verdict.mode is not None:
        assert not verdict.mode[:, fixed].any()
        assert np.abs(verdict.mode).max() == 1.0
        mode = verdict.mode.ravel()
        quotient = mode @ tangent(force, r) @ mode / (mode @ mass_matrix(state.mass) @ mode)
        assert quotient == pytest.approx(verdict.lowest, rel=1e-3)  # differences behind tangent and iteration


@pytest.mark.parametrize("turned", [False, True])
def test_instability_of_a_state_in_space_is_found(turned: bool) -> None:
    """A shallow arch pressed flat, in any attitude: the start along z is no eigenvector there, and need not be."""
    grid = meshes.rectangle(20.0, 12.0, 120)
    fixed = rim(grid)
    force = build_force(grid, THICK, KOITER, dict.fromkeys(grid.edges, "pinned"))
    r = uniform(grid, 0.98, 0.98)
    r[2] += np.where(fixed, 0.0, 2e-3 * np.cos(np.pi * r[0] / 0.98))
    if turned:
        r = np.einsum("kl,lij->kij", np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0], r)
    state = at_rest(force, r, ~fixed)
    loose = np.tile(~fixed.ravel(), 3)
    pair = (matrix[np.ix_(loose, loose)] for matrix in (tangent(force, r), mass_matrix(state.mass)))
    value = eigh(*pair, eigvals_only=True)[0]
    verdict = search(force, state)
    assert value < 0.0
    assert verdict.lowest == pytest.approx(value, rel=0.05)  # see above


def test_examination_changes_nothing_and_repeats_itself() -> None:
    level = strip(2.0 * EULER)
    free = ~level.fixed
    state = at_rest(level.force, level.start(), free)
    before = {name: value.copy() for name, value in state.as_arrays().items()}
    first, second, other = (search(level.force, state, seed) for seed in (3, 3, 4))
    for name, value in state.as_arrays().items():
        np.testing.assert_array_equal(value, before[name])
    assert first.mode is not None and second.mode is not None
    np.testing.assert_array_equal(first.mode, second.mode)
    assert (first.lowest, first.evaluations) == (second.lowest, second.evaluations)
    assert other.lowest == pytest.approx(first.lowest, rel=0.05)  # see above
    assert other.lowest != first.lowest


@dataclasses.dataclass
class Interrupting:
    """A force whose n-th evaluation is interrupted."""

    inner: Any
    call: int
    calls: int = 0

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        self.calls += 1
        if self.calls == self.call:
            raise KeyboardInterrupt
        return self.inner(r, f)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)


def test_an_interrupted_examination_can_be_made_again() -> None:
    """Evaluation 1 is the look at the converged flat state; Lanczos iteration and, after the kick, steps follow."""
    level = strip(2.0 * EULER)
    whole = begin(level.start())
    relax_to_stable(level, whole, TIGHT)
    plain = level.force
    for call in (2, 40, 120, 300):
        state = begin(level.start())
        level.force = Interrupting(plain, call)
        assert relax_to_stable(level, state, TIGHT)[0] is Status.INTERRUPTED
        status, verdict = relax_to_stable(level, state, TIGHT)
        assert (status, verdict["stable"]) == (Status.CONVERGED, True)
        np.testing.assert_array_equal(state.r, whole.r)
        assert state.history == whole.history


def test_a_flat_state_is_not_called_stable_before_its_compression_has_grown() -> None:
    """At a residual of 1e-4 the pulled silicone strip looks flat and stable; it wrinkles (Zheng 2009)."""
    sheet = Sheet(young_MPa=1.0, poisson=0.5, thickness_mm=0.1)
    grid = meshes.rectangle(101.6, 254.0, 2000, bias=1.0)
    edges = {"bottom": EdgeCondition("pinned"), "top": EdgeCondition("pinned", move_mm=(0.0, 25.4, 0.0))}
    level = Level(Problem(sheet, edges, grid, lambda n: grid, perturbation=1e-12), KOITER, grid, threads=1)
    state = begin(level.start())
    status, verdict = relax_to_stable(level, state, Settings(tolerance=1e-4))
    assert status is Status.CONVERGED and verdict["stable"] is True
    assert np.ptp(state.r[2]) * grid.length_mm > 0.5 * sheet.thickness_mm


def test_the_tolerance_falls_with_every_kick(monkeypatch: pytest.MonkeyPatch) -> None:
    level = strip(2.0 * EULER)
    asked: list[float] = []

    def relax(*arguments: Any) -> Status:
        asked.append(arguments[2].tolerance)
        return Status.CONVERGED

    bump = np.zeros((3, level.grid.ni, level.grid.nj))
    bump[2, 1:-1] = 1.0
    unstable = stability.Stability(False, -1.0, "planted", 0, bump)
    monkeypatch.setattr(stability, "relax_or_finish", relax)
    monkeypatch.setattr(stability, "examine", lambda *_: unstable)
    relax_to_stable(level, begin(level.start() + bump), Settings(tolerance=1e-4))
    assert asked == pytest.approx([1e-4, 1e-6, 1e-7, 1e-8, 1e-9], rel=1e-12)
    asked.clear()
    relax_to_stable(level, begin(level.start() + bump), Settings(tolerance=3e-9))
    assert asked == pytest.approx([3e-9, 3e-9, 3e-9, 3e-9, 1e-9], rel=1e-12)
