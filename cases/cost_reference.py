"""What errors are measured against: a closed form, two independent methods, or the limit of the finest meshes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cases.mesh_sequence import mesh_limit
from cases.methods import METHODS

# which equations a method solves: errors are differences within one of these, the rest is a difference of models
MODELS = {
    "exact": "relaxed membrane",
    "tension-field": "relaxed membrane",
    "membrane": "unrelaxed membrane",
    "koiter": "Koiter plate",
    "koiter-published": "Koiter plate",
    "postbuckling": "Koiter plate",
    "buckling": "buckling",
}
# solved by different discretisations and different codes: their agreement means something
INDEPENDENT = ("koiter", "postbuckling")
QUANTITY = re.compile(
    r"energy_N_mm\.(total|bending)|reactions\..*|stretch\.(major_max|major_min)|out_of_plane_mm\.rms"
    r"|sections\..*\.(amplitude|rms|wavelength)_mm|buckling\.critical\.0\.factor"
)
COMPARED = "koiter-published"  # never a reference: its checkerboards are no deformation
FINEST = 4  # meshes that a limit is taken from
SIGNIFICANT = 1e-4  # part of the largest force (moment), below which a component is symmetry's zero
FLAT = 1e-3  # thicknesses, below which heights are what is left of the start
HEIGHTS = ("out_of_plane_mm.", "sections.")


@dataclass(frozen=True)
class Reference:
    """The value that a quantity of one model should have. uncertainty : of the value, in its unit. how : a phrase."""

    model: str
    quantity: str
    value: float
    uncertainty: float
    how: str


def quantities_of(document: Mapping[str, Any], thickness_mm: float) -> dict[str, float]:
    """The numbers of a result.json that a reference is sought for.

    Heights of a flat sheet are left out, and sections of methods that do not resolve wrinkles.
    """
    from cases.study_table import flat

    parts = {key: value for key, value in document.items() if not isinstance(value, list | str)}
    found = {
        key: float(value)
        for key, value in flat(parts).items()
        if _is_number(value) and QUANTITY.fullmatch(key)
    }
    tall = float((document.get("out_of_plane_mm") or {}).get("max_abs") or 0.0) > FLAT * thickness_mm
    kept = () if not tall else HEIGHTS if METHODS[str(document["method"])].wrinkles else HEIGHTS[:1]
    found = {
        key: value for key, value in found.items() if not key.startswith(HEIGHTS) or key.startswith(kept)
    }
    critical = document.get("buckling", {}).get("critical") or []
    if critical:
        found["buckling.critical.0.factor"] = float(critical[0]["factor"])
    for kind in ("force_N", "moment_N_mm"):
        alike = {key: value for key, value in found.items() if f".{kind}." in key}
        largest = max(map(abs, alike.values()), default=0.0)
        for key, value in alike.items():
            if abs(value) <= SIGNIFICANT * largest:
                del found[key]
    return {key: value for key, value in found.items() if value != 0.0}


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def references(series: Mapping[str, Sequence[tuple[int, Mapping[str, float]]]]) -> list[Reference]:
    """References for every quantity of every model.

    series : method -> (nodes, quantities) of its converged runs with default options, meshes rising.
    """
    found = []
    for model in dict.fromkeys(MODELS.values()):
        methods = [method for method in series if MODELS[method] == model]
        names = dict.fromkeys(name for method in methods for _, values in series[method] for name in values)
        for name in names:
            reference = _reference(model, name, {method: series[method] for method in methods})
            if reference is not None:
                found.append(reference)
    return found


def _reference(
    model: str, name: str, series: Mapping[str, Sequence[tuple[int, Mapping[str, float]]]]
) -> Reference | None:
    """The best that there is for one quantity."""
    if "exact" in series and not name.startswith(
        "stretch"
    ):  # zone centres miss the extreme stretch of the rim
        values = [values[name] for _, values in series["exact"] if name in values]
        if values:
            return Reference(model, name, values[-1], abs(values[-1]) * 1e-11, "closed form")
    known = {method: _limit(name, runs) for method, runs in series.items() if method != COMPARED}
    limits = {method: limit for method, limit in known.items() if limit is not None}
    if all(method in limits for method in INDEPENDENT):
        surer, other = sorted(INDEPENDENT, key=lambda method: limits[method][1])
        (value, band), (second, _) = limits[surer], limits[other]
        how = f"{surer}, extrapolated, and {other} beside it"
        return Reference(model, name, value, band + abs(value - second), how)
    for method, (value, band) in limits.items():
        return Reference(model, name, value, band, f"{method}, extrapolated from its finest meshes")
    return None


def _limit(name: str, runs: Sequence[tuple[int, Mapping[str, float]]]) -> tuple[float, float] | None:
    """(limit, band) of a quantity on ever finer meshes; None where they do not approach one."""
    known = [(nodes, values[name]) for nodes, values in runs if name in values][-FINEST:]
    if len(known) < 3:
        return None
    try:
        limit = mesh_limit([nodes for nodes, _ in known], [value for _, value in known])
    except ValueError:
        return None
    return None if limit.refused else (limit.value, limit.band)
