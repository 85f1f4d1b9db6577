"""Vibration of a completely free square plate: free edges and corners, and no soft mode that is not there.

Exact frequencies omega L^2 sqrt(rho h / D) for nu = 0.3, from the literature's converged Ritz series (Leissa,
J. Sound Vib. 31 (1973) 257-293, as refined since): one torsion mode, two saddles, a pair, a pair, one.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import diags
from scipy.sparse.linalg import eigsh

from fdsolver import meshes
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER
from tests.linear import stiffness
from tests.sample_meshes import sheared

SHEET = Sheet(young_MPa=3500.0, poisson=0.3, thickness_mm=0.5)
FREQUENCIES = np.array([13.468, 19.596, 24.270, 34.801, 34.801, 61.093, 61.093, 63.687])


def frequencies(grid: Grid, count: int) -> np.ndarray:
    """The lowest frequencies of the free plate with nodal masses, the three rigid ones included."""
    plate = (SHEET.thickness_mm / grid.length_mm) ** 2 / (12 * (1 - SHEET.poisson**2))
    matrix = stiffness(grid, SHEET, KOITER, {}, axes=(2,)) / plate
    root = diags(1 / np.sqrt((grid.node_area / grid.length_mm**2).ravel()))
    scaled = (root @ matrix @ root).tocsc()
    # a negative shift keeps the matrix with its three rigid modes definite; the start vector makes runs repeatable
    values = eigsh(
        (scaled + scaled.T) / 2, k=count, sigma=-1.0, v0=np.ones(grid.nodes), return_eigenvectors=False
    )
    return np.sort(np.sqrt(np.maximum(values, 0.0)))


@pytest.mark.parametrize("bias", [0.0, 1.0])
def test_free_square_plate(bias: float) -> None:
    grids = [meshes.rectangle(20.0, 20.0, nodes, bias=bias) for nodes in (400, 1600, 6400)]
    errors = []
    for grid in grids:
        found = frequencies(grid, 11)
        assert np.all(
            found[:3] < 0.05
        )  # rounding of the differences behind the stiffness, over the softest mode
        errors.append(np.abs(found[3:] / FREQUENCIES - 1).max())
    observed = np.diff(np.log(errors)) / np.diff([-0.5 * np.log(grid.nodes) for grid in grids])
    print(f"free square, bias {bias}: errors {np.array(errors)} orders {observed}")
    assert observed[-1] > 1.8, errors
    assert errors[-1] < 3e-3


def test_modes_of_a_skew_plate_settle() -> None:
    """The constants with cross terms: the lowest eight of a free 30 degree parallelogram converge, none is spurious."""
    found = [
        frequencies(sheared(meshes.rectangle(20.0, 20.0, n), np.tan(np.pi / 6)), 11)[3:]
        for n in (400, 1600, 6400)
    ]
    coarse, fine = (np.abs(found[k] / found[k + 1] - 1).max() for k in (0, 1))
    print(f"free skew plate: {found[-1]} changes {coarse:.2e} {fine:.2e}")
    assert np.log2(coarse / fine) > 1.8
