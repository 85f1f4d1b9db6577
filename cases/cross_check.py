"""The wrinkled sheet by finite elements against the one by finite differences, each with its own error estimate.

Both have the same energy, but neither mesh nor element, nor way to the equilibrium. Compared is what does not depend on
the phase of the wrinkles, which is neutral: heights are never compared point by point, and the total energy never
alone, because wrinkles change it by a hundred-thousandth.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cases import appearance
from cases.energy_gained import NotComparable, energy_gained, flat_state
from cases.envelope import compare_waves, envelope
from cases.errors import discretisation_error
from cases.probe import sample_section
from cases.quantities import quantities
from cases.results import Probes
from cases.runner import run
from cases.schema import Scene
from cases.unstructured import FiniteElementSolution
from fdsolver.result import Solution

ELEMENTS, DIFFERENCES = "postbuckling", "koiter"
GAINED = "energy_N_mm.gained"
_UNITS = {"energy_N_mm": "N mm", "force_N": "N", "sections": "mm"}
# of totals and extremes that the membrane alone decides, and heights that depend on the phase
_LEFT_OUT = ("energy_N_mm.total", "energy_N_mm.membrane", "amplitude_mm")


def cross_check(
    scene: Scene, elements: FiniteElementSolution, elements_probes: Probes, differences: Solution
) -> list[dict[str, Any]]:
    """One row per quantity that both methods have: values, difference, and the error estimate of each method.

    Solves the scene once more, kept flat, for the energy that wrinkling gains on the finite-difference meshes.
    """
    differences = _with_coarser(scene, differences)
    planar = any(entry["quantity"] == GAINED for entry in elements.errors)
    theirs = differences_values(scene, differences, planar)
    rows = []
    for entry in elements.errors:
        name = entry["quantity"]
        if name not in theirs or name.endswith(_LEFT_OUT):
            continue
        value, error = theirs[name]
        rows.append(_row(name, _unit(name), entry["value"], value, entry["discretisation"], error))
    for name, section in elements_probes.sections.items():
        if name not in scene.sections or not np.any(section.z):
            continue
        other = sample_section(differences.grid, differences.r, scene.sections[name])
        if np.any(other.z) and len(other.s) > 2:
            waves = compare_waves(other.s, other.z, section.s, section.z)
            rows.append(_row(f"sections.{name} envelope, relative L2", "1", None, None, None, None))
            rows[-1]["difference"] = waves.envelope_difference
    return rows


def _with_coarser(scene: Scene, solution: Solution) -> Solution:
    """The solution with its coarser meshes, from which errors are estimated: a result folder keeps the last alone."""
    if solution.coarser:
        return solution
    again = run(scene, solution.method, solution.grid.nodes, solution.seed, solution.threads)
    assert isinstance(again, Solution), "the same method gives the same kind of answer"
    return again


def appearance_check(scene: Scene, buckling: FiniteElementSolution) -> list[dict[str, Any]]:
    """Two rows on the strain at which wrinkles appear: by the linear modes and by the flat sheet of finite strain, both
    by finite elements, against the flat sheet relaxed by finite differences. No rows for a scene whose load is not
    beyond the first critical one, or very far beyond it.

    Raises ValueError, NoPrestress or NotCertified if the flat sheet does not give way near the modes' load.
    """
    if not appearance.worth_searching(buckling):
        return []
    factor = float(buckling.critical[0]["factor"])
    theirs = appearance.by_relaxation(scene, factor)
    found = {
        "strain of appearance, linear modes": appearance.by_modes(buckling),
        "strain of appearance, flat sheet of finite strain": appearance.by_elements(scene, factor),
    }
    return [
        _row(name, "1", ours.strain, theirs.strain, ours.error, theirs.error) | {"method": buckling.method}
        for name, ours in found.items()
    ]


def differences_values(
    scene: Scene, solution: Solution, planar: bool
) -> dict[str, tuple[float, float | None]]:
    """Quantities of a nested finite-difference run with their estimated discretisation errors (None if refused).

    planar : a flat state exists, so that wrinkling can gain energy.
    """
    meshes = [*solution.coarser, solution]
    columns = [quantities(state, scene) | _envelopes(scene, state) for state in meshes]
    for column, gained in zip(
        columns, _gained(scene, meshes) if planar else [None] * len(meshes), strict=True
    ):
        if gained is not None:
            column[GAINED] = gained
    zones = [state.grid.zone_area.size for state in meshes]
    found = {}
    for name, value in columns[-1].items():
        values = [column[name] for column in columns if name in column]
        error = discretisation_error(zones, values)[0] if len(values) == len(meshes) else None
        found[name] = (value, error)
    return found


def _envelopes(scene: Scene, state: Solution) -> dict[str, float]:
    found = {}
    for name, line in scene.sections.items():
        section = sample_section(state.grid, state.r, line)
        found[f"sections.{name}.envelope_mm"] = float(envelope(section.z).max())
    return found


def _gained(scene: Scene, meshes: list[Solution]) -> list[float | None]:
    """Energy gained by wrinkling on each mesh; None where the flat sheet of the same mesh is missing."""
    flat = flat_state(scene, meshes[-1].grid.nodes)
    by_nodes = {state.grid.nodes: state for state in (*flat.coarser, flat)}
    found: list[float | None] = []
    for state in meshes:
        try:
            found.append(energy_gained(state, by_nodes[state.grid.nodes]))
        except (NotComparable, KeyError):
            found.append(None)
    return found


def _unit(name: str) -> str:
    return next(unit for part, unit in _UNITS.items() if part in name)


def _row(
    quantity: str,
    unit: str,
    value: float | None,
    reference: float | None,
    error: float | None,
    reference_error: float | None,
) -> dict[str, Any]:
    difference = None if value is None or reference is None else value - reference
    return {
        "quantity": quantity,
        "unit": unit,
        "method": ELEMENTS,
        "reference": DIFFERENCES,
        "value": value,
        "reference_value": reference,
        "difference": difference,
        "error": error,
        "reference_error": reference_error,
    }
