"""The report's sections on the first stretch and on the verification ladder."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from reports import figures_sheet as figures
from reports.content import Block, Drawing, Section, Table, Text
from reports.plan import LADDER
from reports.stored import Stored
from reports.tables import difference_table, quantity_table, remarks, run_table, wrinkle_table

STRETCH_LOADS = {
    "force on the top edge (N)": ("reactions", "top", "force_N", "#1"),
    "energy (N\u00a0mm)": ("energy_N_mm", "total"),
    "bending energy (N\u00a0mm)": ("energy_N_mm", "bending"),
    "largest |z| (mm)": ("out_of_plane_mm", "max_abs"),
}
RING_LOADS = {
    "torque (N\u00a0mm)": ("reactions", "inner", "moment_N_mm", "#2"),
    "axial force (N)": ("reactions", "inner", "force_N", "#2"),
    "energy (N\u00a0mm)": ("energy_N_mm", "total"),
}
STRIP_LOADS = {
    "force along x (N)": ("reactions", "top", "force_N", "#0"),
    "force along y (N)": ("reactions", "top", "force_N", "#1"),
    "energy (N\u00a0mm)": ("energy_N_mm", "total"),
}
WHAT = {
    "annulus-lift": "The inner circle is lifted only: nothing wrinkles, and all methods must agree.",
    "annulus-twist": "The inner circle is turned only: the relaxed sheet stays plane, a plate of 0.5 mm wrinkles.",
    "annulus-shrink": "The inner circle is pulled inward: radial wrinkles in a plate of 0.5 mm.",
    "strip-tension": "A strip in homogeneous tension: one number for the whole sheet.",
    "shear-rails": "A sheet between rails, sheared: a homogeneous tension field away from its free ends.",
}


def stretch(results: Mapping[str, Stored]) -> Section:
    """Assemble the section on the strip pulled by 10 %."""
    mine = [s for s in results.values() if s.run.scene == "stretch"]
    runs = {s.method: s for s in mine}
    drawing = Drawing(
        "stretch-shapes",
        "First stretch",
        "The plate after the pull: (a) in relief (slopes exaggerated for the light), (b) height; (c) "
        "states of the relaxed membrane; (d) height and (e) second stretch across the middle.",
        "The pulled strip with its longitudinal wrinkles, the states of the relaxed membrane, and "
        "profiles across it.",
        partial(figures.stretched, runs=runs),
        4.5,
        vector=False,
    )
    wrinkles = wrinkle_table([s for s in mine if s.method != "tension-field"], "Wrinkles across the middle.")
    blocks: list[Block] = [
        Text(
            "A silicone strip 101.6 mm wide and 254 mm long, its short edges pinned and pulled apart by "
            "10 %. It wrinkles along the pull although nothing pushes it: the pinned edges keep it from "
            "narrowing. A coarse first run; the known difficulty is not to take the unstable flat state "
            "for the answer."
        ),
        drawing,
        *([wrinkles] if wrinkles else []),
        quantity_table(mine, "Loads, energy and height of the strip.", STRETCH_LOADS, runs.get("koiter")),
        run_table(mine, "Runs of the strip."),
    ]
    found = remarks(mine)
    return Section("stretch", "First stretch", [*blocks, *([found] if found else [])])


def ladder(results: Mapping[str, Stored]) -> Section:
    """Assemble the section on the scenes with known answers."""
    blocks: list[Block] = [
        Text(
            "Scenes of growing difficulty with answers known from other sources: what must agree here "
            "before the scenes above can be trusted."
        )
    ]
    everything = []
    for scene in LADDER:
        mine = [s for s in results.values() if s.run.scene == scene]
        if mine:
            blocks += _step(scene, mine)
            everything += mine
    found = remarks(everything)
    return Section("ladder", "Verification ladder", [*blocks, *([found] if found else [])])


def _step(scene: str, mine: list[Stored]) -> list[Block]:
    runs = {s.method: s for s in mine}
    drawing = Drawing(
        scene,
        scene,
        f"{WHAT[scene]} State of the sheet, and both principal stretches along its path by every method.",
        f"The deformed sheet of {scene} and curves of its principal stretches.",
        partial(figures.ladder, runs=runs),
        2.5,
        vector=False,
    )
    loads = RING_LOADS if scene.startswith("annulus") else STRIP_LOADS
    table: Table = quantity_table(
        mine,
        f"{scene}: loads and energy, with the difference from the closed form.",
        loads,
        runs.get("exact"),
    )
    caption = f"{scene}: distance from the closed form along the path."
    distances = difference_table(runs, "exact", ("radius", "midsection"), caption)
    return [drawing, *([distances] if distances else []), table, run_table(mine, f"{scene}: runs.")]
