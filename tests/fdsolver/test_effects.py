"""Effects left out: each specialised force is the exact negative gradient of an energy of its own."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from fdsolver.curvature import curvature_constants
from fdsolver.effects import Force, build_force
from fdsolver.fields import zone_fields
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.plate import HOURGLASS_STRENGTH
from tensionfield.relaxed import TENSION_FIELD
from tests import reference
from tests.reference_effects import linear_bending_energy, moderate_membrane_energy, plane_hourglass_energy
from tests.sample_meshes import small_meshes

# thick, so that membrane and bending forces are alike in size
SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=5.0)
MESHES = small_meshes()
SPACE = {
    "normal of the flat sheet": dataclasses.replace(KOITER, strain_gradient=False),
    "moderate rotations": dataclasses.replace(KOITER, moderate=True),
    "moderate rotations, membrane": dataclasses.replace(MEMBRANE, moderate=True),
    "moderate rotations, tension field": dataclasses.replace(TENSION_FIELD, moderate=True),
}
PLANE = {
    "membrane in its plane": dataclasses.replace(MEMBRANE, out_of_plane=False),
    "tension field in its plane": dataclasses.replace(TENSION_FIELD, out_of_plane=False),
    "plate in its plane": dataclasses.replace(KOITER, out_of_plane=False),
    "moderate, in its plane": dataclasses.replace(MEMBRANE, out_of_plane=False, moderate=True),
    "moderate plate in its plane": dataclasses.replace(KOITER, out_of_plane=False, moderate=True),
}


def reference_energy(model: Model, grid: Grid, supports: dict[str, str]):
    """(membrane, bending, hourglass) energy of a state (ni, nj, 3), by formulas that share nothing with the kernels."""
    law = (reference.tension_field_law if model.relaxed else reference.koiter_law)(SHEET.poisson)
    strained = moderate_membrane_energy if model.moderate else reference.membrane_energy
    if not model.bending:
        return lambda r: (strained(r, grid, law), 0.0, 0.0)
    if not model.out_of_plane:
        return lambda r: (strained(r, grid, law), 0.0, plane_hourglass_energy(r, grid, HOURGLASS_STRENGTH))
    k = curvature_constants(grid, SHEET, supports)
    return lambda r: (
        strained(r, grid, law),
        linear_bending_energy(r, grid, k),
        plane_hourglass_energy(r, grid, HOURGLASS_STRENGTH),
    )


def state(grid: Grid, seed: int = 3) -> np.ndarray:
    """A stretched, sheared, compressed, bent sheet with random displacements on top; (ni, nj, 3), scaled."""
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    bent = np.stack(
        [1.3 * x + 0.2 * y, 0.9 * y + 0.1 * np.sin(3 * x), 0.2 * np.cos(4 * x - 3 * y) + x * y], axis=-1
    )
    cell = np.sqrt(grid.node_area)[..., None] / grid.length_mm
    return bent + 0.1 * cell * np.random.default_rng(seed).normal(size=bent.shape)


def evaluate(force: Force, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force (ni, nj, components) and (membrane, bending, hourglass) energy at the state r (ni, nj, 3)."""
    place = np.ascontiguousarray(np.moveaxis(r, -1, 0)[: force.components])
    f = np.full_like(place, np.nan)
    energy = force(place, f)
    return np.moveaxis(f, 0, -1), energy


