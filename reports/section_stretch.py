"""The report's section on the pulled strip: Fig. 3, 4 and 5 of Taylor et al. (2014)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from reports import figures_progress, figures_seeds, figures_sheet, figures_stretch
from reports.content import Block, Drawing, Section, Text
from reports.loads import by_pull, finest, flat_partners
from reports.plan_sheets import SHOWN_PULLS
from reports.plans import relief_factor
from reports.seed_words import seed_states, seed_table, seed_words
from reports.stored import Stored
from reports.strip_curves import curves, pull_table
from reports.strip_words import trend
from reports.tables import quantity_table, remarks, run_table, wrinkle_table

LOADS = {
    "force on the top edge (N)": ("reactions", "top", "force_N", "#1"),
    "energy (N\u00a0mm)": ("energy_N_mm", "total"),
    "bending energy (N\u00a0mm)": ("energy_N_mm", "bending"),
    "largest |z| (mm)": ("out_of_plane_mm", "max_abs"),
}


def build(results: Mapping[str, Stored]) -> Section:
    """Assemble the section from the runs of the scene `stretch`."""
    mine = [s for s in results.values() if s.run.scene == "stretch"]
    parts = {
        part: [s for s in mine if s.run.part == part] for part in ("", "progress", "sweep", "seeds", "flat")
    }
    methods = {s.method: s for s in parts[""]}
    blocks: list[Block] = [Text(_INTRODUCTION)]
    blocks += [_progress(s) for s in parts["progress"]]
    if parts["sweep"]:
        blocks += _against_pull(parts["sweep"], parts["flat"])
    if parts["seeds"]:
        blocks += _seeds(parts["seeds"])
    blocks += _methods(parts[""], methods)
    single = [*parts[""], *parts["progress"]]
    blocks.append(run_table(single, "Runs of the strip at 10 %: by every method, and the one of Fig. 3."))
    found = remarks([*single, *parts["seeds"]])
    return Section("stretch", "Pulled strip", [*blocks, *([found] if found else [])])


def _progress(stored: Stored) -> Drawing:
    return Drawing(
        "fig3",
        "Fig. 3",
        "The way to equilibrium at a pull of 10 %, on one mesh with kinetic damping: every fall of the kinetic energy "
        "to nothing is a restart from rest. Marked: the moments whose shapes stand below, from the random start to "
        "the final wrinkles, each coloured on a scale of its own.",
        "Kinetic energy falling in many peaks over ten orders of magnitude, and six shapes of the strip from random "
        "noise to parallel wrinkles.",
        partial(figures_progress.progress, stored=stored),
        4.25,
        vector=False,
    )


def _against_pull(sweep: Sequence[Stored], flat: Sequence[Stored]) -> list[Block]:
    groups = by_pull(sweep)
    shown = {pull: finest(groups.get(pull, [])) for pull in SHOWN_PULLS}
    relief = relief_factor([s for s in shown.values() if s is not None])
    found = curves(groups, flat_partners(flat))
    return [
        Drawing(
            "fig4",
            "Fig. 4",
            "Equilibrium shapes at four pulls, lit from the upper left, slopes "
            f"{relief:.0f} times steeper for the light only, alike in all four; and the heights across the middle.",
            "Four plan views of the strip with longitudinal wrinkles that are strongest at 10 % and gone at 30 %, and "
            "the four height profiles.",
            partial(figures_stretch.shapes, runs=shown, relief=relief),
            3.1,
            vector=False,
        ),
        trend(found),
        Drawing(
            "stretch-measures",
            "Beside Fig. 4",
            "Measures of the wrinkles across the middle against the pull. Lines: limits extrapolated from a sequence "
            "of meshes, within the band of that extrapolation; marks: the finest mesh. Where the strip stays flat it "
            "has neither wavelength nor half-waves. The height in (a) is that of the crests' envelope, which does not "
            "depend on the phase. (e) settles without any wrinkled run where the strip must wrinkle, mesh by mesh.",
            "Curves of amplitude, wavelength, number of half-waves and energies of the wrinkles against the pull.",
            partial(
                figures_stretch.measures,
                pulls=found.pulls,
                curves=found.curves,
                flat=found.flat_eigenvalues(),
            ),
            6.3,
        ),
        pull_table(found),
    ]


def _seeds(seeds: Sequence[Stored]) -> list[Block]:
    states = seed_states(seeds)
    return [
        Drawing(
            "fig5",
            "Fig. 5",
            "Ten random starts at a pull of 10 %. (a) Central region of each, deformed, coloured by height on one "
            "scale; (b) all heights across the middle; (c) rms of the symmetric and of the antisymmetric part of each "
            "profile, signed, so that the angle on the circle is the phase of the wrinkles.",
            "Ten small maps of parallel wrinkles, their ten profiles, and their phases on a circle.",
            partial(figures_seeds.seeds, runs=seeds),
            5.3,
            vector=False,
        ),
        seed_words(states),
        seed_table(seeds, states),
    ]


def _methods(mine: Sequence[Stored], methods: Mapping[str, Stored]) -> list[Block]:
    drawing = Drawing(
        "stretch-methods",
        "The strip by other methods",
        "The pull of 10 %: (a) the plate in relief (slopes exaggerated for the light), (b) height; (c) "
        "states of the relaxed membrane; (d) height and (e) second stretch across the middle.",
        "The pulled strip with its longitudinal wrinkles, the states of the relaxed membrane, and "
        "profiles across it.",
        partial(figures_sheet.stretched, runs=methods),
        4.5,
        vector=False,
    )
    plates = [s for s in mine if s.method != "tension-field"]
    wrinkles = wrinkle_table(plates, "Wrinkles across the middle at 10 %.")
    loads = quantity_table(
        mine, "Loads, energy and height of the strip at 10 %.", LOADS, methods.get("koiter")
    )
    return [drawing, *([wrinkles] if wrinkles else []), loads]


_INTRODUCTION = (
    "A silicone strip 101.6 mm wide, 254 mm long and 0.1 mm thick, its short edges pinned and pulled apart. It "
    "wrinkles along the pull although nothing pushes it: the pinned edges keep it from narrowing. The wrinkles change "
    "its energy by some millionths only, so what is compared is their bending energy, and the energy gained by "
    "wrinkling: that of the flat state less that of the wrinkled one, on the same mesh."
)
