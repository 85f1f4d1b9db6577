"""The report's section on the finite elements' buckling factors, and on where the flat strip is stable."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from cases.probe import ProbeError
from cases.unstructured import FiniteElementMesh
from cases.unstructured_probe import sample_section
from cases.waves import count_half_waves
from reports import figures_buckling as figures
from reports import stability_window
from reports.buckling_tables import NAMES, critical, factor_table, finest, partners_of, run_table, to_float
from reports.content import Block, Drawing, Section, Text
from reports.loads import measure, section_line, top_move
from reports.plan_buckling import PART
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import remarks

SHOWN_MODES = 6
MANY_TIMES = 100.0  # a load so far beyond the critical one says nothing of the wrinkles at the load


def build(results: Mapping[str, Stored], benchmarks: Path) -> Section:
    """Assemble the section from the buckling runs, and from what the verification runs left in a folder."""
    mine = {
        scene: [s for s in results.values() if s.run.part == PART and s.run.scene == scene] for scene in NAMES
    }
    first = {scene: finest(runs) for scene, runs in mine.items()}
    found = {scene: run for scene, run in first.items() if run is not None}
    blocks: list[Block] = [Text(_INTRODUCTION)]
    blocks += _drawings(first) if found else []
    blocks += [factor_table(run, partners_of(run, mine[scene])) for scene, run in found.items()]
    beyond = beyond_words(found, results)
    blocks += [beyond] if beyond else []
    everything = [run for runs in mine.values() for run in runs]
    blocks.append(run_table(everything))
    if mine["stretch"]:
        blocks += stability_window.blocks(benchmarks, _thickness_mm(first["stretch"]))
    remarked = remarks(everything)
    return Section("buckling", "Buckling of the flat sheets", [*blocks, *([remarked] if remarked else [])])


def _thickness_mm(run: Stored | None) -> float:
    sheet = run.scene.get("sheet") if run is not None else None
    return to_float(sheet.get("thickness_mm")) if isinstance(sheet, Mapping) else math.nan


def _drawings(first: Mapping[str, Stored | None]) -> list[Drawing]:
    strip = first["stretch"]
    panels = [figures.Panel(strip, k, _title("abcdef"[k], strip, k)) for k in range(SHOWN_MODES)]
    others = [
        figures.Panel(first[scene], 0, _title(letter, first[scene], 0, NAMES[scene]))
        for letter, scene in (("a", "shear"), ("b", "hole"))
    ]
    return [
        Drawing(
            "buckling-modes-strip",
            "Buckling modes of the strip",
            "The first modes of the pulled strip over the reference sheet, with their factors. Neighbours are pairs: "
            "their mixtures are wrinkles of any phase.",
            "Six maps of parallel wrinkles along the pull, with more of them from mode to mode.",
            partial(figures.modes, panels=panels, widths=[1.0] * SHOWN_MODES),
            2.7,
            vector=False,
        ),
        Drawing(
            "buckling-modes-others",
            "First buckling modes of the sheared sheet and of the sheet with a hole",
            "They belong to the smallest load at which the flat sheet is unstable, not to the load of the scene.",
            "Two maps of the first buckling mode: of the sheared sheet and of the sheet with a hole.",
            partial(figures.modes, panels=others, widths=[3.4, 1.0]),
            2.5,
            vector=False,
        ),
    ]


def _title(letter: str, run: Stored | None, k: int, name: str = "") -> str:
    entries = critical(run) if run is not None else []
    if k >= len(entries):
        return f"({letter}) {name}".strip()
    factor = number(to_float(entries[k].get("factor")), 4)
    between = ", " if name else "\n"
    return f"({letter}) {name or f'mode {k + 1}'}\n{factor}{between}{entries[k].get('parity') or 'no parity'}"


def beyond_words(found: Mapping[str, Stored], results: Mapping[str, Stored]) -> Text | None:
    """What a load of very many times the critical one means for such factors as references."""
    far = {scene: run for scene, run in found.items() if times_critical(run) > MANY_TIMES}
    if not far:
        return None
    loads = "; ".join(f"the {NAMES[scene]} carries {_load_words(run)}" for scene, run in far.items())
    return Text(f"What that means for references: {loads}.", (*_MEANING, *wave_words(far, results)))


def _load_words(run: Stored) -> str:
    displacement = to_float(critical(run)[0].get("displacement_mm"))
    return (
        f"{whole(times_critical(run))} times its critical load, which is reached at {number(displacement, 2)} mm, "
        f"{number(100.0 * displacement / _thickness_mm(run), 2)}\u00a0% of its thickness"
    )


def times_critical(run: Stored) -> float:
    """The scene's load over its first critical one."""
    return 1.0 / to_float(critical(run)[0].get("factor"))


def wave_words(far: Mapping[str, Stored], results: Mapping[str, Stored]) -> list[str]:
    """Half-waves of the sheared sheet's first mode beside those of the plate at the load, where both were run."""
    run = far.get("shear")
    plates = [
        s
        for s in results.values()
        if s.run.scene == "shear" and s.run.part == "mesh" and s.method == "koiter" and s.converged
        and top_move(s.run) == (0.5, 0.0, 0.0)
    ]  # fmt: skip
    if run is None or not plates:
        return []
    plate = max(plates, key=lambda s: s.value("nodes"))
    return [
        f"Across the middle of the sheared sheet its first mode has {mode_half_waves(run, 0)} half-waves, the plate at "
        f"the scene's load {whole(measure(plate, 'half_waves'))} on {whole(plate.value('nodes'))} nodes."
    ]


def mode_half_waves(run: Stored, k: int) -> int:
    """Half-waves of mode k along the scene's section across the middle; 0 without one."""
    line, fields = section_line(run), run.fields
    if line is None or "modes" not in fields:
        return 0
    mesh = FiniteElementMesh(str(fields["shape"]), fields["u"], fields["cells"])
    try:
        section = sample_section(mesh, np.column_stack([fields["u"], fields["modes"][k]]), line)
    except ProbeError:
        return 0
    return count_half_waves(section.z)


_INTRODUCTION = (
    "Factors by which a scene's own load must be multiplied for its flat sheet to buckle: linear plane stress, a "
    "Kirchhoff plate of conforming finite elements (Argyris' quintic triangles; bicubic rectangles beside them), and "
    "the geometric stiffness of that stress. None of it is shared with the finite differences. The smallest positive "
    "factors of each scene follow, with the certificate that none is missing: at a load beyond the last one the "
    "stiffness has as many negative pivots as factors were found (Sylvester's law of inertia). A run whose count is "
    "another is refused and shown as such."
)
_MEANING = (
    "Such a displacement is a small part of the thickness. The critical load can be computed to four digits, but no "
    "sheet is so flat and no clamp so true that it could be measured, and it is passed at the first touch of the load.",
    "The modes belong to that load. At the scene's own, all of those in the table and very many more are unstable; "
    "wrinkles grow finer as the tension along them grows against their bending, and linear theory has no height for "
    "them. A start from one of these modes chooses a symmetry and a phase, not the number of the wrinkles.",
    "What these factors can settle is therefore the order of the load at which the flat state ends, that the plate "
    "must wrinkle at the load, and its stiffness about the flat state. The wrinkles at the load have their references "
    "at the other end: the relaxed membrane, which is the limit of no bending at all, and converged states of the "
    "plate itself by two methods.",
)
