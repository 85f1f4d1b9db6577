"""The kernel of the published scheme against the paper's formulas, continuum plates and the conservative scheme."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver import meshes
from fdsolver.effects import build_force
from fdsolver.grid import Grid, GridError
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE
from fdsolver.published_force import VARIANTS, PublishedForce, build_published, extended
from tests import published_reference as paper

SHEET = Sheet(
    young_MPa=3500.0, poisson=0.31, thickness_mm=5.0
)  # thick: membrane and bending forces alike in size
MESHES = {
    "uniform": meshes.rectangle(20.0, 12.0, 110),
    "biased": meshes.rectangle(20.0, 12.0, 110, bias=1.5),
    "long cells": meshes.rectangle(20.0, 12.0, 110, cell_ratio=3.0),
}


def published(
    grid: Grid, variant: str = "filtered", sheet: Sheet = SHEET, threads: int = 1, **edges: str
) -> PublishedForce:
    return build_published(grid, sheet, edges, build_force(grid, sheet, KOITER, edges, threads), variant)


def state(force: PublishedForce, grid: Grid, r: np.ndarray) -> np.ndarray:
    """r (ni, nj, 3), scaled, as a state with ghosts."""
    place = np.pad(np.moveaxis(r, -1, 0), ((0, 0), (1, 1), (1, 1)))
    force.ghosts.place(place)
    return place


def evaluate(force: PublishedForce, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces (ni, nj, 3) and energies."""
    f = np.full_like(place, np.nan)
    energy = force(place, f)
    assert not f[:, [0, -1]].any() and not f[:, :, [0, -1]].any(), "ghosts bear no force"
    return np.moveaxis(f[:, 1:-1, 1:-1], 0, -1), energy


def deformed(grid: Grid, noise: float = 0.0, seed: int = 3) -> np.ndarray:
    """A stretched, bent and turned sheet with random displacements of `noise` cells on top."""
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    bent = np.stack(
        [1.1 * x + 0.1 * y, 0.95 * y + 0.05 * np.sin(3 * x), 0.1 * np.cos(4 * x - 3 * y) + x * y], axis=-1
    )
    cell = np.sqrt(grid.node_area)[..., None] / grid.length_mm
    turned = bent + noise * cell * np.random.default_rng(seed).normal(size=bent.shape)
    return turned @ rotation(seed).T


def rotation(seed: int) -> np.ndarray:
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else q @ np.diag([1.0, 1.0, -1.0])


@pytest.mark.parametrize("noise", [0.0, 0.1])
@pytest.mark.parametrize("name", MESHES)
def test_force_is_that_of_the_paper_s_formulas(name: str, noise: float) -> None:
    grid = MESHES[name]
    force = published(grid)
    place = state(force, grid, deformed(grid, noise))
    place[:, :, 0] += 1e-3  # ghosts that are not where they are put at the start
    found, energy = evaluate(force, place)
    u, r = extended(grid).u / grid.length_mm, np.moveaxis(place, 0, -1)
    expected = paper.forces(r, u, SHEET.poisson, force.bending)
    # rounding of second differences over sums of a thousand terms
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    share = grid.node_area / grid.length_mm**2
    assert energy[1] == pytest.approx(
        paper.bending_energy(r, u, SHEET.poisson, force.bending, share), rel=1e-11
    )


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", MESHES)
def test_membrane_force_is_the_conservative_one(name: str, variant: str) -> None:
    """A sheet without thickness has no bending; what is left is the exact gradient of the membrane energy."""
    grid, thin = MESHES[name], Sheet(SHEET.young_MPa, SHEET.poisson, 1e-7)
    force = published(grid, variant, thin)
    r = deformed(grid, 0.1)
    found, energy = evaluate(force, state(force, grid, r))
    expected = np.zeros((3, grid.ni, grid.nj))
    conservative = build_force(grid, thin, MEMBRANE, {})(
        np.ascontiguousarray(np.moveaxis(r, -1, 0)), expected
    )
    # bending goes with (h / L)^2, here 1e-17
    np.testing.assert_allclose(
        found, np.moveaxis(expected, 0, -1), rtol=0, atol=1e-13 * np.abs(expected).max()
    )
    assert energy[0] == pytest.approx(conservative[0], rel=1e-13)


