"""What the published scheme takes a checkerboard for, in closed form.

On cells dx by dy the zone gradient [57] of a checkerboard s = (-1)^(i+j) with an envelope g is

    (s g),1 = s (dy / dx) g,2        (s g),2 = s (dx / dy) g,1

exactly, and the curvatures, differences of zone gradients, swap their directions likewise. So with the stress S of the
flat sheet the energy of a checkerboard is that of its envelope under the stress with S11 and S22 exchanged:

- under shear alone, on square cells, a checkerboard gains as much as the waves that are its envelope;
- in a pulled strip the tension S22 does not resist a checkerboard whose envelope g(y) is uniform across, while the
  compression S11 feeds it: the strip is an Euler column as long as the pull, not waves on a tense sheet. Neither the
  mesh width nor, while it is uniform, the shape of the cells enters its critical load.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from cases.boundary import edges_of, grid_of, problem_of
from cases.schema import Scene
from cases.starts import with_waves
from fdsolver.fields import zone_gradient
from fdsolver.published_level import PublishedLevel, published_model
from fdsolver.result import Solution
from fdsolver.start import smooth_start

HALF_WAVES = 12  # along the strip, of the envelopes tried
LOW = 1e-4  # mm, height of waves that strain the sheet in proportion to their square alone


def critical_thickness(flat: Solution) -> float:
    """Thickness, mm, below which a checkerboard grows in a flat strip held at its ends and pulled along y.

    flat : a flat state; its stress does not depend on the thickness. The least over g(y) of

        sum A_z (dy/dx)^2 (S11 g'^2 + Y h^2 / (12 (1 - nu^2)) (dy/dx)^2 g''^2)

    vanishes there; 0 if the sheet is not compressed. Envelopes that vary across are not tried, so the truth is no
    smaller.
    """
    grid, sheet = flat.grid, flat.sheet
    gradient = zone_gradient(grid, flat.r)
    e11, e22 = (0.5 * (np.sum(gradient[:, a] ** 2, axis=0) - 1.0) for a in (0, 1))
    s11 = sheet.young_MPa / (1.0 - sheet.poisson**2) * (e11 + sheet.poisson * e22)
    x, y = grid.u[:, 0, 0], grid.u[0, :, 1]
    ratio = np.diff(y) / np.diff(x)[:, None]
    area = np.diff(y) * np.diff(x)[:, None]
    wave = np.arange(1, HALF_WAVES + 1)[:, None] * np.pi / np.ptp(y)
    phase = wave * (0.5 * (y[1:] + y[:-1]) - y[0])
    slope, curvature = wave * np.cos(phase), wave**2 * np.sin(phase)
    fed = (slope * np.sum(area * ratio**2 * s11, axis=0)) @ slope.T
    bent = (curvature * np.sum(area * ratio**4, axis=0)) @ curvature.T
    stress = max(-float(eigh(fed, bent, eigvals_only=True)[0]), 0.0)
    return float(np.sqrt(12.0 * (1.0 - sheet.poisson**2) * stress / sheet.young_MPa))


def energy_of_waves(scene: Scene, half_wavelength_mm: float, variant: str) -> tuple[np.ndarray, np.ndarray]:
    """What low waves at 45 degrees, and a checkerboard with these waves as its envelope, add to the scheme's energy.

    Over the uniform start of a sheared rectangle. Returns (membrane, bending, hourglass) of each, scaled.
    """
    grid, model = grid_of(scene)(scene.mesh.nodes), published_model(variant)
    level = PublishedLevel(problem_of(scene, model, seed=0), model, grid, 1, variant)
    flat = smooth_start(grid, edges_of(scene))
    waves = with_waves(scene, grid, half_wavelength_mm, LOW) - flat
    signs = (-1.0) ** np.add.outer(np.arange(grid.ni), np.arange(grid.nj))[..., None]

    def energy(r: np.ndarray) -> np.ndarray:
        state = level.scaled(r)
        return level.published(state, np.zeros_like(state))

    uniform = energy(flat)
    return energy(flat + waves) - uniform, energy(flat + signs * waves) - uniform
