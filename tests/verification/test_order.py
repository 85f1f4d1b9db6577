"""Energies and weak forces of smooth deformations against quadrature of the continuum: second order.

The deformations are smooth maps r(u) of finite strain, rotation and curvature. Their deflection vanishes to
third order at the edges, so that they carry no edge moment and the energy does not depend on the supports.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fdsolver import meshes
from fdsolver.effects import build_force
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER

SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=5.0)
NODES = (2000, 8000, 32000)
LEAST_ORDER = 1.8
Field = Callable[[np.ndarray, np.ndarray], np.ndarray]  # (x, y) scaled -> (..., 3)

MESHES: dict[str, Callable[[int], Grid]] = {
    "uniform": lambda nodes: meshes.rectangle(20.0, 12.0, nodes),
    "graded": lambda nodes: meshes.rectangle(20.0, 12.0, nodes, bias=1.5),
    "annulus": lambda nodes: meshes.annulus(60.0, 250.0, nodes),
    "hole": lambda nodes: meshes.rectangle_with_hole(125.0, 50.0, 15.0, nodes),
}


def bubble(grid: Grid, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A smooth function that vanishes to third order at every edge of the sheet, at most about 1."""
    size = np.abs(grid.u).max(axis=(0, 1)) / grid.length_mm
    if grid.shape == "annulus":
        inner = 60.0 / 250.0
        radius = np.sqrt(x**2 + y**2)
        return (4 * (radius - inner) * (1 - radius) / (1 - inner) ** 2) ** 3
    inside = (1 - (x / size[0]) ** 2) * (1 - (y / size[1]) ** 2)
    if grid.shape == "rectangle-with-hole":
        inside = 2 * inside * (1 - (15.0 / 125.0) ** 2 / (x**2 + y**2))
    return inside**3


