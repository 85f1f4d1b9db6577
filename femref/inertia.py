"""How many eigenvalues of a symmetric matrix are negative, by Sylvester's law of inertia.

Without pivoting, P A P^T = L U has U = D L^T, and the signs of D are those of the eigenvalues of A. SuperLU does this
in its symmetric mode if it exchanges no rows; where it did, the count means nothing and is refused.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu

# A factorisation that grows more than this has lost the digits that decide a sign.
LARGEST_BACKWARD_ERROR = 1e-8


class NotCertified(ArithmeticError):
    """A factorisation that proves nothing about the eigenvalues; the message is one sentence."""


@dataclass(frozen=True)
class Factorisation:
    """A = P^T L D L^T P of a symmetric matrix.

    negative : number of negative eigenvalues of A. backward_error : |A x - b| / (|A| |x|) of a random solve.
    seconds : CPU time of the factorisation. entries : of its factors.
    """

    matrix: csc_array
    factors: SuperLU
    negative: int
    backward_error: float
    seconds: float
    entries: int

    def solve(self, b: np.ndarray) -> np.ndarray:
        """A^-1 b, improved once by the residual."""
        x = self.factors.solve(b)
        return x + self.factors.solve(b - self.matrix @ x)


def factorise(matrix: csc_array) -> Factorisation:
    """Factorise a symmetric matrix and count its negative eigenvalues.

    Raises NotCertified if rows were exchanged, a pivot vanished, or the factors do not reproduce the matrix.
    """
    started = time.process_time()
    try:
        factors = splu(
            csc_array(matrix),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as reason:
        raise NotCertified(f"The factorisation failed: {reason}.") from reason
    seconds = time.process_time() - started
    if not np.array_equal(factors.perm_r, factors.perm_c):
        raise NotCertified("The factorisation exchanged rows, so its signs count no eigenvalues.")
    pivots = factors.U.diagonal()
    if not np.isfinite(pivots).all() or (pivots == 0.0).any():
        raise NotCertified("A pivot vanished: the matrix is singular to rounding.")
    error = _backward_error(matrix, factors)
    if not error <= LARGEST_BACKWARD_ERROR:
        raise NotCertified(
            f"The factors reproduce the matrix to {error:.1g} only; its signs are not certain."
        )
    return Factorisation(matrix, factors, int((pivots < 0.0).sum()), error, seconds, int(factors.nnz))


def _backward_error(matrix: csc_array, factors: SuperLU) -> float:
    wanted = np.random.default_rng(0).standard_normal(matrix.shape[0])
    x = factors.solve(wanted)
    size = abs(matrix).sum(axis=0).max() * np.abs(x).max()
    return float(np.abs(matrix @ x - wanted).max() / size)
