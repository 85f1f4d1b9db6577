"""One scene by several methods: what each found, and how far it is from the reference method."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cases.cross_check import DIFFERENCES, ELEMENTS, appearance_check, cross_check
from cases.files import json_text
from cases.methods import MethodError, choose, methods_of
from cases.probe import Columns, measure_section
from cases.results import Probes, probe
from cases.runner import run
from cases.schema import Scene
from cases.unstructured import AnySolution, FiniteElementSolution
from fdsolver.checkpoint import write_atomically
from fdsolver.relax import Progress
from fdsolver.result import Solution, Status

if TYPE_CHECKING:
    import pandas as pd

# The method that the others are held against: the first of these that was run.
REFERENCES = ("exact", "tension-field", "koiter", "membrane")
SLACK = 0
Row = dict[str, Any]


@dataclass(frozen=True)
class Comparison:
    """What a comparison found.

    reference : name of the reference method. solutions : method -> Solution. refused : method -> why it was
        not run; "appearance" -> why the strain at which wrinkles appear was not found.
    table : one row per method. differences : one row per quantity and method, with its unit, the value, the
        reference's value and the difference (of fields along paths: the relative L2 and the largest
        difference, slack places masked). Wrinkles by finite elements, and the strain at which they appear, are also
        held against those by finite differences, with the error estimates of both.
    """

    reference: str
    solutions: Mapping[str, AnySolution]
    refused: Mapping[str, str]
    table: pd.DataFrame
    differences: pd.DataFrame


def compare(
    scene: Scene,
    methods: Sequence[str] | None = None,
    nodes: int | None = None,
    out: Path | str | None = None,
    seed: int = 0,
    threads: int = 1,
    tolerance: float | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> Comparison:
    """Solve a scene by several methods on the same mesh and compare them.

    methods : names; None takes all that the scene has. A method that refuses the scene is listed in
        `refused`.
    out : folder of one result folder per method, compare.csv (the differences) and compare.json (everything).
    progress : called now and then by the engine.

    Raises MethodError if no method can be run, KeyboardInterrupt if a run was interrupted (its checkpoint is
    kept), and what `cases.runner.run` raises of folders.
    """
    names = list(dict.fromkeys(methods_of(scene) if methods is None else methods))
    if not names:
        raise MethodError("A comparison needs at least one method.")
    refused: dict[str, str] = {}
    solutions: dict[str, AnySolution] = {}
    for name in names:
        try:
            method = choose(scene, name)[0]
            chosen = method.name
            folder = None if out is None else Path(out) / chosen
            # nodes are those of a grid; finite elements of high order have their own count
            count = None if method.finite_elements else nodes
            solution = run(scene, chosen, count, seed, threads, tolerance, folder, resume, force, progress)
        except MethodError as reason:
            refused[name] = str(reason)
            continue
        if solution.status is Status.INTERRUPTED:
            raise KeyboardInterrupt
        solutions[chosen] = solution
    if not solutions:
        raise MethodError(" ".join(refused.values()))
    found = _compared(scene, solutions, refused)
    if out is not None:
        write_comparison(Path(out), scene, found)
    return found


def _compared(scene: Scene, solutions: Mapping[str, AnySolution], refused: Mapping[str, str]) -> Comparison:
    import pandas as pd

    reference = next((name for name in REFERENCES if name in solutions), next(iter(solutions)))
    probes = {name: probe(solution, scene) for name, solution in solutions.items()}
    table = [method_row(solutions[name], probes[name]) for name in solutions]
    differences = [
        row
        for name in solutions
        if name != reference
        for row in difference_rows(solutions[name], probes[name], solutions[reference], probes[reference])
    ]
    elements, grid = solutions.get(ELEMENTS), solutions.get(DIFFERENCES)
    if isinstance(elements, FiniteElementSolution) and isinstance(grid, Solution):
        differences += cross_check(scene, elements, probes[ELEMENTS], grid)
    modes = solutions.get("buckling")
    if isinstance(modes, FiniteElementSolution) and isinstance(grid, Solution):
        rows, reason = _appearance(scene, modes)
        differences += rows
        refused = {**refused, "appearance": reason} if reason else refused
    columns = ["quantity", "unit", "method", "reference", "value", "reference_value", "difference"]
    columns += ["error", "reference_error"]
    return Comparison(
        reference, solutions, refused, pd.DataFrame(table), pd.DataFrame(differences, columns=columns)
    )


def _appearance(scene: Scene, modes: FiniteElementSolution) -> tuple[list[Row], str]:
    """Rows on where wrinkles appear, or why there are none."""
    from femref.inertia import NotCertified
    from femref.prestress import NoPrestress

    try:
        return appearance_check(scene, modes), ""
    except (ValueError, NoPrestress, NotCertified) as reason:
        return [], str(reason)


def method_row(solution: AnySolution, probes: Probes) -> Row:
    """What one method found and what it cost; the unit is the end of each key."""
    zone, states = solution.zone, solution.zone.state
    row: Row = {
        "method": solution.method,
        "status": solution.status.value,
        "nodes": solution.grid.nodes,
        "energy_N_mm": solution.energy_N_mm["total"],
        "bending_energy_N_mm": solution.energy_N_mm["bending"],
        "stretch_major_max": zone.stretch_major.max(),
        "stretch_minor_min": zone.stretch_minor.min(),
        "stress_minor_min_MPa": zone.stress_minor.min(),
        "tense_share": float((states == 2).mean()),
        "wrinkled_share": float((states == 1).mean()),
        "slack_share": float((states == SLACK).mean()),
        "residual": solution.residual,
        "steps": solution.steps,
        "seconds": solution.seconds,
        "cpu_seconds": solution.cpu_seconds,
        "hourglass_out_of_plane": solution.hourglass.get("out_of_plane"),
        "hourglass_in_plane": solution.hourglass.get("in_plane"),
        "nodes_per_wrinkle": probes.nodes_per_wrinkle,
    }
    for name, section in probes.sections.items():
        measures = measure_section(section, solution.sheet.thickness_mm)
        row |= {
            f"{name}_amplitude_mm": measures.amplitude_mm,
            f"{name}_wavelength_mm": measures.wavelength_mm,
            f"{name}_half_waves": measures.half_waves,
        }
    return row


def difference_rows(
    solution: AnySolution, probes: Probes, reference: AnySolution, reference_probes: Probes
) -> list[Row]:
    """Differences of one method from the reference: stretches along the paths, reactions, energies."""
    rows = []
    for name in sorted(set(probes.paths) & set(reference_probes.paths)):
        for field in ("stretch_major", "stretch_minor"):
            l2, largest = path_difference(probes.paths[name], reference_probes.paths[name], field)
            rows.append(_row(f"{name} {field}, relative L2", "1", None, None, l2))
            rows.append(_row(f"{name} {field}, largest", "1", None, None, largest))
    for edge in sorted(set(solution.reactions) & set(reference.reactions)):
        ours, theirs = solution.reactions[edge], reference.reactions[edge]
        for k, axis in enumerate("xyz"):
            rows.append(_row(f"{edge} force {axis}", "N", ours.force_N[k], theirs.force_N[k]))
        for k, axis in enumerate("xyz"):
            rows.append(_row(f"{edge} moment {axis}", "N mm", ours.moment_N_mm[k], theirs.moment_N_mm[k]))
    for part in ("total", "membrane", "bending"):
        rows.append(_row(f"{part} energy", "N mm", solution.energy_N_mm[part], reference.energy_N_mm[part]))
    return [{**row, "method": solution.method, "reference": reference.method} for row in rows]


def path_difference(ours: Columns, theirs: Columns, field: str) -> tuple[float | None, float | None]:
    """Relative L2 and largest difference of a field along a path, where neither is slack.

    ours, theirs : columns of paths/NAME.csv; rows at other places are interpolated to those of `theirs`.
    Returns (None, None) if one of them is slack all along.
    """
    key = "R_mm" if "R_mm" in theirs else "s_mm"
    place = theirs[key]
    value = np.interp(place, ours[key], ours[field])
    # An interpolated place is slack as soon as one of its two neighbours is.
    slack = np.interp(place, ours[key], (ours["state"] == SLACK).astype(float)) > 0.0
    valid = ~slack & (theirs["state"] != SLACK)
    if valid.sum() < 2:
        return None, None
    # Slack stretches must not enter: zero weight there, whatever their value.
    step = np.diff(place)
    weight = 0.5 * (np.append(step, 0.0) + np.append(0.0, step)) * valid
    error = np.where(valid, value - theirs[field], 0.0)
    size = np.where(valid, theirs[field], 0.0)
    l2 = np.sqrt((weight * error**2).sum() / (weight * size**2).sum())
    return float(l2), float(np.abs(error).max())


def write_comparison(out: Path, scene: Scene, found: Comparison) -> None:
    """Write compare.csv and compare.json into `out`. Raises StorageError; what was there before is
    unchanged.
    """
    document = {
        "scene": scene.name,
        "reference": found.reference,
        "methods": found.table.astype(object).where(found.table.notna(), None).to_dict("records"),
        "differences": found.differences.astype(object)
        .where(found.differences.notna(), None)
        .to_dict("records"),
        "refused": dict(found.refused),
    }
    csv_text = found.differences.to_csv(index=False)
    write_atomically(out / "compare.csv", lambda file: file.write(csv_text.encode("utf-8")))
    write_atomically(out / "compare.json", lambda file: file.write(json_text(document).encode("utf-8")))


def _row(
    quantity: str, unit: str, value: float | None, reference: float | None, difference: float | None = None
) -> Row:
    if value is not None and reference is not None:
        difference = value - reference
    return {
        "quantity": quantity,
        "unit": unit,
        "value": value,
        "reference_value": reference,
        "difference": difference,
    }
