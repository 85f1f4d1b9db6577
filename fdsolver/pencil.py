"""The lowest eigenvalue of K v = t B v, of two tangents on one mesh, by shift and inversion.

Shifted and inverted, 1 / (t + s), the lowest values lie far apart and a few iterations find them. That needs a factor
of K + s B, which exists if and only if all t are above -s.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigsh
from threadpoolctl import threadpool_limits

from fdsolver.cholesky import Cholesky, NotPositiveDefinite, Pattern
from fdsolver.tangent import Tangent

ACCURACY = 1e-4  # of the eigenvalue: of t + s
BASIS = 8  # vectors of the iteration: more would take longer to build than to restart


@dataclass(frozen=True)
class Pencil:
    """K v = t B v over the free nodes.

    stiffness : K. metric : of one component; B is the same for each, and couples none with another. pattern : of the
    factors. free : (ni, nj) bool.
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
        values = self.stiffness.values.copy()
        for axis in range(self.pattern.axes):
            values[..., axis, axis] += shift * self.metric.values[..., 0, 0]
        try:
            with threadpool_limits(1, user_api="blas"):  # the same bits on any number of cores
                return Cholesky(replace(self.stiffness, values=values), self.pattern)
        except NotPositiveDefinite:
            return None

    def lowest(self, factor: Cholesky, shift: float, seed: int) -> tuple[float, np.ndarray] | None:
        """Lowest t and its v (axes, ni, nj), largest component 1; None where the iteration does not find it.

        factor : of this shift. seed : of the start.
        """
        count, axes = int(self.free.sum()), self.pattern.axes
        loose = np.flatnonzero(self.free)
        b = self.metric.matrix()[loose][:, loose]

        def inverse(right: np.ndarray) -> np.ndarray:
            return self._unknowns(factor.solve(self._field(right)))

        def weighted(v: np.ndarray) -> np.ndarray:
            return (b @ v.reshape(count, axes)).ravel()

        shape = (axes * count, axes * count)
        inverted, metric = (LinearOperator(shape, matvec=each, dtype=float) for each in (inverse, weighted))
        start = np.random.default_rng(seed).standard_normal(axes * count)
        basis = min(BASIS, axes * count)
        try:
            with threadpool_limits(1, user_api="blas"):
                # shifted and inverted, K itself is not asked for
                values, vectors = eigsh(
                    inverted, 1, metric, -shift, OPinv=inverted, v0=start, tol=ACCURACY, ncv=basis
                )
        except (RuntimeError, ArpackError, ArpackNoConvergence):
            return None
        mode = self._field(vectors[:, 0])
        return float(values[0]), mode / mode.ravel()[np.argmax(np.abs(mode))]

    def _field(self, unknowns: np.ndarray) -> np.ndarray:
        """(axes, ni, nj) of the unknowns, node after node; zero at fixed nodes."""
        field = np.zeros((self.pattern.axes, *self.free.shape))
        field[:, self.free] = unknowns.reshape(-1, self.pattern.axes).T
        return field

    def _unknowns(self, field: np.ndarray) -> np.ndarray:
        return field[:, self.free].T.ravel()
