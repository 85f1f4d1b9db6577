"""Error against mesh: the relaxed membrane on the annulus, held against the closed form on the same rings."""

from __future__ import annotations

from functools import partial

import numpy as np

from reports import figures_runs
from reports.content import Drawing, Table
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import find, relative_error

COMPARED_FROM_MM, COMPARED_TO_MM = 64.0, 248.0  # leaves out the zones that touch a rim
TORQUE, AXIAL_FORCE = ("reactions", "inner", "moment_N_mm", "#2"), ("reactions", "inner", "force_N", "#2")


def pairs(plain: list[Stored]) -> list[tuple[Stored, Stored]]:
    """Tension-field runs with the closed form evaluated on the same mesh, from coarse to fine."""
    exact = {s.value("nodes"): s for s in plain if s.method == "exact" and s.path("radius")}
    finest = max(exact.values(), key=lambda s: s.value("nodes"), default=None)
    found = []
    for stored in sorted(plain, key=lambda s: s.value("nodes")):
        reference = exact.get(stored.value("nodes"), finest)
        if stored.method == "tension-field" and stored.path("radius") and reference is not None:
            found.append((stored, reference))
    return found


def order_data(plain: list[Stored]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Mesh spacings (mm) and relative errors of the relaxed membrane against the closed form."""
    both = pairs(plain)
    spacing = np.array([mean_spacing(s) for s, _ in both])
    errors = {
        "largest stretch, L2": [_stretch_error(s, e, "stretch_major") for s, e in both],
        "second stretch, L2": [_stretch_error(s, e, "stretch_minor") for s, e in both],
        "torque": [_load_error(s, e, TORQUE) for s, e in both],
        "axial force": [_load_error(s, e, AXIAL_FORCE) for s, e in both],
    }
    return spacing, {name: np.array(values) for name, values in errors.items()}


def mean_spacing(stored: Stored) -> float:
    """Square root of the mean zone area of an annulus, mm."""
    radius = np.linalg.norm(stored.fields["u"], axis=-1)
    area = np.pi * (radius.max() ** 2 - radius.min() ** 2)
    return float(np.sqrt(area / stored.fields["state"].size))


def _stretch_error(stored: Stored, exact: Stored, field: str) -> float:
    return relative_error(
        stored.path("radius"), exact.path("radius"), field, COMPARED_FROM_MM, COMPARED_TO_MM
    )


def _load_error(stored: Stored, exact: Stored, keys: tuple[str, ...]) -> float:
    reference = find(exact, keys)
    return abs(find(stored, keys) / reference - 1.0) if reference else float("nan")


def order_drawing(spacing: np.ndarray, errors: dict[str, np.ndarray]) -> Drawing:
    """Draw the errors of `order_data`."""
    return Drawing(
        "annulus-order",
        "Error against mesh",
        "Relaxed membrane on the annulus: relative errors against the closed form, rows of the radial "
        f"path between {COMPARED_FROM_MM:g} and {COMPARED_TO_MM:g} mm.",
        "Errors falling with the mesh spacing, beside a line of second order.",
        partial(figures_runs.order, spacing=spacing, errors=errors),
        2.7,
    )


def order_table(plain: list[Stored]) -> Table:
    """Tabulate the errors of `order_data` with the observed order between neighbouring meshes."""
    both = pairs(plain)
    spacing, errors = order_data(plain)
    names = list(errors)
    rows = []
    for k, (stored, _) in enumerate(both):
        row = [whole(stored.value("nodes")), number(spacing[k], 3)]
        for name in names:
            row.append(number(errors[name][k], 3))
            row.append(number(observed_order(spacing, errors[name], k), 3))
        rows.append((*row, number(stored.value("cpu_seconds"), 3)))
    heads = [head for name in names for head in (f"{name} (–)", "order")]
    return Table(
        "Relative errors of the relaxed membrane against the closed form, and the observed order from "
        "each mesh to the next.",
        ("nodes", "spacing (mm)", *heads, "CPU (s)"),
        tuple(rows),
    )


def observed_order(spacing: np.ndarray, error: np.ndarray, k: int) -> float:
    """Order of accuracy from mesh k - 1 to mesh k; NaN for the first, equal meshes and errors of zero."""
    if k == 0 or not (error[k] > 0.0 and error[k - 1] > 0.0) or spacing[k] == spacing[k - 1]:
        return float("nan")
    return float(np.log(error[k - 1] / error[k]) / np.log(spacing[k - 1] / spacing[k]))
