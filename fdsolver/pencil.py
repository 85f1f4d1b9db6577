"""The lowest eigenvalue of K v = t B v, of two tangents on one mesh, by shift and inversion.

Shifted and inverted, 1 / (t + s), the lowest values lie far apart and a few iterations find them. That needs a factor
of K + s B, which exists if and only if all t are above -s.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigsh
from threadpoolctl import threadpool_limits

from fdsolver.cholesky import Cholesky, NotPositiveDefinite, Pattern
from fdsolver.tangent import Tangent

ACCURACY = 1e-4  # of the eigenvalue: of t + s
BASIS = 8  # vectors of the iteration: more would take longer to build than to restart


@dataclass(frozen=True)
class Pencil:
    """K v = t B v over the free nodes.

    stiffness, metric : K and B. pattern : of the factors of both. free : (ni, nj) bool.
    """

    stiffness: Tangent
    metric: Tangent
    pattern: Pattern
    free: np.ndarray

    @property
    def evaluations(self) -> int:
        """Of the force, spent on both."""
        return self.stiffness.evaluations + self.metric.evaluations

    def factor(self, shift: float) -> Cholesky | None:
        """Of K + shift B; None where an eigenvalue is at or below -shift."""
        values = self.stiffness.values + shift * self.metric.values
        try:
            with threadpool_limits(1, user_api="blas"):  # the same bits on any number of cores
                return Cholesky(replace(self.stiffness, values=values), self.pattern)
        except NotPositiveDefinite:
            return None

    def lowest(self, factor: Cholesky, shift: float, seed: int) -> tuple[float, np.ndarray] | None:
        """Lowest t and its v (axes, ni, nj), largest component 1; None where the iteration does not find it.

        factor : of this shift. seed : of the start.
        """
        loose = np.flatnonzero(np.repeat(self.free.ravel(), self.pattern.axes))

        def inverse(right: np.ndarray) -> np.ndarray:
            return self._unknowns(factor.solve(self._field(right.ravel())))

        k, b = (self._over(part, loose) for part in (self.stiffness, self.metric))
        start = np.random.default_rng(seed).standard_normal(loose.size)
        operator = LinearOperator(k.shape, matvec=inverse, dtype=float)
        basis = min(BASIS, loose.size)
        try:
            with threadpool_limits(1, user_api="blas"):
                values, vectors = eigsh(k, 1, b, -shift, OPinv=operator, v0=start, tol=ACCURACY, ncv=basis)
        except (RuntimeError, ArpackError, ArpackNoConvergence):
            return None
        mode = self._field(vectors[:, 0])
        return float(values[0]), mode / mode.ravel()[np.argmax(np.abs(mode))]

    @staticmethod
    def _over(part: Tangent, loose: np.ndarray) -> csc_matrix:
        return part.matrix()[loose][:, loose]

    def _field(self, unknowns: np.ndarray) -> np.ndarray:
        """(axes, ni, nj) of the unknowns, node after node; zero at fixed nodes."""
        field = np.zeros((self.pattern.axes, *self.free.shape))
        field[:, self.free] = unknowns.reshape(-1, self.pattern.axes).T
        return field

    def _unknowns(self, field: np.ndarray) -> np.ndarray:
        return field[:, self.free].T.ravel()
