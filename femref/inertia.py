"""How many eigenvalues of a symmetric matrix are negative, by Sylvester's law of inertia.

A = L D L^T with a permutation has as many negative eigenvalues as D. Where a direct solver cannot keep to that form, or
its factors do not reproduce the matrix, the count means nothing and is refused.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array

from femref.direct import SOLVERS, Factors, NotFactorised, chosen

# A factorisation that grows more than this has lost the digits that decide a sign.
LARGEST_BACKWARD_ERROR = 1e-8


class NotCertified(ArithmeticError):
    """A factorisation that proves nothing about the eigenvalues; the message is one sentence."""


@dataclass(frozen=True)
class Factorisation:
    """Factors of a symmetric matrix A that were found to reproduce it.

    backward_error : |A x - b| / (|A| |x|) of a random solve. seconds : CPU time of the factorisation.
    """

    matrix: csc_array
    factors: Factors
    backward_error: float
    seconds: float

    @property
    def negative(self) -> int:
        """Number of negative eigenvalues of A."""
        return self.factors.negative

    @property
    def entries(self) -> int:
        """Stored entries of the factors."""
        return self.factors.entries

    def solve(self, b: np.ndarray) -> np.ndarray:
        """A^-1 b, improved once by the residual."""
        x = self.factors.solve(b)
        return x + self.factors.solve(b - self.matrix @ x)


def factorise(matrix: csc_array) -> Factorisation:
    """Factorise a symmetric matrix and count its negative eigenvalues.

    Raises NotCertified if the solver refuses, or the factors do not reproduce the matrix.
    """
    started = time.process_time()
    try:
        factors = SOLVERS[chosen()](matrix)
    except NotFactorised as reason:
        raise NotCertified(str(reason)) from reason
    seconds = time.process_time() - started
    error = _backward_error(matrix, factors)
    if not error <= LARGEST_BACKWARD_ERROR:
        raise NotCertified(
            f"The factors reproduce the matrix to {error:.1g} only; its signs are not certain."
        )
    return Factorisation(matrix, factors, error, seconds)


def _backward_error(matrix: csc_array, factors: Factors) -> float:
    wanted = np.random.default_rng(0).standard_normal(matrix.shape[0])
    x = factors.solve(wanted)
    size = abs(matrix).sum(axis=0).max() * np.abs(x).max()
    return float(np.abs(matrix @ x - wanted).max() / size)
