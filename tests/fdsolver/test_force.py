"""The kernels' force is the exact negative gradient of the reference energy, at edges and corners too."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver.curvature import curvature_constants
from fdsolver.effects import Force, build_force
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.plate import HOURGLASS_STRENGTH
from tensionfield.relaxed import TENSION_FIELD, Relaxed
from tests import reference
from tests.sample_meshes import inside, small_meshes

# thick, so that membrane and bending forces are alike in size
SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=5.0)
MESHES = small_meshes()
MODELS = {
    "koiter": KOITER,
    "membrane": MEMBRANE,
    "tension field": TENSION_FIELD,
    "relaxed with bending": Model("relaxed with bending", Relaxed, bending=True, relaxed=True),
}


def reference_energy(model: Model, grid: Grid, supports: dict[str, str]):
    """(membrane, bending, hourglass) energy of a state, by the reference formulas."""
    law = (reference.tension_field_law if model.relaxed else reference.koiter_law)(SHEET.poisson)
    if not model.bending:
        return lambda r: (reference.membrane_energy(r, grid, law), 0.0, 0.0)
    k = curvature_constants(grid, SHEET, supports)
    return lambda r: (
        reference.membrane_energy(r, grid, law),
        reference.bending_energy(r, grid, k),
        reference.hourglass_energy(r, grid, HOURGLASS_STRENGTH),
    )


def evaluate(force: Force, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force (ni, nj, 3) and (membrane, bending, hourglass) energy of the state r (ni, nj, 3), scaled."""
    f = np.full((3, *r.shape[:2]), np.nan)
    energy = force(np.ascontiguousarray(np.moveaxis(r, -1, 0)), f)
    return np.moveaxis(f, 0, -1), energy


def flat(grid: Grid) -> np.ndarray:
    """The undeformed sheet in space, scaled."""
    return np.pad(grid.u / grid.length_mm, ((0, 0), (0, 0), (0, 1)))


def rotation(seed: int) -> np.ndarray:
    """A random rotation of space."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else q @ np.diag([1.0, 1.0, -1.0])


def deformed(grid: Grid, noise: float, seed: int = 3) -> np.ndarray:
    """A stretched, compressed, bent and turned sheet with random displacements of `noise` cells on top."""
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    bent = np.stack(
        [1.4 * x + 0.2 * y, 0.8 * y + 0.1 * np.sin(3 * x), 0.2 * np.cos(4 * x - 3 * y) + x * y], axis=-1
    )
    cell = np.sqrt(grid.node_area)[..., None] / grid.length_mm
    return (bent + noise * cell * np.random.default_rng(seed).normal(size=bent.shape)) @ rotation(seed).T


def all_nodes(grid: Grid) -> np.ndarray:
    return np.array(list(np.ndindex(grid.ni, grid.nj)))


@pytest.mark.parametrize("noise", [0.0, 0.15])
@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", MODELS)
def test_force_is_the_gradient_of_the_energy_at_every_node(model: str, name: str, noise: float) -> None:
    grid = MESHES[name]
    r = deformed(grid, noise)
    energy = reference_energy(MODELS[model], grid, {})
    force, kernel_energy = evaluate(build_force(grid, SHEET, MODELS[model], {}), r)
    expected = -reference.gradient(lambda state: sum(energy(state)), r, all_nodes(grid)).reshape(force.shape)
    # rounding: condition of the sums over stencils, about 1e3 on the smallest zones
    np.testing.assert_allclose(force, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(kernel_energy, energy(r), rtol=1e-12)


@pytest.mark.parametrize("name", MESHES)
def test_force_on_a_sheet_with_clamped_edges(name: str) -> None:
    """Clamped edges lie in their plane; the rest is free to move anywhere."""
    grid = MESHES[name]
    supports = {edge: "clamped" for edge in ("left", "top", "hole", "outer") if edge in grid.edges}
    fixed = np.zeros((grid.ni, grid.nj), dtype=bool)
    for edge in supports:
        fixed[tuple(grid.edges[edge].T)] = True
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    stretched = flat(grid) @ np.diag([1.2, 0.9, 1.0])
    cell = np.sqrt(grid.node_area)[..., None] / grid.length_mm
    moved = 0.15 * cell * np.random.default_rng(3).normal(size=stretched.shape)
    moved[..., 2] += 0.2 * np.cos(4 * x - 3 * y)
    r = stretched + np.where(fixed[..., None], 0.0, moved)
    energy = reference_energy(KOITER, grid, supports)
    force, kernel_energy = evaluate(build_force(grid, SHEET, KOITER, supports), r)
    np.testing.assert_allclose(kernel_energy, energy(r), rtol=1e-12)
    nodes = np.argwhere(~fixed)
    expected = -reference.gradient(lambda state: sum(energy(state)), r, nodes)
    np.testing.assert_allclose(force[~fixed], expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", MODELS)
def test_energy_differences_follow_the_force(model: str, name: str) -> None:
    """The kernel's own energy and force agree, along random directions (extrapolated central differences)."""
    grid = MESHES[name]
    kernel = build_force(grid, SHEET, MODELS[model], {})
    r = deformed(grid, 0.05)
    force, _ = evaluate(kernel, r)
    random = np.random.default_rng(7)
    for _ in range(3):
        direction = random.normal(size=r.shape) * np.sqrt(grid.node_area)[..., None] / grid.length_mm
        estimates = []
        for step in (4e-4, 2e-4):
            up, down = (evaluate(kernel, r + sign * step * direction)[1].sum() for sign in (1, -1))
            estimates.append((up - down) / (2 * step))
        slope = (4 * estimates[1] - estimates[0]) / 3
        # some zones of the relaxed law change their state within the step: its energy is C1 only
        limit = 1e-4 if MODELS[model].relaxed else 1e-7
        scale = np.sum(np.abs(force * direction))
        assert -np.sum(force * direction) == pytest.approx(slope, rel=0, abs=limit * scale)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", MODELS)