def deformation(grid: Grid) -> Field:
    """Stretch, shear, smooth in-plane waves and a deflection of a tenth of the sheet."""

    def r(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        z = 0.05 * bubble(grid, x, y) * np.cos(7 * x - 4 * y + 0.3)
        return np.stack([1.1 * x + 0.03 * np.sin(5 * y), 0.95 * y + 0.03 * np.sin(4 * x + y), z], axis=-1)

    return r


def variation(grid: Grid) -> Field:
    """A smooth virtual displacement; its deflection vanishes like that of the deformation."""

    def v(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        z = bubble(grid, x, y) * np.sin(5 * x + 6 * y + 1.0)
        return np.stack([np.cos(4 * x + y), np.sin(3 * x - 4 * y), z], axis=-1)

    return v


def quadrature(grid: Grid, points: int = 40) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points x, y and weights of a Gauss rule on the sheet itself (not on its mesh), scaled."""
    s, w = np.polynomial.legendre.leggauss(points)
    half_width, half_height = np.abs(grid.u).max(axis=(0, 1)) / grid.length_mm
    if grid.shape == "rectangle":
        x, y = np.meshgrid(half_width * s, half_height * s, indexing="ij")
        return x, y, half_width * half_height * np.outer(w, w)
    corner = np.arctan2(half_height, half_width)
    if grid.shape == "annulus":
        inner, cuts = 60.0 / 250.0, np.linspace(0, 2 * np.pi, 9)
    else:
        inner = 15.0 / 125.0
        cuts = np.array([-corner, 0, corner, np.pi / 2, np.pi - corner, np.pi, np.pi + corner, 1.5 * np.pi])
        cuts = np.append(cuts, 2 * np.pi - corner)
    x_all, y_all, w_all = [], [], []
    for low, high in zip(cuts[:-1], cuts[1:], strict=True):
        angle, angle_weight = (low + high) / 2 + (high - low) / 2 * s, (high - low) / 2 * w
        outer = np.ones_like(angle)
        if grid.shape != "annulus":
            outer = np.minimum(half_width / np.abs(np.cos(angle)), half_height / np.abs(np.sin(angle)))
        radius = (outer + inner)[:, None] / 2 + (outer - inner)[:, None] / 2 * s
        x_all.append(radius * np.cos(angle)[:, None])
        y_all.append(radius * np.sin(angle)[:, None])
        w_all.append(angle_weight[:, None] * (outer - inner)[:, None] / 2 * w * radius)
    return np.concatenate(x_all), np.concatenate(y_all), np.concatenate(w_all)


def derivatives(r: Field, x: np.ndarray, y: np.ndarray) -> list[np.ndarray]:
    """r,1 r,2 r,11 r,22 r,12 by sixth-order differences: errors 1e-11 at this step, rounding included."""
    step = 4e-3
    weights = {-3: -1 / 60, -2: 3 / 20, -1: -3 / 4, 1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    second = {-3: 1 / 90, -2: -3 / 20, -1: 3 / 2, 0: -49 / 18, 1: 3 / 2, 2: -3 / 20, 3: 1 / 90}
    r_1 = sum(w * r(x + k * step, y) for k, w in weights.items()) / step
    r_2 = sum(w * r(x, y + k * step) for k, w in weights.items()) / step
    r_11 = sum(w * r(x + k * step, y) for k, w in second.items()) / step**2
    r_22 = sum(w * r(x, y + k * step) for k, w in second.items()) / step**2
    r_12 = sum(w * v * r(x + k * step, y + m * step) for k, w in weights.items() for m, v in weights.items())
    return [r_1, r_2, r_11, r_22, r_12 / step**2]


def exact_energy(grid: Grid, r: Field) -> np.ndarray:
    """(membrane, bending) energy of Eq. 24 by quadrature, scaled."""
    x, y, weight = quadrature(grid)
    r_1, r_2, r_11, r_22, r_12 = derivatives(r, x, y)
    nu = SHEET.poisson

    def density(a11: np.ndarray, a22: np.ndarray, a12: np.ndarray) -> np.ndarray:
        trace = nu / (1 - nu**2) * (a11 + a22) ** 2
        return (trace + (a11**2 + a22**2 + 2 * a12**2) / (1 + nu)) / 2

    normal = np.cross(r_1, r_2)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    e11, e22, e12 = (np.sum(a * b, axis=-1) for a, b in ((r_1, r_1), (r_2, r_2), (r_1, r_2)))
    b11, b22, b12 = (np.sum(normal * second, axis=-1) for second in (r_11, r_22, r_12))
    thickness = SHEET.thickness_mm / grid.length_mm
    membrane = np.sum(weight * density((e11 - 1) / 2, (e22 - 1) / 2, e12 / 2))
    return np.array([membrane, thickness**2 / 12 * np.sum(weight * density(b11, b22, b12))])


def exact_work(grid: Grid) -> float:
    """Variation of the total energy along the virtual displacement, by differences of the quadrature."""
    r, v = deformation(grid), variation(grid)

    def difference(step: float) -> float:
        up, down = (exact_energy(grid, lambda x, y, e=e: r(x, y) + e * v(x, y)).sum() for e in (step, -step))
        return (up - down) / (2 * step)

    return (4 * difference(1e-4) - difference(2e-4)) / 3


def discrete(grid: Grid) -> tuple[np.ndarray, float]:
    """(membrane, bending, hourglass) energy and virtual work of the kernel."""
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    r = np.ascontiguousarray(np.moveaxis(deformation(grid)(x, y), -1, 0))
    force = np.empty_like(r)
    energy = build_force(grid, SHEET, KOITER, {})(r, force)
    return energy, -float(np.sum(np.moveaxis(force, 0, -1) * variation(grid)(x, y)))


def orders(errors: list[float], grids: list[Grid]) -> np.ndarray:
    """Observed orders between successive meshes, from the actual node counts."""
    return np.diff(np.log(np.abs(errors))) / np.diff([-0.5 * np.log(grid.nodes) for grid in grids])


@pytest.mark.parametrize("name", MESHES)
def test_energies_and_virtual_work_are_second_order(name: str) -> None:
    grids = [MESHES[name](nodes) for nodes in NODES]
    energy, work = exact_energy(grids[0], deformation(grids[0])), exact_work(grids[0])
    found = [discrete(grid) for grid in grids]
    errors = {
        "membrane": [parts[0] / energy[0] - 1 for parts, _ in found],
        "bending": [parts[1] / energy[1] - 1 for parts, _ in found],
        "hourglass": [parts[2] / energy.sum() for parts, _ in found],
        "work": [value / work - 1 for _, value in found],
    }
    for quantity, error in errors.items():
        observed = orders(error, grids)
        print(f"{name:10s} {quantity:10s} errors {error} orders {observed}")
        assert observed[-1] > LEAST_ORDER, f"{quantity}: errors {error}"
        assert abs(error[-1]) < 1e-2, f"{quantity}: errors {error}"