@pytest.mark.parametrize("variant", VARIANTS)
def test_rigid_motions_cause_no_force_and_forces_turn_with_the_sheet(variant: str) -> None:
    grid = MESHES["biased"]
    force = published(grid, variant)
    turn, shift = rotation(7), np.array([0.3, -0.2, 0.5])
    bent = deformed(grid, 0.1)
    f, energy = evaluate(force, state(force, grid, bent))
    scale = np.abs(f).max()
    flat = np.pad(grid.u / grid.length_mm, ((0, 0), (0, 0), (0, 1)))
    none, nothing = evaluate(force, state(force, grid, flat @ turn.T + shift))
    assert np.abs(none).max() < 1e-12 * scale and np.abs(nothing).max() < 1e-12 * energy.sum()
    turned, same = evaluate(force, state(force, grid, bent @ turn.T + shift))
    np.testing.assert_allclose(turned, f @ turn.T, rtol=0, atol=1e-11 * scale)
    np.testing.assert_allclose(same, energy, rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_free_sheet_exerts_no_total_force(variant: str) -> None:
    """What our rule for the corners, which the paper leaves open, is for."""
    grid = MESHES["biased"]
    force = published(grid, variant)
    f, _ = evaluate(force, state(force, grid, deformed(grid, 0.1)))
    assert np.abs(f.sum(axis=(0, 1))).max() < 1e-13 * np.abs(f).sum()


@pytest.mark.parametrize("variant", ["filtered", "stabilised"])
def test_small_deflections_feel_the_plate_operator_to_second_order(variant: str) -> None:
    """-D times the biharmonic of z = cos(p x) cos(q y), with uneven spacing."""
    p, q, height = 5.0, 7.0, 1e-6
    errors = []
    for nodes in (400, 1600, 6400):
        grid = meshes.rectangle(20.0, 12.0, nodes, bias=0.7)
        force = published(grid, variant)
        x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
        z = np.cos(p * x + 0.3) * np.cos(q * y)
        r = np.stack([x, y, height * z], axis=-1)
        f, _ = evaluate(force, state(force, grid, r))
        expected = -force.bending / (1.0 - SHEET.poisson**2) * (p**2 + q**2) ** 2 * height * z
        density = f[..., 2] * grid.length_mm**2 / grid.node_area
        inner = (np.abs(x) < 0.3) & (np.abs(y) < 0.18)  # the same part of every mesh, no ghost within reach
        errors.append(np.abs(density - expected)[inner].max() / np.abs(expected).max())
    orders = -np.diff(np.log(errors)) / np.log(2.0)
    assert errors[-1] < 0.01
    assert np.all(orders > 1.8), orders


def away_from_gradient(grid: Grid, strain: float, height: float) -> float:
    """Norm of bending force plus gradient of the bending energy over that of the gradient, away from the edges."""
    force = published(grid)
    u = extended(grid).u / grid.length_mm
    x, y = np.moveaxis(u, 2, 0)
    bent = np.stack([(1 - 0.4 * strain) * x, (1 + strain) * y, height * np.cos(3 * x - 2 * y)], -1)
    f = paper.forces(bent, u, SHEET.poisson, force.bending) - paper.forces(bent, u, SHEET.poisson, 0.0)
    nodes = [(i, j) for i in range(4, grid.ni - 4) for j in range(3, grid.nj - 3)]
    slopes = np.empty((len(nodes), 3))
    share = grid.node_area / grid.length_mm**2
    for row, (i, j) in zip(slopes, nodes, strict=True):
        for k in range(3):
            moved = bent.astype(complex)
            moved[i + 1, j + 1, k] += 1e-30j
            row[k] = paper.bending_energy(moved, u, SHEET.poisson, force.bending, share).imag / 1e-30
    return float(np.linalg.norm(f[tuple(np.transpose(nodes))] + slopes) / np.linalg.norm(slopes))


def test_the_force_is_a_gradient_but_for_the_strain_that_the_paper_neglects_in_its_metric() -> None:
    """Gamma of (65) takes the metric as that of zero strain; and zone means stand for nodal products."""
    grid = meshes.rectangle(20.0, 12.0, 110)
    assert away_from_gradient(grid, 0.0, 1e-3) < 1e-5
    # slopes of 0.3 are strains of 4 %; the measured shares of such sheets are 0.3 % to 2 %
    for strain in (0.0, 0.1):
        assert 0.003 < away_from_gradient(grid, strain, 0.1) < 0.02


def test_the_checkerboard_is_seen_by_the_stabilised_variant_only() -> None:
    grid = MESHES["uniform"]
    i, j = np.indices((grid.ni, grid.nj))
    flat = np.pad(grid.u / grid.length_mm, ((0, 0), (0, 0), (0, 1)))
    rough = flat.copy()
    rough[..., 2] += 1e-6 * (-1.0) ** (i + j)
    sizes = {}
    for variant in ("filtered", "stabilised"):
        force = published(grid, variant)
        sizes[variant] = np.abs(evaluate(force, state(force, grid, rough))[0][3:-3, 3:-3]).max()
    force = published(grid, "stabilised")
    # s = r_c - r_b - r_d + r_a is 4 z and g half of it: k 2 z / 2 pulls on each of the four corners of a node
    expected = 4.0 * force.hourglass[4, 4] * 1e-6
    assert sizes["stabilised"] == pytest.approx(expected, rel=1e-6)
    assert sizes["filtered"] < 1e-9 * expected


def test_the_stabilisation_leaves_uniform_curvature_and_twist_alone() -> None:
    grid = MESHES["biased"]
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    for z in (x * y, x * x, y * y):
        r = np.stack([x, y, 1e-5 * z], axis=-1)
        plain, stabilised = published(grid, "filtered"), published(grid, "stabilised")
        one, _ = evaluate(plain, state(plain, grid, r))
        two, energy = evaluate(stabilised, state(stabilised, grid, r))
        inner = (slice(2, -2), slice(2, -2))
        # quadratic in the deflection: 1e-5 of it
        assert np.abs(two - one)[inner].max() < 1e-8 * stabilised.hourglass.max()
        assert energy[2] < 1e-6 * energy[1]


def test_threads_change_no_bit() -> None:
    grid = MESHES["biased"]
    r = deformed(grid, 0.1)
    results = []
    for threads in (1, 2):
        force = published(grid, "stabilised", threads=threads)
        results.append(evaluate(force, state(force, grid, r)))
    np.testing.assert_array_equal(results[0][0], results[1][0])
    np.testing.assert_array_equal(results[0][1], results[1][1])


def test_other_meshes_and_variants_are_refused() -> None:
    grid = MESHES["uniform"]
    with pytest.raises(ValueError, match="printed, filtered, stabilised, not 'smoothed'"):
        published(grid, "smoothed")
    with pytest.raises(GridError, match="not on the shape annulus"):
        extended(meshes.annulus(60.0, 250.0, 110))
