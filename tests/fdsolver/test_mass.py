"""The nodal masses make a unit time step stable: no frequency of the tangent against them exceeds the bound."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from fdsolver.edges import EdgeCondition
from fdsolver.effects import Force, build_force
from fdsolver.grid import Grid
from fdsolver.mass import SAFETY, invert, nodal_masses
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.start import fixed_nodes
from tensionfield.relaxed import TENSION_FIELD
from tests.dense import frequencies, node_matrices
from tests.sample_meshes import small_meshes

LIMIT = 4.0  # of central differences with a unit time step
STRICT = (
    1.0 + 1e-6
)  # rounding of the differences behind the tangent; the bound itself is a theorem for K / SAFETY
MESHES = small_meshes()
THIN, THICK = (Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=h) for h in (0.05, 5.0))
MODELS: dict[str, tuple[Model, Sheet]] = {
    "koiter, thin": (KOITER, THIN),
    "koiter, thick": (KOITER, THICK),
    "membrane": (MEMBRANE, THIN),
    "tension field": (TENSION_FIELD, THIN),
}
STATES = ("flat", "stretched", "compressed", "wrinkled", "turned", "folded", "far")


@functools.cache
def force_on(model: str, mesh: str) -> Force:
    law, sheet = MODELS[model]
    return build_force(MESHES[mesh], sheet, law, {})


@functools.cache
def state(mesh: str, name: str) -> np.ndarray:
    """Scaled positions (3, ni, nj) of a mesh in one of the states."""
    grid = MESHES[mesh]
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    cell = np.sqrt(grid.node_area) / grid.length_mm
    noise = cell * np.random.default_rng(1).standard_normal((3, grid.ni, grid.nj))
    wrinkled = np.stack([1.1 * x, 0.9 * y, 0.05 * np.cos(20.0 * y)]) + 0.05 * noise
    return {
        "flat": lambda: np.stack([x, y, 0.0 * x]),
        "stretched": lambda: np.stack([1.1 * x, 1.05 * y, 0.0 * x]),
        "compressed": lambda: np.stack([1.1 * x, 0.8 * y, 0.0 * x]),
        "wrinkled": lambda: wrinkled,
        "turned": lambda: np.stack([-wrinkled[1], wrinkled[2], -wrinkled[0]]),
        "folded": lambda: folded(x, y, 0.05),
        "far": lambda: np.stack([2.0 * x, 1.5 * y, 0.3 * x * y]) + 0.1 * noise,
    }[name]()


def folded(x: np.ndarray, y: np.ndarray, radius: float) -> np.ndarray:
    """The sheet wrapped by half a turn about a cylinder along y: beyond it x runs back, a diameter higher."""
    angle = np.clip(x / radius, 0.0, np.pi)
    along = np.where(x < 0.0, x, radius * np.sin(angle) - np.maximum(x - np.pi * radius, 0.0))
    return np.stack([along, y, radius * (1.0 - np.cos(angle))])


def all_free(grid: Grid) -> np.ndarray:
    return np.ones((grid.ni, grid.nj), dtype=bool)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("model", MODELS)
def test_no_frequency_exceeds_the_bound(model: str, mesh: str) -> None:
    force = force_on(model, mesh)
    for name in STATES:
        r = state(mesh, name)
        mass = nodal_masses(force, r, r, force.relaxed)
        largest = frequencies(force, r, mass, all_free(MESHES[mesh]))[-1]
        assert largest <= LIMIT / SAFETY * STRICT, name


@pytest.mark.parametrize("model", MODELS)
def test_the_bound_is_not_wasteful(model: str) -> None:
    """Masses larger than needed cost steps: on the plain mesh the bound is nearly reached."""
    force = force_on(model, "uniform")
    r = state("uniform", "stretched")
    mass = nodal_masses(force, r, r, force.relaxed)
    # the zone's Gram matrix bound is reached by the checkerboard of a square zone; edges lack half their neighbours
    assert frequencies(force, r, mass, all_free(MESHES["uniform"]))[-1] > 0.9 * LIMIT / SAFETY


@pytest.mark.parametrize("kind", ["isotropic", "uniform"])
@pytest.mark.parametrize("mesh", ["biased", "annulus", "hole"])
@pytest.mark.parametrize("model", MODELS)
def test_other_kinds_are_heavier_and_round(model: str, mesh: str, kind: str) -> None:
    force = force_on(model, mesh)
    r = state(mesh, "wrinkled")
    nodal = node_matrices(nodal_masses(force, r, r, force.relaxed))
    other = node_matrices(nodal_masses(force, r, r, force.relaxed, kind))
    sizes = other[:, 0, 0]
    np.testing.assert_array_equal(other, sizes[:, None, None] * np.eye(3))
    assert np.linalg.eigvalsh(other - nodal).min() >= 0.0
    assert (np.ptp(sizes) == 0.0) == (kind == "uniform")


@pytest.mark.parametrize("mesh", MESHES)
def test_clamped_edges_are_covered(mesh: str) -> None:
    """At a clamped edge the curvature across it counts twice; the bound knows."""
    grid = MESHES[mesh]
    held = {edge: "clamped" for edge in ("left", "top", "hole", "outer") if edge in grid.edges}
    fixed = fixed_nodes(grid, {edge: EdgeCondition("clamped") for edge in held})
    force = build_force(grid, THICK, KOITER, held)
    for name in ("stretched", "wrinkled"):
        r = np.where(fixed, state(mesh, "stretched"), state(mesh, name))
        mass = nodal_masses(force, r, r, relaxed=False)
        assert frequencies(force, r, mass, ~fixed)[-1] <= LIMIT / SAFETY * STRICT, name


@pytest.mark.parametrize("mesh", ["uniform", "jittered annulus"])
@pytest.mark.parametrize("model", MODELS)
def test_the_bound_holds_where_the_sheet_is_heading(model: str, mesh: str) -> None:
    """Masses are renewed only now and then; what the motion does until then is covered by `ahead` and SAFETY."""
    force = force_on(model, mesh)
    x, y = np.moveaxis(MESHES[mesh].u / MESHES[mesh].length_mm, 2, 0)
    here = state(mesh, "compressed")
    motions = {
        "stretches": 0.02 * np.stack([x, y, 0.0 * x]),
        "turns out of its plane": 0.2 * np.stack([0.0 * x, 0.0 * x, x]),
        "becomes tense across": 0.2 * np.stack([0.0 * x, y, 0.0 * x]),
    }
    for name, motion in motions.items():
        mass = nodal_masses(force, here, here + motion, force.relaxed)
        for share in (0.5, 1.0):
            largest = frequencies(force, here + share * motion, mass, all_free(MESHES[mesh]))[-1]
            assert largest <= LIMIT, (name, share)


@pytest.mark.parametrize("model", MODELS)
def test_a_mass_too_light_is_caught(model: str) -> None:
    force = force_on(model, "uniform")
    r = state("uniform", "stretched")
    mass = 0.2 * nodal_masses(force, r, r, force.relaxed)
    assert frequencies(force, r, mass, all_free(MESHES["uniform"]))[-1] > LIMIT


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("model", MODELS)
def test_masses_are_symmetric_positive_definite_and_inverted(model: str, mesh: str) -> None:
    force = force_on(model, mesh)
    for name in STATES:
        r = state(mesh, name)
        mass = nodal_masses(force, r, r, force.relaxed)
        sizes = np.linalg.eigvalsh(node_matrices(mass))
        assert sizes.min() > 0.0, name
        free = all_free(MESHES[mesh])
        free[0, 0] = False
        inverse = np.full_like(mass, np.nan)
        invert(mass.reshape(6, -1), free.reshape(-1), inverse.reshape(6, -1))
        product = node_matrices(mass) @ node_matrices(inverse)
        assert np.all(node_matrices(inverse)[0] == 0.0)
        # rounding of the inverse: 1e-16 times the condition of the mass, at most about 50
        np.testing.assert_allclose(product[1:], np.broadcast_to(np.eye(3), product[1:].shape), atol=1e-12)


@pytest.mark.parametrize("mesh", ["skewed", "annulus", "hole"])
@pytest.mark.parametrize("model", MODELS)
def test_masses_turn_with_the_sheet(model: str, mesh: str) -> None:
    """The mass of a turned sheet is the turned mass: the motion does not depend on the axes."""
    force = force_on(model, mesh)
    turn = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0]
    for name in STATES:
        r = state(mesh, name)
        ahead = r + 0.01 * state(mesh, "far")
        plain = node_matrices(nodal_masses(force, r, ahead, force.relaxed))
        turned_r, turned_ahead = (np.einsum("kl,lij->kij", turn, field) for field in (r, ahead))
        turned = node_matrices(nodal_masses(force, turned_r, turned_ahead, force.relaxed))
        expected = turn @ plain @ turn.T
        # rounding: differences of positions of size one over cells of a tenth, squared
        np.testing.assert_allclose(turned, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_an_unknown_kind_is_refused() -> None:
    force = force_on("membrane", "uniform")
    r = state("uniform", "flat")
    with pytest.raises(ValueError, match="nodal, isotropic or uniform, not 'light'"):
        nodal_masses(force, r, r, force.relaxed, "light")
