"""What a sheared sheet is asked for: the wrinkles in its middle, its fans, and what its rails feel."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd

from cases.direction import mean_crest_deg, wrinkle_direction
from cases.envelope import mean_wavelength
from cases.lattice import zone_centres
from cases.mesh_sequence import believed, mesh_limit
from cases.probe import sample_section
from cases.schema import Line
from cases.waves import zero_crossings
from fdsolver.result import Solution

MIDDLE = 0.5  # part of the width that is free of what the free edges do: they reach about one height into the sheet


@dataclass(frozen=True)
class ShearMeasures:
    """Measures of one state; the middle is the middle half of the section and of the sheet.

    half_wavelength_mm : across the wrinkles in the middle. crest_deg : their direction. coherence : how parallel they
        are, 0 to 1. middle_amplitude_mm : largest height in the middle of the section. fan_maximum_mm : of the whole
        sheet. zero_crossings : on the whole section. shear_N, vertical_N : what the top rail exerts along x and y.
    """

    half_wavelength_mm: float
    crest_deg: float
    coherence: float
    middle_amplitude_mm: float
    fan_maximum_mm: float
    zero_crossings: int
    shear_N: float
    vertical_N: float
    energy_N_mm: float
    bending_N_mm: float


def shear_measures(solution: Solution, line: Line) -> ShearMeasures:
    """Measures of a rectangle sheared between bottom and top, on a horizontal line through its middle.

    Lengths of flat sheets are NaN. Raises ProbeError for a line off the sheet.
    """
    section = sample_section(solution.grid, solution.r, line)
    middle = np.abs(section.x) <= MIDDLE * np.abs(section.x).max()
    along = mean_wavelength(section.s[middle], section.z[middle])
    window = along if np.isfinite(along) else float(solution.grid.length_mm)
    found = wrinkle_direction(solution.grid, solution.r[..., 2], 0.5 * window)
    centre = zone_centres(solution.grid)
    half_width, half_height = 0.5 * np.ptp(solution.grid.u.reshape(-1, 2), axis=0)
    inside = (np.abs(centre[..., 0]) < MIDDLE * half_width) & (np.abs(centre[..., 1]) < MIDDLE * half_height)
    crest = mean_crest_deg(found, inside)
    coherence = found.coherence[inside]
    force = solution.reactions["top"].force_N
    return ShearMeasures(
        half_wavelength_mm=0.5 * along * abs(float(np.sin(np.radians(crest)))),
        crest_deg=crest,
        coherence=float(np.nanmean(coherence)) if np.isfinite(coherence).any() else float("nan"),
        middle_amplitude_mm=float(np.abs(section.z[middle]).max()),
        fan_maximum_mm=float(np.abs(solution.r[..., 2]).max()),
        zero_crossings=len(zero_crossings(section.s, section.z)) if section.z.any() else 0,
        shear_N=float(force[0]),
        vertical_N=float(force[1]),
        energy_N_mm=solution.energy_N_mm["total"],
        bending_N_mm=solution.energy_N_mm["bending"],
    )


def with_bands(meshes: dict[int, ShearMeasures], seeds: list[ShearMeasures]) -> pd.DataFrame:
    """One row per measure: value on the finest mesh, limit and band of the meshes, range over the seeds and both.

    meshes : nodes -> measures, three or more. seeds : of states on one mesh from several random starts.
    Columns: measure, finest, limit, band, order, refused (why there is no limit; the band is then the range of the last
    three meshes), lowest_seed, highest_seed, low, high (`mesh_sequence.believed`).
    """
    nodes = sorted(meshes)
    rows = []
    for name in asdict(meshes[nodes[0]]):
        values = [float(getattr(meshes[count], name)) for count in nodes]
        others = [float(getattr(state, name)) for state in seeds]
        limit = mesh_limit(nodes, values)
        low, high = believed(limit, values, others)
        rows.append(
            {
                "measure": name,
                "finest": limit.finest,
                "limit": limit.value,
                "band": limit.band,
                "order": limit.order,
                "refused": limit.refused,
                "lowest_seed": min(others, default=float("nan")),
                "highest_seed": max(others, default=float("nan")),
                "low": low,
                "high": high,
            }
        )
    return pd.DataFrame(rows)
