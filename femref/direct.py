"""Direct solvers of symmetric sparse matrices: L D L^T with the number of negative eigenvalues.

SuperLU comes with scipy. PARDISO of Intel's MKL (package pypardiso, the extra `fast`) is supernodal and several times
faster on large meshes; it is used where it is installed, unless `using` says otherwise.
"""

from __future__ import annotations

import os
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from importlib import metadata, util

import numpy as np
from scipy.sparse import csc_array, csr_matrix, diags_array, triu
from scipy.sparse.linalg import splu

# PARDISO's name of the matrices here, and its parameters by their numbers in its manual
SYMMETRIC_INDEFINITE = -2
# own choices: nested dissection, pivots replaced below 1e-13, entries counted, blocks of two rows
_CHOICES = {1: 1, 2: 2, 10: 13, 18: -1, 21: 1}
_PERTURBED, _ENTRIES, _NEGATIVE = 14, 18, 23
_ROOM_FOR_COPY = np.inf  # pypardiso recognises the factorised matrix by a copy of it


class NotFactorised(ArithmeticError):
    """A factorisation that does not exist or does not count eigenvalues; the message is one sentence."""


@dataclass(frozen=True, eq=False)
class Factors:
    """What a solver makes of a matrix A (n, n).

    solve : b (n,) -> A^-1 b. negative : number of negative eigenvalues of A. entries : of the factors.
    """

    solve: Callable[[np.ndarray], np.ndarray]
    negative: int
    entries: int


def superlu(matrix: csc_array) -> Factors:
    """By SuperLU in its symmetric mode. Without pivoting P A P^T = L U has U = D L^T, and D the signs of A.

    Raises NotFactorised if rows were exchanged or a pivot vanished.
    """
    try:
        factors = splu(
            csc_array(matrix),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as reason:
        raise NotFactorised(f"The factorisation failed: {reason}.") from reason
    if not np.array_equal(factors.perm_r, factors.perm_c):
        raise NotFactorised("The factorisation exchanged rows, so its signs count no eigenvalues.")
    pivots = factors.U.diagonal()
    if not np.isfinite(pivots).all() or (pivots == 0.0).any():
        raise NotFactorised("A pivot vanished: the matrix is singular to rounding.")
    return Factors(factors.solve, int((pivots < 0.0).sum()), int(factors.nnz))


def pardiso(matrix: csc_array) -> Factors:
    """By PARDISO, D with blocks of one and two rows (Bunch and Kaufman 1977), whose signs it counts.

    Raises NotFactorised if a pivot vanished, for it replaces such pivots.
    """
    from pypardiso.pardiso_wrapper import PyPardisoError, PyPardisoSolver

    _name_library()
    diagonal = np.abs(matrix.diagonal())
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))  # which pivots are small is relative
    upper = csr_matrix(triu(diags_array(scale) @ matrix @ diags_array(scale), format="csr"))
    solver = PyPardisoSolver(mtype=SYMMETRIC_INDEFINITE, size_limit_storage=_ROOM_FOR_COPY)
    # as everything else here, and the same bits whatever the machine
    solver.libmkl.MKL_Set_Num_Threads(1)
    for parameter, value in _CHOICES.items():
        solver.set_iparm(parameter, value)
    try:
        solver.factorize(upper)
    except (PyPardisoError, ValueError) as reason:
        raise NotFactorised(f"The factorisation failed: {reason}") from reason
    perturbed, entries, negative = (
        int(solver.get_iparm(number)) for number in (_PERTURBED, _ENTRIES, _NEGATIVE)
    )
    factors = Factors(lambda b: scale * solver.solve(upper, scale * b), negative, entries)
    # MKL keeps the factors until it is told not to
    weakref.finalize(factors, solver.free_memory, everything=True)
    if perturbed:
        raise NotFactorised("A pivot vanished: the matrix is singular to rounding.")
    return factors


def _name_library() -> None:
    """Tell pypardiso where MKL is, which it would search for in the whole environment at every factorisation."""
    if "PYPARDISO_MKL_RT" not in os.environ:
        libraries = [file for file in metadata.files("mkl") or () if "mkl_rt" in file.name]
        if libraries:
            os.environ["PYPARDISO_MKL_RT"] = str(libraries[0].locate())


SOLVERS: dict[str, Callable[[csc_array], Factors]] = {"pardiso": pardiso, "superlu": superlu}
_asked: ContextVar[str | None] = ContextVar("direct solver", default=None)


def installed() -> tuple[str, ...]:
    """Names of the solvers that can be used here, the fastest first."""
    return tuple(name for name in SOLVERS if name != "pardiso" or util.find_spec("pypardiso") is not None)


def chosen() -> str:
    """Name of the solver in use."""
    return _asked.get() or installed()[0]


@contextmanager
def using(name: str) -> Iterator[None]:
    """Factorise by the solver of this name inside the `with` block. Raises ValueError if it is not installed."""
    if name not in installed():
        raise ValueError(f"the direct solvers installed here are {', '.join(installed())}, not {name!r}")
    token = _asked.set(name)
    try:
        yield
    finally:
        _asked.reset(token)
