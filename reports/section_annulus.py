"""The report's section on the twisted and lifted annulus."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from reports import figures_annulus as figures
from reports import figures_runs
from reports.content import Block, Drawing, Section, Table, Text
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import (
    difference_table,
    find,
    quantity_table,
    relative_error,
    remarks,
    run_table,
    wrinkle_table,
)

COMPARED_FROM_MM, COMPARED_TO_MM = 64.0, 248.0  # leaves out the zones that touch a rim
COMPARED_NODES = 20000  # the paper's mesh
LOADS = {
    "torque at the inner circle (N\u00a0mm)": ("reactions", "inner", "moment_N_mm", "#2"),
    "axial force at the inner circle (N)": ("reactions", "inner", "force_N", "#2"),
    "energy (N\u00a0mm)": ("energy_N_mm", "total"),
}


def build(results: Mapping[str, Stored]) -> Section:
    """Assemble the section from the runs of the scene `annulus`."""
    mine = [s for s in results.values() if s.run.scene == "annulus"]
    plain = [s for s in mine if not s.run.overrides]
    runs = main_runs(plain)
    blocks: list[Block] = [Text(_INTRODUCTION)]
    blocks += _figures(runs)
    blocks += [_resolved(s) for s in mine if s.run.overrides]
    meshes = order_data(plain)
    if len(meshes[0]) > 1:
        blocks += [_order_drawing(*meshes), _order_table(plain)]
    blocks.append(
        Drawing(
            "annulus-residuals",
            "Residuals of the annulus",
            "Residual against step. The nested meshes follow each other from coarse to fine; each begins "
            "anew with the interpolated shape of the one before.",
            "Curves of the residual falling with the step, one for each run.",
            partial(figures_runs.residuals, stored=residual_runs(mine, runs)),
            2.9,
        )
    )
    distances = difference_table(runs, "exact", ("radius",), "Distance from the closed form, ring by ring.")
    blocks += [distances] if distances else []
    blocks.append(_loads(plain, runs))
    wrinkles = wrinkle_table(
        [s for s in mine if s.method == "koiter"], "Wrinkles on three rings, height less the ring's mean."
    )
    blocks += [wrinkles] if wrinkles else []
    blocks.append(run_table(mine, "Runs of the annulus."))
    found = remarks(mine)
    return Section("annulus", "Twisted and lifted annulus", [*blocks, *([found] if found else [])])


def main_runs(plain: list[Stored]) -> dict[str, Stored | None]:
    """For each method the run nearest COMPARED_NODES; of the plate the finest converged one."""
    runs: dict[str, Stored | None] = {}
    for method in dict.fromkeys(s.method for s in plain):
        mine = [s for s in plain if s.method == method]
        usable = [s for s in mine if s.drawable] or mine
        if method == "koiter":
            runs[method] = max(usable, key=lambda s: (s.converged, np.nan_to_num(s.value("nodes"))))
        else:
            runs[method] = min(usable, key=_far_from_compared)
    return runs


def _far_from_compared(stored: Stored) -> float:
    nodes = stored.value("nodes")
    return abs(np.log(nodes / COMPARED_NODES)) if nodes > 0.0 else np.inf


def residual_runs(mine: list[Stored], runs: dict[str, Stored | None]) -> list[Stored]:
    """The compared runs, then every other run of the plate."""
    compared = [s for s in runs.values() if s is not None]
    return [*compared, *(s for s in mine if s.method == "koiter" and s not in compared)]


def _figures(runs: dict[str, Stored | None]) -> list[Block]:
    return [
        Drawing(
            "fig9",
            "Fig. 9",
            "Deformed annulus, inner circle lifted by 125 mm and turned by 90 degrees: the plate with its "
            "wrinkles (a, b) and the relaxed membrane (c, d), which carries the same tension without a "
            "wrinkle. Left: lit views; right: the membrane state from above.",
            "Lit views of the twisted annulus by the plate and by the relaxed membrane, with their "
            "membrane states.",
            partial(figures.deformed, runs=runs),
            5.5,
            vector=False,
        ),
        Drawing(
            "fig10-map",
            "Fig. 10 a",
            "Largest principal stretch over the reference sheet.",
            "Maps of the largest principal stretch of the plate and of the relaxed membrane.",
            partial(figures.stretch_map, runs=runs),
            2.75,
            vector=False,
        ),
        Drawing(
            "fig10-curves",
            "Fig. 10 b",
            "Largest principal stretch, mean of each ring, against the radius and its square, by every "
            "method and by the closed form; below, the distance from the closed form. Tinted: wrinkled in "
            "the closed form. This stretch alone cannot tell a wrinkled sheet from a compressed, "
            "unrelaxed membrane.",
            "Curves of the largest stretch against radius and radius squared, and differences from the "
            "closed form.",
            partial(figures.stretch_curves, runs=runs),
            4.2,
        ),
        Drawing(
            "fig10-apart",
            "Beside Fig. 10",
            "What does tell a wrinkled sheet from a compressed one: the second stretch, the minor stress "
            "(zero where a relaxed membrane is wrinkled, compressive in the unrelaxed one), and the "
            "wrinkles themselves.",
            "Curves of second stretch and minor stress, profiles of the wrinkles on three rings, and "
            "their rms height.",
            partial(figures.what_tells_apart, runs=runs),
            4.4,
        ),
    ]


def _resolved(stored: Stored) -> Drawing:
    thickness = stored.run.overrides.get("sheet.thickness_mm")
    return Drawing(
        "fig9-resolved",
        "Resolved wrinkles",
        f"The plate at a thickness of {thickness} mm on {whole(stored.value('nodes'))} nodes: "
        f"{number(stored.value('nodes_per_wrinkle'), 2)} nodes in its shortest wrinkle. At the thickness "
        "of the scene the wrinkles are finer than most meshes resolve, and their number follows the mesh.",
        "Lit view of a thicker wrinkled ring and the profiles of its wrinkles on three circles.",
        partial(figures.resolved, stored=stored),
        2.9,
        vector=False,
    )


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
        "torque": [_load_error(s, e, LOADS["torque at the inner circle (N\u00a0mm)"]) for s, e in both],
        "axial force": [_load_error(s, e, LOADS["axial force at the inner circle (N)"]) for s, e in both],
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


def _order_drawing(spacing: np.ndarray, errors: dict[str, np.ndarray]) -> Drawing:
    return Drawing(
        "annulus-order",
        "Error against mesh",
        "Relaxed membrane on the annulus: relative errors against the closed form, rows of the radial "
        f"path between {COMPARED_FROM_MM:g} and {COMPARED_TO_MM:g} mm.",
        "Errors falling with the mesh spacing, beside a line of second order.",
        partial(figures_runs.order, spacing=spacing, errors=errors),
        2.7,
    )


def _order_table(plain: list[Stored]) -> Table:
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


def _loads(plain: list[Stored], runs: dict[str, Stored | None]) -> Table:
    return quantity_table(
        residual_runs(plain, runs),
        "Loads and energy at the thickness of the scene, with the difference from the closed form.",
        LOADS,
        runs.get("exact"),
    )


_INTRODUCTION = (
    "A Kapton ring of radii 62.5 and 250 mm; the outer circle is held, the inner one is lifted by 125 mm "
    "and turned by 90 degrees. The relaxed membrane has a closed form: in the wrinkled band the stretch "
    "follows from R² = C²/f(λ)² + t²/λ² with f(λ) = λ(λ² − 1)/2 and two constants, C and t, given by the "
    "whole boundary-value problem, because the sheet is tense beside both rims."
)
