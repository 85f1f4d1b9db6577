"""Runs of the plate from a state of one's own: another result, or waves put into the sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from cases.boundary import edges_of, grid_of, problem_of, settings_of
from cases.envelope import mean_wavelength
from cases.methods import METHODS, with_numbers
from cases.probe import measure_section, sample_section
from cases.schema import Scene
from fdsolver.grid import Grid
from fdsolver.model import KOITER
from fdsolver.multilevel import solve
from fdsolver.result import Solution
from fdsolver.start import smooth_start


def relax_from(scene: Scene, grid: Grid, r: np.ndarray) -> Solution:
    """Relax the plate of a scene from the positions r (ni, nj, 3), mm, on `grid`, on the scene's own mesh.

    Without the scene's perturbation: what breaks a symmetry of r is the relaxation alone.
    """
    resolved = with_numbers(scene, METHODS["koiter"], None, None)
    assert resolved.solver.tolerance is not None, "with_numbers sets the tolerance"
    settings = settings_of(resolved, resolved.solver.tolerance)
    problem = problem_of(resolved, KOITER, seed=0)
    return solve(replace(problem, perturbation=0.0, initial=(grid, r)), KOITER, settings)


def with_waves(
    scene: Scene, grid: Grid, half_wavelength_mm: float, amplitude_mm: float, crest_deg: float = 45.0
) -> np.ndarray:
    """The uniform start of a rectangle with straight waves in it, which fade towards bottom and top; (ni, nj, 3) mm.

    half_wavelength_mm : across the waves. crest_deg : direction of their crests against the x axis.
    """
    r = smooth_start(grid, edges_of(scene))
    x, y = grid.u[..., 0], grid.u[..., 1]
    angle = np.radians(crest_deg)
    across = x * np.sin(angle) - y * np.cos(angle)
    height = np.ptp(grid.u[..., 1])
    # clamped edges leave neither height nor slope
    r[..., 2] += amplitude_mm * np.cos(np.pi * y / height) ** 2 * np.sin(np.pi * across / half_wavelength_mm)
    return r


def wavelength_scan(
    scene: Scene,
    half_wavelengths_mm: Sequence[float],
    amplitude_mm: float,
    section: str = "midsection",
    crest_deg: float = 45.0,
) -> pd.DataFrame:
    """Relax a sheet from imposed waves of several lengths: which keep their number, and at what energy?

    section : horizontal line on which the waves are counted. amplitude_mm, crest_deg : of the imposed waves.

    Columns: imposed_mm (half-wavelength across the waves), imposed_half_waves (on the section), half_waves found,
    half_wavelength_mm (found: half the mean wavelength on the section, across waves of the direction `crest_deg`),
    status, stable, energy_N_mm, bending_N_mm, amplitude_mm, rms_mm, steps, cpu_seconds.
    """
    slant = np.sin(np.radians(crest_deg))
    grid = grid_of(scene)(scene.mesh.nodes)
    rows = []
    for imposed in half_wavelengths_mm:
        found = relax_from(scene, grid, with_waves(scene, grid, imposed, amplitude_mm, crest_deg))
        line = sample_section(found.grid, found.r, scene.sections[section])
        measures = measure_section(line, found.sheet.thickness_mm)
        rows.append(
            {
                "imposed_mm": imposed,
                "imposed_half_waves": round(float(np.ptp(line.s)) * slant / imposed),
                "half_waves": measures.half_waves,
                "half_wavelength_mm": 0.5 * slant * mean_wavelength(line.s, line.z),
                "status": found.status.value,
                "stable": found.stability["stable"],
                "energy_N_mm": found.energy_N_mm["total"],
                "bending_N_mm": found.energy_N_mm["bending"],
                "amplitude_mm": measures.amplitude_mm,
                "rms_mm": measures.rms_mm,
                "steps": found.steps,
                "cpu_seconds": found.cpu_seconds,
            }
        )
    return pd.DataFrame(rows)
