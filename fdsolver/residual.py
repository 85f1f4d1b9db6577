"""How far a state is from equilibrium."""

from __future__ import annotations

import numpy as np

from fdsolver.rows import compiled


def residual(f: np.ndarray, weight: np.ndarray) -> float:
    """Largest |dE/dr| over free nodes and components / (Y h L_n); NaN if any force is not finite.

    f : (components, ni, nj) float64, scaled. weight : (ni, nj) float64, L / L_n at free nodes, 0 at fixed ones.
    """
    largest, squares = _largest_force(f.reshape(-1), weight.reshape(-1))
    return float(largest) if np.isfinite(squares) else float("nan")


@compiled
def _largest_force(f, weight):
    """Largest |f| * weight over all components, and the sum of squares, which a NaN cannot hide from."""
    largest = squares = 0.0
    for k in range(weight.size):
        for axis in range(f.size // weight.size):
            value = abs(f[axis * weight.size + k]) * weight[k]
            largest = max(largest, value)
            squares += value * value
    return largest, squares