def all_nodes(grid: Grid) -> np.ndarray:
    return np.array(list(np.ndindex(grid.ni, grid.nj)))


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", SPACE)
def test_force_is_the_gradient_of_the_energy_at_every_node(model: str, name: str) -> None:
    grid, r = MESHES[name], state(MESHES[name])
    energy = reference_energy(SPACE[model], grid, {})
    force, kernel_energy = evaluate(build_force(grid, SHEET, SPACE[model], {}), r)
    expected = -reference.gradient(lambda place: sum(energy(place)), r, all_nodes(grid)).reshape(force.shape)
    # rounding: condition of the sums over stencils, about 1e3 on the smallest zones
    np.testing.assert_allclose(force, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(kernel_energy, energy(r), rtol=1e-12)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", PLANE)
def test_planar_force_is_the_gradient_of_the_energy_of_a_flat_state(model: str, name: str) -> None:
    grid, r = MESHES[name], state(MESHES[name])
    r[..., 2] = 0.0
    energy = reference_energy(PLANE[model], grid, {})
    force, kernel_energy = evaluate(build_force(grid, SHEET, PLANE[model], {}), r)
    gradient = -reference.gradient(lambda place: sum(energy(place)), r, all_nodes(grid))
    expected = gradient.reshape(*force.shape[:2], 3)
    assert force.shape[2] == 2
    assert np.abs(expected[..., 2]).max() == 0.0  # by symmetry: nothing is missed in the plane
    np.testing.assert_allclose(force, expected[..., :2], rtol=0, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(kernel_energy, energy(r), rtol=1e-12)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("moderate", [False, True])
def test_a_plate_in_its_plane_has_the_energies_and_forces_of_the_flat_plate(
    moderate: bool, name: str
) -> None:
    """Out-of-plane motion left out of a plate leaves the same discrete energy, hourglass stiffness included."""
    grid, r = MESHES[name], state(MESHES[name])
    r[..., 2] = 0.0
    space = dataclasses.replace(KOITER, moderate=moderate)
    plane = dataclasses.replace(space, out_of_plane=False)
    (flat, flat_energy), (part, energy) = (
        evaluate(build_force(grid, SHEET, model, {}), r) for model in (space, plane)
    )
    np.testing.assert_allclose(part, flat[..., :2], rtol=0, atol=1e-13 * np.abs(flat).max())
    np.testing.assert_allclose(energy, flat_energy, rtol=1e-13, atol=1e-30)
    assert (
        energy[2] > 1e-4 * energy[0]
    )  # random displacements are in part checkerboards: there is something to lose


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", ["normal of the flat sheet", "moderate rotations"])
def test_force_on_a_sheet_with_clamped_edges(model: str, name: str) -> None:
    grid, r = MESHES[name], state(MESHES[name])
    supports = {edge: "clamped" for edge in ("left", "top", "hole", "outer") if edge in grid.edges}
    fixed = np.zeros((grid.ni, grid.nj), dtype=bool)
    for edge in supports:
        fixed[tuple(grid.edges[edge].T)] = True
    energy = reference_energy(SPACE[model], grid, supports)
    force, kernel_energy = evaluate(build_force(grid, SHEET, SPACE[model], supports), r)
    expected = -reference.gradient(lambda place: sum(energy(place)), r, np.argwhere(~fixed))
    np.testing.assert_allclose(force[~fixed], expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(kernel_energy, energy(r), rtol=1e-12)


@pytest.mark.parametrize("name", MESHES)
def test_the_linear_curvature_is_the_full_one_to_first_order_in_the_deflection(name: str) -> None:
    """On the flat sheet both plates bend alike; they part with the square of the slope."""
    grid = MESHES[name]
    full, linear = (
        build_force(grid, SHEET, model, {}) for model in (KOITER, SPACE["normal of the flat sheet"])
    )
    flat = np.pad(grid.u / grid.length_mm, ((0, 0), (0, 0), (0, 1)))
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    differences = []
    for height in (2e-3, 1e-3):
        r = flat.copy()
        r[..., 2] = height * np.cos(4 * x - 3 * y)
        pair = [evaluate(force, r)[1][1] for force in (full, linear)]
        differences.append(abs(pair[0] / pair[1] - 1.0))
    assert differences[1] < 1e-3
    assert differences[0] / differences[1] == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize("name", MESHES)
def test_affine_tilts_do_not_bend(name: str) -> None:
    grid = MESHES[name]
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    r = np.stack([1.1 * x, 0.9 * y + 0.1 * x, 0.3 * x - 0.2 * y], axis=-1)
    _, energy = evaluate(build_force(grid, SHEET, SPACE["normal of the flat sheet"], {}), r)
    assert abs(energy[1]) < 1e-24  # rounding squared: the moduli are of order one


@pytest.mark.parametrize("name", ["jittered", "hole"])
@pytest.mark.parametrize("model", [*SPACE, *PLANE])
def test_threads_change_no_bit(model: str, name: str) -> None:
    grid, chosen = MESHES[name], {**SPACE, **PLANE}[model]
    one, two = (evaluate(build_force(grid, SHEET, chosen, {}, threads), state(grid)) for threads in (1, 2))
    np.testing.assert_array_equal(two[0], one[0])
    np.testing.assert_array_equal(two[1], one[1])


@pytest.mark.parametrize("model", [*SPACE, *PLANE])
def test_repeated_evaluations_are_the_same(model: str) -> None:
    """Nothing of an earlier state is left in the scratch rows."""
    grid = MESHES["hole"]
    kernel = build_force(grid, SHEET, {**SPACE, **PLANE}[model], {})
    force, energy = evaluate(kernel, state(grid))
    evaluate(kernel, np.full((*grid.u.shape[:2], 3), np.nan))
    again_force, again_energy = evaluate(kernel, state(grid))
    np.testing.assert_array_equal(again_force, force)
    np.testing.assert_array_equal(again_energy, energy)


@pytest.mark.parametrize("name", ["jittered", "annulus"])
def test_stresses_shown_are_those_of_the_kinematics(name: str) -> None:
    """Energy of the zones' principal stresses and strains: that of the kernel."""
    grid, r = MESHES[name], state(MESHES[name])
    model = SPACE["moderate rotations, membrane"]
    fields = zone_fields(grid, SHEET, r * grid.length_mm, relaxed=False, moderate=True)
    major, minor = (0.5 * (stretch**2 - 1.0) for stretch in (fields.stretch_major, fields.stretch_minor))
    # strains below -1/2 have no stretch; the state has none
    density = 0.5 * (fields.stress_major * major + fields.stress_minor * minor) / SHEET.young_MPa
    _, energy = evaluate(build_force(grid, SHEET, model, {}), r)
    assert (density * grid.zone_area).sum() / grid.length_mm**2 == pytest.approx(energy[0], rel=1e-12)
