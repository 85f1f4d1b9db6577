"""The energy, its gradient and its Hessian: against a plain second version, complex steps and differences."""

from __future__ import annotations

import numpy as np
import pytest

from femref.assembly import SheetEnergy
from femref.bicubic import Mesh, evaluate, flat
from femref.koiter import density, density_hessian, moduli
from tests.femref.sheets import POISSON, THICKNESS, YOUNG, plain_density, plain_gradient

SHEET = (YOUNG, POISSON, THICKNESS)
MESHES = {
    "rectangle": Mesh(np.array([0.0, 0.5, 1.2, 1.5]), np.array([-0.3, 0.1, 0.8])),
    "ring": Mesh(2.0 * np.pi * np.array([0.0, 0.15, 0.4, 0.6, 0.8]), np.array([1.0, 1.3, 2.0]), polar=True),
}


def strained(seed: int) -> np.ndarray:
    """Derivatives (5, 3) far from flat: strains and rotations of order one."""
    d = 0.5 * np.random.default_rng(seed).standard_normal((5, 3))
    d[0, 0] += 1.0
    d[1, 1] += 1.0
    return d


def moved(mesh: Mesh, seed: int = 0) -> np.ndarray:
    q = flat(mesh)
    return q + 0.05 * np.random.default_rng(seed).standard_normal(q.shape)


@pytest.mark.parametrize("seed", range(5))
def test_density_and_gradient_are_those_of_the_plain_version(seed):
    d, gradient = strained(seed), np.empty((5, 3))
    found = density(d, moduli(*SHEET), False, gradient)
    assert found == pytest.approx(plain_density(d, *SHEET), rel=1e-13)  # rounding
    assert gradient == pytest.approx(plain_gradient(d, *SHEET), rel=1e-11, abs=1e-12)  # rounding


