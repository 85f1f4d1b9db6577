"""The sparse tangent against second derivatives of the array formulas, and its Cholesky factor."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver import dissection
from fdsolver.cholesky import Cholesky, NotPositiveDefinite, Pattern
from fdsolver.dissection import dissect
from fdsolver.effects import build_force
from fdsolver.model import KOITER, MEMBRANE
from fdsolver.tangent import Tangent, tangent
from tensionfield.relaxed import TENSION_FIELD
from tests import reference
from tests.fdsolver.test_force import SHEET, flat, reference_energy
from tests.sample_meshes import small_meshes

MESHES = small_meshes()
STEP = 1e-6  # of the reference differences: the square of it over a cell, 1e-10, and 1e-16 over it


def crumpled(grid, seed: int) -> np.ndarray:
    """(ni, nj, 3) scaled: the sheet pulled in both directions and bent at random, a few per cent of a cell."""
    cell = np.sqrt(grid.node_area.min()) / grid.length_mm
    random = np.random.default_rng(seed).uniform(-0.04, 0.04, (grid.ni, grid.nj, 3)) * cell
    return flat(grid) * np.array([1.2, 1.15, 1.0]) + random


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("model", [KOITER, MEMBRANE, TENSION_FIELD], ids=lambda model: model.name)
def test_tangent_is_the_second_derivative_of_the_reference_energy(model, name: str) -> None:
    """Its product with a random field, at corners, on edges and inside; closed meshes end in a smaller group."""
    grid = MESHES[name]
    r = crumpled(grid, seed=1)
    force = build_force(grid, SHEET, model, {})
    matrix = tangent(force, np.ascontiguousarray(np.moveaxis(r, -1, 0)), (0, 1, 2)).matrix()
    energy, field = reference_energy(model, grid, {}), np.random.default_rng(2).standard_normal(r.shape)
    middle, last = grid.ni // 2, (grid.ni - 1, grid.nj - 1)
    nodes = np.array([(0, 0), (1, 0), last, (0, last[1] - 1), (middle, 1), (middle, grid.nj // 2)])
    ahead, behind = (
        reference.gradient(lambda place: sum(energy(place)), r + sign * STEP * field, nodes)
        for sign in (1, -1)
    )
    expected = (ahead - behind) / (2.0 * STEP)
    product = (matrix @ field.ravel()).reshape(r.shape)[tuple(nodes.T)]
    np.testing.assert_allclose(product, expected, rtol=0.0, atol=1e-7 * np.abs(expected).max())


def random_tangent(ni: int, nj: int, reach: int, axes: int, closed: bool) -> Tangent:
    """A symmetric, diagonally dominant tangent with random couplings."""
    random, width = np.random.default_rng(3), 2 * reach + 1
    values = np.zeros((ni, nj, width, width, axes, axes))
    for i, j, k, m in np.ndindex(ni, nj, width, width):
        i2, j2 = i + k - reach, j + m - reach
        if (closed or 0 <= i2 < ni) and 0 <= j2 < nj:
            block = random.standard_normal((axes, axes))
            values[i, j, k, m] += block
            values[i2 % ni, j2, width - 1 - k, width - 1 - m] += block.T
    values[:, :, reach, reach] += 12.0 * width**2 * np.eye(axes)
    return Tangent(values, closed, 0)


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize(
    ("ni", "nj", "reach", "axes"), [(5, 4, 2, 3), (23, 17, 1, 2), (24, 21, 2, 3), (40, 5, 1, 1)]
)
def test_factor_solves_as_a_dense_solver_does(
    ni: int, nj: int, reach: int, axes: int, closed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With nodes held at random, small parts, and rings that go round a closed mesh."""
    monkeypatch.setattr(dissection, "LEAF", 6)
    matrix = random_tangent(ni, nj, reach, axes, closed)
    free = np.random.default_rng(5).random((ni, nj)) < 0.9
    right = np.random.default_rng(6).standard_normal((axes, ni, nj))
    x = Cholesky(matrix, Pattern(dissect(free, reach, closed), closed, axes)).solve(right)
    assert not x[:, ~free].any()
    loose = np.flatnonzero(np.repeat(free.ravel(), axes))
    dense = matrix.matrix().toarray()[np.ix_(loose, loose)]
    expected = np.linalg.solve(dense, np.moveaxis(right, 0, -1).ravel()[loose])
    # both round, at condition numbers near one
    np.testing.assert_allclose(np.moveaxis(x, 0, -1).ravel()[loose], expected, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("closed", [False, True])
def test_factor_exists_only_above_the_lowest_eigenvalue(closed: bool) -> None:
    matrix = random_tangent(21, 18, 2, 2, closed)
    pattern = Pattern(dissect(np.ones((21, 18), dtype=bool), 2, closed), closed, 2)
    lowest = np.linalg.eigvalsh(matrix.matrix().toarray())[0]
    for part, definite in ((0.999, True), (1.001, False)):
        moved = matrix.values.copy()
        moved[:, :, 2, 2] -= part * lowest * np.eye(2)
        if definite:
            Cholesky(Tangent(moved, closed, 0), pattern)
        else:
            with pytest.raises(NotPositiveDefinite):
                Cholesky(Tangent(moved, closed, 0), pattern)


def test_shift_raises_every_diagonal_entry_by_its_part() -> None:
    matrix = random_tangent(12, 11, 1, 2, False)
    pattern = Pattern(dissect(np.ones((12, 11), dtype=bool), 1, False), False, 2)
    right = np.ones((2, 12, 11))
    dense = matrix.matrix().toarray()
    x = np.linalg.solve(dense + 0.3 * np.diag(np.diag(dense)), np.ones(2 * 12 * 11))
    solved = Cholesky(matrix, pattern, shift=0.3).solve(right)
    np.testing.assert_allclose(np.moveaxis(solved, 0, -1).ravel(), x, rtol=1e-12, atol=0.0)


def test_blocks_of_a_factor_grow_as_nested_dissection_says() -> None:
    """Stored blocks of square meshes: n log n, not n^1.5 as with rows one after another (George 1973)."""
    counts = [dissect(np.ones((n, n), dtype=bool), 1, False).entries / n**2 for n in (50, 100, 200)]
    assert counts[2] < 1.3 * counts[1] < 1.3**2 * 1.3 * counts[0]
