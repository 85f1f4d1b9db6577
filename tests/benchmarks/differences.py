"""How far the reported quantities of a run with effects left out are from those of full runs of several seeds.

The phase of wrinkles is the seed's. Their largest heights go with it, so of wrinkled sheets, which have several full
runs, the root mean squares are compared instead; and a difference is what lies beyond the range of the full runs. It
is relative: energies to the total one, forces and moments to the largest of their kind, stretches to
the largest strain, heights to the larger of the full height and the thickness, wavelengths to themselves. Where every
run is flat but for what is left of its random start, so are its heights, and forces across the sheet and moments about
axes in it have no other source.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from cases.quantities import quantities
from cases.schema import Scene
from fdsolver.result import Solution
from fdsolver.verdict import LEFT_OVER

Quantities = Mapping[str, float]
OF_THE_PHASE = (".max_abs", ".amplitude_mm")
OF_HEIGHTS = (".force_N.z", ".moment_N_mm.x", ".moment_N_mm.y")


def reported(solution: Solution, scene: Scene) -> dict[str, float]:
    """The quantities of a run; wavelengths only of lines that are not flat but for what is left of the random start."""
    found = quantities(solution, scene)
    flat = {
        key.rsplit(".", 1)[0]
        for key, value in found.items()
        if key.endswith("rms_mm") and value <= LEFT_OVER * scene.sheet.thickness_mm
    }
    return {
        key: value
        for key, value in found.items()
        if not (key.endswith("wavelength_mm") and key.rsplit(".", 1)[0] in flat)
    }


def differences(lean: Quantities, full: Sequence[Quantities], scene: Scene) -> dict[str, float]:
    """Quantity -> relative difference beyond the range of the full runs; what one run lacks is zero there.

    The smallest stretch is left out where any of them is slack: it is not unique there.
    """
    keys = dict.fromkeys(key for run in (lean, *full) for key in run)
    flat = all(
        run.get("out_of_plane_mm.max_abs", 0.0) <= LEFT_OVER * scene.sheet.thickness_mm
        for run in (lean, *full)
    )
    slack = any("stretch.minor_min" not in run for run in (lean, *full))
    found = {}
    for key in keys:
        if (key == "stretch.minor_min" and slack) or (len(full) > 1 and key.endswith(OF_THE_PHASE)):
            continue
        values = [run.get(key, 0.0) for run in full]
        value = lean.get(key, 0.0)
        beyond = max(min(values) - value, value - max(values), 0.0)
        if _is_height(key) and max(abs(value), *map(abs, values)) <= LEFT_OVER * scene.sheet.thickness_mm:
            beyond = 0.0
        if flat and key.endswith(OF_HEIGHTS):
            beyond = 0.0
        found[key] = beyond / _scale(key, (lean, *full), scene)
    return found


def _is_height(key: str) -> bool:
    return key.startswith("out_of_plane_mm") or key.endswith((".amplitude_mm", ".rms_mm"))


def _scale(key: str, runs: Iterable[Quantities], scene: Scene) -> float:
    kind = key.partition(".")[0]
    if kind == "stretch":
        return max(abs(run[part] - 1.0) for run in runs for part in run if part.startswith("stretch."))
    if kind == "reactions":
        part = key.split(".")[2]
        return max(abs(run[other]) for run in runs for other in run if f".{part}." in other)
    if kind == "energy_N_mm":
        return max(run["energy_N_mm.total"] for run in runs)
    floor = scene.sheet.thickness_mm if _is_height(key) else 0.0
    return max(floor, *(abs(run.get(key, 0.0)) for run in runs))