def test_rigid_motions_cause_no_force(model: str, name: str) -> None:
    grid = MESHES[name]
    kernel = build_force(grid, SHEET, MODELS[model], {})
    scale = np.abs(evaluate(kernel, deformed(grid, 0.0))[0]).max()
    for seed in range(3):
        force, energy = evaluate(kernel, flat(grid) @ rotation(seed).T + [0.3, -0.2, 0.5])
        assert np.abs(force).max() < 1e-12 * scale
        assert np.all(np.abs(energy) < 1e-12 * scale)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", MODELS)
def test_forces_turn_with_the_sheet(model: str, name: str) -> None:
    grid = MESHES[name]
    kernel = build_force(grid, SHEET, MODELS[model], {})
    r = deformed(grid, 0.1)
    force, energy = evaluate(kernel, r)
    turn = rotation(11)
    turned_force, turned_energy = evaluate(kernel, r @ turn.T)
    np.testing.assert_allclose(turned_force, force @ turn.T, rtol=0, atol=1e-12 * np.abs(force).max())
    np.testing.assert_allclose(turned_energy, energy, rtol=1e-12)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", MODELS)
def test_a_free_sheet_exerts_no_total_force_or_moment(model: str, name: str) -> None:
    grid = MESHES[name]
    r = deformed(grid, 0.1)
    force, _ = evaluate(build_force(grid, SHEET, MODELS[model], {}), r)
    scale = np.abs(force).sum()
    assert np.abs(force.sum(axis=(0, 1))).max() < 1e-13 * scale
    assert np.abs(np.cross(r, force).sum(axis=(0, 1))).max() < 1e-13 * scale * np.abs(r).max()


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", ["jittered", "jittered annulus", "hole"])
def test_patch_of_distorted_zones_in_uniform_stress(model: str, name: str) -> None:
    """A uniform strain of any mesh, in any plane: no force inside, energy = area times density."""
    grid = MESHES[name]
    gradient = np.array(
        [[1.2, 0.1], [0.05, 1.1], [0.0, 0.0]]
    )  # tense: the relaxed law equals the unrelaxed one
    r = (grid.u / grid.length_mm) @ (rotation(2) @ gradient).T
    force, energy = evaluate(build_force(grid, SHEET, MODELS[model], {}), r)
    assert np.abs(force[inside(grid)]).max() < 1e-12 * np.abs(force).max()
    strain = (gradient.T @ gradient - np.eye(2)) / 2
    density = reference.koiter_law(SHEET.poisson)(strain[0, 0], strain[1, 1], strain[0, 1])
    assert energy[0] == pytest.approx(density * grid.zone_area.sum() / grid.length_mm**2, rel=1e-12)
    assert np.all(np.abs(energy[1:]) < 1e-20)


@pytest.mark.parametrize("name", ["jittered", "hole"])
@pytest.mark.parametrize("model", MODELS)
def test_threads_change_no_bit(model: str, name: str) -> None:
    grid = MESHES[name]
    r = deformed(grid, 0.1)
    one_force, one_energy = evaluate(build_force(grid, SHEET, MODELS[model], {}, threads=1), r)
    two_force, two_energy = evaluate(build_force(grid, SHEET, MODELS[model], {}, threads=2), r)
    np.testing.assert_array_equal(two_force, one_force)
    np.testing.assert_array_equal(two_energy, one_energy)


@pytest.mark.parametrize("model", MODELS)
def test_repeated_evaluations_are_the_same(model: str) -> None:
    """Nothing of an earlier state is left in the scratch rows."""
    grid = MESHES["hole"]
    kernel = build_force(grid, SHEET, MODELS[model], {})
    first, second = deformed(grid, 0.1, seed=3), deformed(grid, 0.1, seed=4)
    force, energy = evaluate(kernel, first)
    evaluate(kernel, second)
    evaluate(kernel, np.full_like(first, np.nan))
    again_force, again_energy = evaluate(kernel, first)
    np.testing.assert_array_equal(again_force, force)
    np.testing.assert_array_equal(again_energy, energy)
