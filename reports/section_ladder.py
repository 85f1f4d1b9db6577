"""The report's section on the verification ladder."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from reports import figures_sheet as figures
from reports.content import Block, Drawing, Section, Table, Text
from reports.plan import LADDER
from reports.stored import Stored
from reports.tables import difference_table, quantity_table, remarks, run_table

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


def build(results: Mapping[str, Stored]) -> Section:
    """Assemble the section on the scenes with known answers."""
    blocks: list[Block] = [
        Text(
            "Scenes of growing difficulty with answers known from other sources: what must agree here "
            "before the scenes above can be trusted."
        )
    ]
    everything = []
    for scene in LADDER:
        mine = [s for s in results.values() if s.run.scene == scene and not s.run.part]
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
