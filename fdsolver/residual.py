"""How far a state is from equilibrium, and how near to it is near enough."""

from __future__ import annotations

import math

import numpy as np

from fdsolver.rows import compiled

USUAL_STRAIN = 0.1  # of a sheet under the loads that tolerances are meant for
ROUNDING = 5e-15  # residuals over L / L_n that no longer fall: 1e-16 of taut sheets, 3e-15 of a bent column
SLACK = 0.01  # share of the tolerance that is enough for a relaxed membrane: wholly slack, it has no energy to go by


def wanted(tolerance: float, energy: float, weight: np.ndarray, relaxed: bool) -> float:
    """The residual below which a sheet that holds so much energy counts as at rest.

    Forces shrink with the loads. So the tolerance holds for a sheet that is strained by a tenth, and in proportion less
    is left to one that is strained less: pushed together by 1e-4, plates still had two to seven times their energy at a
    residual of 1e-6, and waves half as high as those that they were growing.
    energy : scaled (Y h L^2). weight : (ni, nj) float64, see `residual`. relaxed : whether the model carries no
    compression.
    """
    area, largest = _free_area(weight.reshape(-1))
    share = min(1.0, math.sqrt(2.0 * max(energy, 0.0) / area) / USUAL_STRAIN)
    return max(tolerance * max(share, SLACK if relaxed else 0.0), min(tolerance, ROUNDING * largest))


@compiled
def _free_area(weight):
    """Area of the free nodes over L^2, and the largest weight."""
    area = largest = 0.0
    for k in range(weight.size):
        if weight[k] > 0.0:
            area += 1.0 / (weight[k] * weight[k])
            largest = max(largest, weight[k])
    return area, largest


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
