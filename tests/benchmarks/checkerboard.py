"""What the published scheme takes a checkerboard for, in closed form.

On cells dx by dy the zone gradient [57] of a checkerboard s = (-1)^(i+j) with an envelope g is

    (s g),1 = s (dy / dx) g,2        (s g),2 = s (dx / dy) g,1

exactly, and the curvatures, differences of zone gradients, swap their directions likewise. So with the stress S of the
flat sheet the energy of a checkerboard is that of its envelope under the stress with S11 and S22 exchanged:

- under shear alone, on square cells, a checkerboard gains as much as the waves that are its envelope;
- in a pulled strip the tension S22 does not resist a checkerboard whose envelope g(y) is uniform across, while the
  compression S11 feeds it. It grows where the pull holds right wrinkles of the same sheet flat, on all meshes tried.
"""

from __future__ import annotations

import numpy as np

from cases.boundary import edges_of, grid_of, problem_of
from cases.schema import Scene
from cases.starts import with_waves
from fdsolver.fields import zone_gradient
from fdsolver.grid import Grid
from fdsolver.published_level import PublishedLevel, published_model
from fdsolver.result import Solution
from fdsolver.start import smooth_start

LOW = 1e-4  # mm, height of waves that strain the sheet in proportion to their square alone


def least_stress_across(flat: Solution) -> float:
    """Least stress S11, MPa, of a flat strip pulled along y, in the mean over its width.

    It feeds a checkerboard whose envelope is uniform across where it is negative; without, nothing does.
    """
    grid, sheet = flat.grid, flat.sheet
    gradient = zone_gradient(grid, flat.r)
    e11, e22 = (0.5 * (np.sum(gradient[:, a] ** 2, axis=0) - 1.0) for a in (0, 1))
    s11 = sheet.young_MPa / (1.0 - sheet.poisson**2) * (e11 + sheet.poisson * e22)
    return float(np.average(s11, axis=0, weights=np.diff(grid.u[:, 0, 0])).min())


def spread_of_envelope(solution: Solution) -> float:
    """How far the envelope of a checkerboard is from uniform across where it is highest, over its mean there."""
    envelope = signs(solution.grid) * solution.r[..., 2]
    highest = envelope[:, np.abs(envelope.mean(axis=0)).argmax()]
    return float(np.ptp(highest) / abs(highest.mean()))


def signs(grid: Grid) -> np.ndarray:
    """The checkerboard (-1)^(i+j), (ni, nj)."""
    return (-1.0) ** np.add.outer(np.arange(grid.ni), np.arange(grid.nj))


def energy_of_waves(scene: Scene, half_wavelength_mm: float, variant: str) -> tuple[np.ndarray, np.ndarray]:
    """What low waves at 45 degrees, and a checkerboard with these waves as its envelope, add to the scheme's energy.

    Over the uniform start of a sheared rectangle. Returns (membrane, bending, hourglass) of each, scaled.
    """
    grid, model = grid_of(scene)(scene.mesh.nodes), published_model(variant)
    level = PublishedLevel(problem_of(scene, model, seed=0), model, grid, 1, variant)
    flat = smooth_start(grid, edges_of(scene))
    waves = with_waves(scene, grid, half_wavelength_mm, LOW) - flat

    def energy(r: np.ndarray) -> np.ndarray:
        state = level.scaled(r)
        return level.published(state, np.zeros_like(state))

    uniform = energy(flat)
    return energy(flat + waves) - uniform, energy(flat + signs(grid)[..., None] * waves) - uniform