@pytest.mark.parametrize("membrane_only", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_hessian_agrees_with_differences_of_the_gradient(seed, membrane_only):
    d, hessian, found = strained(seed), np.empty((15, 15)), np.empty((15, 15))
    density_hessian(d, moduli(*SHEET), membrane_only, hessian)
    step = 1e-3  # sixth-order central differences: an error of step^6 and of rounding over step
    for k in range(15):
        column = np.zeros(15)
        for times, weight in ((1, 45.0), (2, -9.0), (3, 1.0)):
            for sign in (-1.0, 1.0):
                at, gradient = d.ravel().copy(), np.empty((5, 3))
                at[k] += sign * times * step
                density(at.reshape(5, 3), moduli(*SHEET), membrane_only, gradient)
                column += sign * weight * gradient.ravel() / (60.0 * step)
        found[k] = column
    scale = np.abs(hessian).max()
    assert np.abs(found - hessian).max() < 1e-8 * scale
    assert np.abs(hessian - hessian.T).max() < 1e-14 * scale  # rounding


@pytest.mark.parametrize("shape", MESHES)
def test_assembled_gradient_and_hessian_agree_with_differences(shape):
    energy = SheetEnergy(MESHES[shape], *SHEET)
    q = moved(energy.mesh)
    random = np.random.default_rng(2)
    direction, hessian = random.standard_normal(q.shape), energy.hessian(q)
    step = 1e-4

    def differences(function):
        pairs = ((1, 45.0), (2, -9.0), (3, 1.0))
        terms = [
            w * (function(q + n * step * direction) - function(q - n * step * direction)) for n, w in pairs
        ]
        return sum(terms) / (60.0 * step)

    slope = (energy.gradient(q) * direction).sum()
    assert slope == pytest.approx(
        differences(lambda at: energy.energy(at).sum()), rel=1e-9
    )  # rounding / step
    product = hessian @ direction.ravel()
    change = differences(energy.gradient).ravel()
    assert np.abs(product - change).max() < 1e-8 * np.abs(product).max()
    assert abs(hessian - hessian.T).max() < 1e-13 * abs(hessian).max()  # rounding


def test_energy_is_that_of_the_plain_version_by_another_quadrature():
    """The bicubic field evaluated place by place, its plain density integrated on finer Gauss points."""
    energy = SheetEnergy(MESHES["rectangle"], *SHEET)
    q = flat(energy.mesh)
    q[1:-1, :, :, :] += 0.02 * np.random.default_rng(3).standard_normal(q[1:-1].shape)
    points, weights = np.polynomial.legendre.leggauss(12)
    total = np.zeros(2)
    x, y = energy.mesh.breaks
    for a, b in zip(x[:-1], x[1:], strict=True):
        for c, d in zip(y[:-1], y[1:], strict=True):
            at_x, at_y = np.meshgrid(0.5 * (a + b + (b - a) * points), 0.5 * (c + d + (d - c) * points))
            area = 0.25 * (b - a) * (d - c) * np.outer(weights, weights).ravel()
            orders = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
            derivatives = [evaluate(energy.mesh, q, at_x.ravel(), at_y.ravel(), *order) for order in orders]
            total += area @ plain_density(np.stack(derivatives, axis=1), *SHEET)
    # the integrand is no polynomial, so four Gauss points per direction leave an error of their own
    assert energy.energy(q) == pytest.approx(total, rel=2e-4)


@pytest.mark.parametrize("shape", MESHES)
def test_rigid_motions_change_nothing_and_cost_nothing(shape):
    energy = SheetEnergy(MESHES[shape], *SHEET)
    q = moved(energy.mesh)
    random = np.random.default_rng(4)
    rotation = np.linalg.qr(random.standard_normal((3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    turned = q @ rotation.T
    turned[:, :, 0] += random.standard_normal(3)
    assert energy.energy(turned) == pytest.approx(energy.energy(q), rel=1e-13)  # rounding
    gradient = energy.gradient(q)
    assert energy.gradient(turned) == pytest.approx(gradient @ rotation.T, abs=1e-12)  # rounding
    assert np.abs(gradient[:, :, 0].sum(axis=(0, 1))).max() < 1e-13  # no force
    assert np.abs(np.cross(q, gradient).sum(axis=(0, 1, 2))).max() < 1e-13  # no moment


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_patch_test_a_uniform_strain_is_in_equilibrium(poisson):
    """Uniform stretch and shear: no force on any inner unknown, and the closed-form energy."""
    energy = SheetEnergy(MESHES["rectangle"], YOUNG, poisson, THICKNESS)
    gradient = np.array([[1.1, 0.2], [-0.1, 0.95], [0.3, 0.1]])
    q = flat(energy.mesh)[..., :2] @ gradient.T
    force = energy.gradient(q)
    assert np.abs(force[1:-1, 1:-1]).max() < 1e-14  # rounding
    assert np.abs(force).max() > 1e-2  # the edges carry it
    d = np.zeros((5, 3))
    d[:2] = gradient.T
    wanted = 1.5 * 1.1 * plain_density(d, YOUNG, poisson, THICKNESS)
    assert energy.energy(q) == pytest.approx(wanted, rel=1e-13, abs=1e-28)  # rounding


def test_mass_matrix_integrates_squares():
    mesh = MESHES["ring"]
    one = np.zeros((*mesh.shape, 4, 3))
    one[:, :, 0, 1] = 1.0
    area = one.ravel() @ SheetEnergy(mesh, *SHEET).mass @ one.ravel()
    assert area == pytest.approx(
        np.pi * (2.0**2 - 1.0**2), rel=1e-13
    )  # radius times angle is integrated exactly


def test_membrane_alone_has_no_bending():
    energy = SheetEnergy(MESHES["rectangle"], *SHEET, bending=False)
    full = SheetEnergy(MESHES["rectangle"], *SHEET)
    q = moved(energy.mesh)
    assert energy.energy(q)[1] == 0.0 and energy.energy(q)[0] == full.energy(q)[0]


@pytest.mark.parametrize("sheet", [(0.0, 0.3, 1.0), (1.0, 0.51, 1.0), (1.0, -1.0, 1.0), (1.0, 0.3, 0.0)])
def test_sheets_without_meaning_are_refused(sheet):
    with pytest.raises(ValueError, match="a sheet needs"):
        moduli(*sheet)
