"""Wrinkled states of one sheet side by side: two families of shapes, or one orbit of states with any phase?

The paper (Fig. 5) sorts ten states from ten random starts into a symmetric and an antisymmetric family. Healey, Li and
Cheng (2013) find an orbit: wrinkles that may stand anywhere under their envelope at the same energy. The two differ in
what lies between: of two families, in-between states have a higher energy and run to one of the two; on an orbit they
stay where they are and differ by the phase alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from cases.envelope import compare_waves, mean_wavelength, phase_deg, shift_phase
from cases.probe import measure_section, sample_section
from cases.schema import Line
from fdsolver.result import Solution


@dataclass(frozen=True)
class Orbit:
    """How far the states of a table differ by more than their phase.

    energy : range of the total energies / their mean. bending, rms, wavelength : ranges / means of the bending energy,
        the rms height of the section and the mean wavelength. correlation : least over the states, whatever the phase.
    largest_gap_deg : between neighbouring phases, which are periodic with 180 degrees: 90 for states of two families
        alone, 180 for states of one phase, near 180 / n for n states spread over an orbit.
    """

    energy: float
    bending: float
    rms: float
    wavelength: float
    correlation: float
    largest_gap_deg: float


def families(solutions: Sequence[Solution], line: Line) -> pd.DataFrame:
    """One row per state: how its run ended, energies, and the measures of its wrinkles along a line.

    Columns: seed, status, stable, lowest, energy_N_mm, bending_N_mm, amplitude_mm, rms_mm, wavelength_mm (local, where
    the envelope is largest), mean_wavelength_mm, half_waves, symmetry (-1 to 1), phase_deg (see `envelope.phase_deg`),
    and against the first state, whatever the phase: correlation, envelope_difference. Measures of a flat state are NaN.
    """
    sections = [sample_section(solution.grid, solution.r, line) for solution in solutions]
    rows = []
    for solution, section in zip(solutions, sections, strict=True):
        found = measure_section(section, solution.sheet.thickness_mm)
        row: dict[str, object] = {
            "seed": solution.seed,
            "status": solution.status.value,
            "stable": solution.stability["stable"],
            "lowest": solution.stability["lowest"],
            "energy_N_mm": solution.energy_N_mm["total"],
            "bending_N_mm": solution.energy_N_mm["bending"],
            "amplitude_mm": found.amplitude_mm,
            "rms_mm": found.rms_mm,
            "half_waves": found.half_waves,
        }
        if found.wavelength_mm is not None:
            against = compare_waves(sections[0].s, sections[0].z, section.s, section.z)
            row |= {
                "wavelength_mm": found.wavelength_mm,
                "mean_wavelength_mm": mean_wavelength(section.s, section.z),
                "symmetry": found.symmetry,
                "phase_deg": phase_deg(section.z),
                "correlation": against.correlation,
                "envelope_difference": against.envelope_difference,
            }
        rows.append(row)
    return pd.DataFrame(rows)


def orbit(table: pd.DataFrame) -> Orbit:
    """The evidence of a table of `families`.

    Raises ValueError for fewer than two wrinkled states.
    """
    wrinkled = table[table["rms_mm"] > 0.0].dropna(subset=["phase_deg"])
    if len(wrinkled) < 2:
        raise ValueError("an orbit needs at least two wrinkled states")
    phases = np.sort(np.mod(wrinkled["phase_deg"].to_numpy(), 180.0))
    gaps = np.diff(np.append(phases, phases[0] + 180.0))
    spread = {
        name: _range(wrinkled[name])
        for name in ("energy_N_mm", "bending_N_mm", "rms_mm", "mean_wavelength_mm")
    }
    return Orbit(
        energy=spread["energy_N_mm"],
        bending=spread["bending_N_mm"],
        rms=spread["rms_mm"],
        wavelength=spread["mean_wavelength_mm"],
        correlation=float(wrinkled["correlation"].min()),
        largest_gap_deg=float(gaps.max()),
    )


def _range(column: pd.Series) -> float:
    return float((column.max() - column.min()) / abs(column.mean()))


def shifted_phase(solution: Solution, degrees: float) -> np.ndarray:
    """The state with its wrinkles moved along x under their envelope by a part of a wave; (ni, nj, 3) mm.

    For sheets whose wrinkles stand side by side along x. Positions in the plane are kept: a start for a run, no state
    of equilibrium. Raises ValueError for a mesh that is no rectangle.
    """
    grid = solution.grid
    if grid.shape != "rectangle":
        raise ValueError(f"wrinkles are shifted along the rows of a rectangle, not of the shape {grid.shape}")
    x = grid.u[:, 0, 0]
    even = np.linspace(x[0], x[-1], 4 * len(x))
    heights = CubicSpline(x, solution.r[..., 2])(even)
    r = solution.r.copy()
    for j in range(grid.nj):
        r[:, j, 2] = CubicSpline(even, shift_phase(heights[:, j], degrees))(x)
    return r
