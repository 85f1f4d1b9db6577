"""The numbers of a result whose errors are estimated, by their dotted keys of result.json."""

from __future__ import annotations

import numpy as np

from cases.methods import METHODS
from cases.probe import ProbeError, measure_section, sample_section
from cases.schema import Scene
from fdsolver.result import Solution

# a force or moment below this part of the largest one, or of the sheet's stiffness, is one that balances to zero
INSIGNIFICANT, BALANCED = 1e-4, 1e-9
SLACK = 0
PARTS = ("total", "membrane", "bending")


def quantities(solution: Solution, scene: Scene) -> dict[str, float]:
    """Energies, reactions, extreme stretches, heights and section measures; empty if a position is not finite.

    Sections are measured for methods that resolve wrinkles: what others have there is interpolation between nodes.
    Left out are components of reactions that are zero but for rounding, energies that a model lacks, heights of plane
    sheets, and the smallest stretch of a sheet with slack zones, where stretches are not unique.
    """
    if not np.isfinite(solution.r).all():
        return {}
    zone = solution.zone
    found = {f"energy_N_mm.{part}": float(solution.energy_N_mm[part]) for part in PARTS}
    found |= _reactions(solution)
    found |= {
        "stretch.major_max": float(zone.stretch_major.max()),
        "stretch.major_min": float(zone.stretch_major.min()),
    }
    if not (zone.state == SLACK).any():
        found["stretch.minor_min"] = float(zone.stretch_minor.min())
    found |= _heights(solution)
    method = METHODS.get(solution.method)
    for name, line in scene.sections.items() if method is not None and method.wrinkles else ():
        try:
            section = sample_section(solution.grid, solution.r, line)
        except ProbeError:
            continue
        measures = measure_section(section, solution.sheet.thickness_mm)
        found |= {f"sections.{name}.{key}": getattr(measures, key) for key in ("amplitude_mm", "rms_mm")}
        if measures.wavelength_mm is not None:
            found[f"sections.{name}.wavelength_mm"] = measures.wavelength_mm
    return {key: value for key, value in found.items() if value != 0.0}


def _reactions(solution: Solution) -> dict[str, float]:
    """Forces and moments that stand out of the rounding of the largest one, a moment being a force times the size."""
    size = solution.grid.length_mm
    arms = {"force_N": 1.0, "moment_N_mm": size}
    vectors = {
        (edge, kind): np.asarray(getattr(reaction, kind))
        for edge, reaction in solution.reactions.items()
        for kind in arms
    }
    sizes = [float(np.abs(vector).max()) / arms[kind] for (_, kind), vector in vectors.items()]
    stiffness = solution.sheet.young_MPa * solution.sheet.thickness_mm * size
    floor = max(INSIGNIFICANT * max(sizes, default=0.0), BALANCED * stiffness)
    return {
        f"reactions.{edge}.{kind}.{axis}": value
        for (edge, kind), vector in vectors.items()
        for axis, value in zip("xyz", vector.tolist(), strict=True)
        if abs(value) > floor * arms[kind]
    }


def _heights(solution: Solution) -> dict[str, float]:
    z, area = solution.r[..., 2], solution.grid.node_area
    return {
        "out_of_plane_mm.max_abs": float(np.abs(z).max()),
        "out_of_plane_mm.rms": float(np.sqrt((area * z**2).sum() / area.sum())),
    }
