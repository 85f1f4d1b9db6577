"""Small deflections of plates under load against closed forms: second order at every kind of edge.

All lengths are scaled by L; a load p (per Y h / L) makes D_s times the biharmonic of w equal to p, where
D_s = (h/L)^2 / (12 (1 - nu^2)).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import convolve2d

from fdsolver import meshes
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER
from tests.linear import edge_nodes, solve, stiffness

SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=5.0)
NU = SHEET.poisson
LEAST_ORDER = 1.8
Surface = Callable[[np.ndarray, np.ndarray], np.ndarray]


def errors_of(
    make: Callable[[int], Grid],
    counts: tuple[int, ...],
    supports: dict[str, str],
    load: Surface,
    exact: Surface,
) -> tuple[list[float], list[float], list[Grid]]:
    """Largest error of the deflection off kinks, and on them.

    Relative to the deflection that the load would cause if it all pushed one way: manufactured loads nearly
    balance themselves.
    """
    off, on, grids = [], [], [make(nodes) for nodes in counts]
    for grid in grids:
        x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
        area = grid.node_area / grid.length_mm**2
        plate = (SHEET.thickness_mm / grid.length_mm) ** 2 / (12 * (1 - NU**2))
        fixed = edge_nodes(grid, tuple(name for name, support in supports.items() if support != "free"))
        matrix = stiffness(grid, SHEET, KOITER, supports, axes=(2,))
        force = plate * area * load(x, y)
        found, one_way = (solve(matrix, f[None], fixed)[0] for f in (force, np.abs(force)))
        error = np.abs(found - exact(x, y)) / np.abs(one_way).max()
        kink = np.any(np.abs(grid.xi[:, None] - np.array(grid.breaks)) < 1e-9, axis=1)
        off.append(error[~kink].max())
        on.append(error[kink].max() if kink.any() else 0.0)
    return off, on, grids


def assert_second_order(name: str, errors: list[float], grids: list[Grid], largest: float) -> None:
    observed = np.diff(np.log(errors)) / np.diff([-0.5 * np.log(grid.nodes) for grid in grids])
    print(f"{name:36s} errors {np.array(errors)} orders {observed}")
    assert observed[-1] > LEAST_ORDER, f"{name}: errors {errors}"
    assert errors[-1] < largest, f"{name}: errors {errors}"


RECTANGLES = {
    "uniform": lambda nodes: meshes.rectangle(20.0, 12.0, nodes),
    "graded": lambda nodes: meshes.rectangle(20.0, 12.0, nodes, bias=1.0),
}


@pytest.mark.parametrize("mesh", RECTANGLES)
def test_simply_supported_rectangle(mesh: str) -> None:
    """Navier: one sine in each direction."""
    k_x, k_y = np.pi, np.pi * 20.0 / 12.0

    def exact(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.cos(k_x * x) * np.cos(k_y * y)

    supports = dict.fromkeys(("left", "right", "bottom", "top"), "pinned")
    result = errors_of(
        RECTANGLES[mesh],
        (500, 2000, 8000),
        supports,
        lambda x, y: (k_x**2 + k_y**2) ** 2 * exact(x, y),
        exact,
    )
    assert_second_order(f"simply supported, {mesh}", result[0], result[2], 2e-3)


@pytest.mark.parametrize("mesh", RECTANGLES)
@pytest.mark.parametrize("long_edges", ["free", "clamped"])
def test_levy_strip(mesh: str, long_edges: str) -> None:
    """Levy: the short edges are pinned, w = (1 + A cosh ky + B ky sinh ky) cos kx under the load cos kx."""
    k = np.pi
    c = k * 0.5 * 12.0 / 20.0
    cosh, sinh = np.cosh(c), np.sinh(c)
    if long_edges == "clamped":
        system, right = [[cosh, c * sinh], [sinh, sinh + c * cosh]], [-1.0, 0.0]
    else:  # w,yy + nu w,xx = 0 and w,yyy + (2 - nu) w,xxy = 0
        system = [
            [(1 - NU) * cosh, 2 * cosh + (1 - NU) * c * sinh],
            [-(1 - NU) * sinh, (1 + NU) * sinh - (1 - NU) * c * cosh],
        ]
        right = [NU, 0.0]
    a, b = np.linalg.solve(system, right)

    def exact(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return (1 + a * np.cosh(k * y) + b * k * y * np.sinh(k * y)) * np.cos(k * x) / k**4

    supports = {"left": "pinned", "right": "pinned", "bottom": long_edges, "top": long_edges}
    result = errors_of(RECTANGLES[mesh], (500, 2000, 8000), supports, lambda x, y: np.cos(k * x), exact)
    assert_second_order(f"Levy, long edges {long_edges}, {mesh}", result[0], result[2], 1e-2)


def radial_conditions(support: str, radius: float, m: int) -> Callable[[float], list[float]]:
    """The two edge conditions on R^n cos(m angle) at a radius, as functions of n."""

    def conditions(n: complex) -> list[complex]:
        w, slope, second = radius**n, n * radius ** (n - 1), n * (n - 1) * radius ** (n - 2)
        moment = second + NU * (slope / radius - m**2 * w / radius**2)
        if support == "pinned":
            return [w, moment]
        if support == "clamped":
            return [w, slope]
        # Kirchhoff's edge force: (laplacian w),r + (1 - nu)/r (w,r/r - w/r^2),angle angle
        laplacian_slope = (n**2 - m**2) * (n - 2) * radius ** (n - 3)
        return [moment, laplacian_slope - (1 - NU) * m**2 / radius * (slope / radius - w / radius**2)]

    return conditions


def annular_plate(inner: str, outer: str, m: int) -> tuple[Surface, Surface]:
    """Load R^2 cos(m angle) and deflection, for radii 0.24 and 1; m = 0 and 1 have logarithms, so m >= 2."""
    conditions = [radial_conditions(inner, 0.24, m), radial_conditions(outer, 1.0, m)]
    powers = [m, -m, m + 2, 2 - m]
    particular = 1.0 / ((36 - m**2) * (16 - m**2))  # of R^6 cos(m angle)
    system = np.array([[condition(n)[row] for n in powers] for condition in conditions for row in range(2)])
    right = np.array([-particular * condition(6)[row] for condition in conditions for row in range(2)])
    factors = np.linalg.solve(system, right)

    def exact(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        radius, angle = np.hypot(x, y), np.arctan2(y, x)
        shape = particular * radius**6 + sum(
            a * radius ** float(n) for a, n in zip(factors, powers, strict=True)
        )
        return shape * np.cos(m * angle)

    return (lambda x, y: (x**2 + y**2) * np.cos(m * np.arctan2(y, x))), exact


@pytest.mark.parametrize(
    ("inner", "outer"),
    [
        ("pinned", "pinned"),
        ("free", "pinned"),
        ("pinned", "free"),
        ("clamped", "clamped"),
        ("free", "clamped"),
    ],
)
def test_annular_plate(inner: str, outer: str) -> None:
    """Edges that are curved, with the load R^2 cos 3 angle: all three moments act."""
    load, exact = annular_plate(inner, outer, m=3)
    supports = {"inner": inner, "outer": outer}
    result = errors_of(
        lambda nodes: meshes.annulus(60.0, 250.0, nodes), (1000, 4000, 16000), supports, load, exact
    )
    assert_second_order(f"annulus, {inner} inside, {outer} outside", result[0], result[2], 1e-2)


def biharmonic(c: np.ndarray) -> np.ndarray:
    """Coefficients of the biharmonic of the polynomial sum of c[m, n] x^m y^n."""
    laplacian = c
    for _ in range(2):
        padded = np.pad(laplacian, ((0, 2), (0, 2)))
        along_x = np.polynomial.polynomial.polyder(padded, 2, axis=0)
        along_y = np.polynomial.polynomial.polyder(padded, 2, axis=1)
        laplacian = along_x[: c.shape[0], : c.shape[1]] + along_y[: c.shape[0], : c.shape[1]]
    return laplacian


def polynomial(hole_power: int, edge_power: int) -> np.ndarray:
    """(R^2 - a^2)^p ((1 - X^2)(1 - Y^2))^q, which vanishes to these orders at the hole and the rectangle."""
    half_width, half_height, radius = 0.5, 0.2, 15.0 / 125.0
    hole = np.zeros((3, 3))
    hole[0, 0], hole[2, 0], hole[0, 2] = -(radius**2), 1.0, 1.0
    edge = np.outer([1.0, 0.0, -1.0 / half_width**2], [1.0, 0.0, -1.0 / half_height**2])
    result = np.ones((1, 1))
    for factor in [hole] * hole_power + [edge] * edge_power:
        result = convolve2d(result, factor)
    return result


@pytest.mark.parametrize(
    ("hole", "hole_power", "sides", "side_power"),
    [
        ("pinned", 3, "pinned", 3),
        ("free", 4, "pinned", 3),
        ("pinned", 3, "free", 4),
        ("clamped", 2, "clamped", 2),
    ],
)
def test_plate_with_a_hole(hole: str, hole_power: int, sides: str, side_power: int) -> None:
    """Manufactured: the polynomial meets the edge conditions by vanishing to their order. Kinks apart."""
    c = polynomial(hole_power, side_power)
    c /= np.abs(
        np.polynomial.polynomial.polygrid2d(np.linspace(-0.5, 0.5, 99), np.linspace(-0.2, 0.2, 99), c)
    ).max()
    load = biharmonic(c)
    supports = {"hole": hole, **dict.fromkeys(("left", "right", "bottom", "top"), sides)}
    off, on, grids = errors_of(
        lambda nodes: meshes.rectangle_with_hole(125.0, 50.0, 15.0, nodes),
        (2000, 8000, 32000),
        supports,
        lambda x, y: np.polynomial.polynomial.polyval2d(x, y, load),
        lambda x, y: np.polynomial.polynomial.polyval2d(x, y, c),
    )
    assert_second_order(f"hole {hole}, sides {sides}: off kinks", off, grids, 2e-2)
    assert_second_order(f"hole {hole}, sides {sides}: on kinks", on, grids, 2e-2)
