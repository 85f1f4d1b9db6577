"""Direct solvers: counts of negative eigenvalues, solutions, refusals; the optional one against the default."""

from __future__ import annotations

import gc

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array

from femref.buckle import smallest_factors
from femref.direct import SOLVERS, NotFactorised, chosen, installed, using
from femref.inertia import NotCertified, factorise
from femref.meshes import rectangle
from femref.plate_matrices import PlateSpace, bending_stiffness, geometric_stiffness
from femref.sheet_mesh import PlateMaterial

needs_fast = pytest.mark.skipif("pardiso" not in installed(), reason="needs the extra `fast` (pypardiso)")
SOLVER = pytest.mark.parametrize("solver", ["superlu", pytest.param("pardiso", marks=needs_fast)])


def spread(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Seven negative and 23 positive eigenvalues, and orthogonal vectors."""
    generator = np.random.default_rng(seed)
    values = np.concatenate([generator.uniform(-2.0, -0.1, 7), generator.uniform(0.1, 3.0, 23)])
    return values, np.linalg.qr(generator.standard_normal((30, 30)))[0]


@SOLVER
def test_inertia_counts_negative_eigenvalues(solver: str) -> None:
    values, q = spread(3)
    with using(solver):
        found = factorise(csc_array((q * values) @ q.T))
    assert found.negative == 7
    b = np.random.default_rng(4).standard_normal(30)
    assert found.solve(b) == pytest.approx((q / values) @ (q.T @ b), rel=1e-9)  # condition 30


@SOLVER
def test_a_singular_matrix_is_refused(solver: str) -> None:
    with using(solver), pytest.raises(NotCertified):
        factorise(csc_array(diags_array(np.array([1.0, 0.0, -2.0]))))


def test_superlu_refuses_a_matrix_that_needs_pivoting() -> None:
    """Zero diagonal: without row exchanges there is no L D L^T, and with them no inertia."""
    matrix = csc_array(np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    with using("superlu"), pytest.raises(NotCertified):
        factorise(matrix)


@SOLVER
def test_factors_that_do_not_reproduce_their_matrix_are_refused(
    solver: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    values, q = spread(5)
    other = csc_array((q * np.abs(values)) @ q.T)
    monkeypatch.setitem(SOLVERS, "broken", lambda matrix: SOLVERS[solver](other))
    monkeypatch.setattr("femref.direct.installed", lambda: ("broken",))
    with using("broken"), pytest.raises(NotCertified, match="reproduce the matrix"):
        factorise(csc_array((q * values) @ q.T))


def test_a_solver_that_is_not_there_is_named() -> None:
    with pytest.raises(ValueError, match=r"installed here are .*superlu, not 'mumps'"), using("mumps"):
        pass
    assert chosen() == installed()[0]


def pencil() -> tuple[csc_array, csc_array]:
    sheet = rectangle(100.0, 250.0, 300, aspect=2.0)
    space = PlateSpace(sheet, PlateMaterial(1.0, 0.5, 0.1), {"bottom": "pinned", "top": "pinned"})
    return bending_stiffness(space), geometric_stiffness(space, np.array([[-0.01, 0.0], [0.0, 1.0]]))


@needs_fast
def test_both_solvers_find_the_same_factors() -> None:
    found = {}
    for name in installed():
        with using(name):
            found[name] = smallest_factors(*pencil(), 10, 1e-4)
    ours, theirs = found["pardiso"], found["superlu"]
    assert ours.factor == pytest.approx(theirs.factor, rel=1e-9)
    assert ours.shift == theirs.shift and ours.certified


@needs_fast
def test_factors_are_given_back() -> None:
    """MKL keeps what it has not been told to free: a hundred factorisations would hold a hundred times the memory."""
    import resource

    bending, _ = pencil()

    def used() -> int:
        gc.collect()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    with using("pardiso"):
        size = 8 * factorise(bending).entries / 1024  # kB
        before = used()
        for _ in range(100):
            factorise(bending)
    assert used() - before < 20 * size


@needs_fast
def test_a_pivot_that_pardiso_replaced_is_refused() -> None:
    """Two equal rows: the matrix is singular, but no row is empty."""
    matrix = csc_array(np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    with pytest.raises(NotFactorised):
        SOLVERS["pardiso"](matrix)
