"""The report's section on the sheared sheet: Fig. 6 of Taylor et al. (2014)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from cases.estimates import ShearEstimate, shear_estimate
from fdsolver.material import Sheet
from reports import figures_shear as figures
from reports.content import Block, Drawing, Section, Text
from reports.figures_shear import Load
from reports.figures_shear_bands import bands as draw_bands
from reports.loads import WRINKLED, by_shear, finest, flat_partners, top_move
from reports.plans import relief_factor
from reports.shear_measures import Measured, measure_all, value_of
from reports.shear_tables import Groups, Quantity, energy_table, run_rows, series, wrinkle_size_table
from reports.stored import Stored
from reports.style import number, whole
from reports.tables import find, remarks

HEIGHT_MM, SHEET = 128.0, Sheet(3500.0, 0.31, 0.025)
SMALL_MM = 0.1  # displacements below this are those of the caption


def build(results: Mapping[str, Stored]) -> Section:
    """Assemble the section from the runs of the scene `shear`."""
    mine = [s for s in results.values() if s.run.scene == "shear"]
    meshes = by_shear(s for s in mine if s.run.part == "mesh")
    seeds = by_shear(s for s in mine if s.run.part == "seeds")
    flat = flat_partners(s for s in mine if s.run.part == "flat")
    measured = measure_all(s for s in mine if not s.run.kept_flat)
    best = {load: finest(runs) for load, runs in meshes.items()}
    estimates = {move: estimate_of(move) for move in {load[0] for load in meshes}}
    blocks: list[Block] = [Text(_INTRODUCTION)]
    blocks.append(_drawing("fig6", "Fig. 6", {k: s for k, s in best.items() if k[0] > SMALL_MM}, estimates))
    blocks.append(Text(_ESTIMATE))
    large = {load: runs for load, runs in meshes.items() if load[0] > SMALL_MM}
    blocks += [_bands(large, seeds, measured)] if large else []
    blocks.append(wrinkle_size_table(meshes, seeds, measured, estimates, SHEET.thickness_mm))
    blocks.append(energy_table(meshes, seeds, flat))
    blocks += _scan(mine, measured)
    small = {load: s for load, s in best.items() if load[0] <= SMALL_MM}
    if small:
        blocks.append(_drawing("fig6-small", "Fig. 6 as its caption has it", small, estimates))
        blocks.append(small_words(small))
    blocks.append(run_rows(mine, measured, SHEET.thickness_mm))
    found = remarks(s for s in mine if s.run.part != "flat")
    return Section("shear", "Sheared sheet", [*blocks, *([found] if found else [])])


def estimate_of(move_mm: float) -> ShearEstimate:
    """The estimate for the sheet of Fig. 6."""
    return shear_estimate(SHEET, HEIGHT_MM, move_mm / HEIGHT_MM)


def _drawing(
    name: str, title: str, runs: Mapping[Load, Stored | None], estimates: Mapping[float, ShearEstimate]
) -> Drawing:
    moves = sorted({move for move, _ in runs})
    reliefs = {
        m: relief_factor([s for load, s in runs.items() if s is not None and load[0] == m]) for m in moves
    }
    light = " and ".join(f"{factor:.0f} times at {move:g} mm" for move, factor in reliefs.items())
    return Drawing(
        name,
        title,
        "The sheet sheared by "
        + " and ".join(f"{m:g}" for m in moves)
        + f" mm, without and with a pre-stretch, lit from the upper left; slopes steeper for the light only ({light}). "
        "Below: heights along section A, the horizontal centre line; dashed: some waves of the size that the estimate "
        "gives, as a line at 45 degrees to them would see them.",
        "Plan views of the sheared sheet with oblique wrinkles and fans in two corners, and height profiles.",
        partial(figures.sheared, runs=runs, reliefs=reliefs, estimates=estimates),
        5.3 if len(moves) > 1 else 3.4,
        vector=False,
    )


def _bands(meshes: Groups, seeds: Groups, measured: Measured) -> Drawing:
    """How far the measures depend on the mesh and on the random start."""

    def named(name: str) -> Quantity:
        return lambda s: value_of(measured, s, name, SHEET.thickness_mm)

    quantities: Mapping[str, Quantity] = {
        "half-wavelength": named("half_wavelength_mm"),
        "height in the middle": named("middle_amplitude_mm"),
        "height of the fans": named("fan_maximum_mm"),
        "zero crossings": named("zero_crossings"),
        "shear reaction": lambda s: find(s, ("reactions", "top", "force_N", "#0")),
        "bending energy": lambda s: s.value("energy_N_mm", "bending"),
    }
    panels = []
    for name, quantity in quantities.items():
        group = [series(load, runs, seeds.get(load, []), quantity) for load, runs in meshes.items()]
        panels.append((name, [s for s in group if s is not None]))
    return Drawing(
        "shear-bands",
        "Meshes and random starts",
        "Measures of the sheared sheet over their value on the finest mesh. Filled: the sequence of meshes; open: "
        "further random starts; bars at the right: what is to be believed, the limit of the meshes with its band or, "
        "where they approach none, the range over meshes and starts. The reaction is firm; heights, wavelength and "
        "number of the wrinkles depend on which of many neighbouring states a run ends in.",
        "Six panels with the measures of four loads on three meshes and from three random starts.",
        partial(draw_bands, panels=panels),
        4.4,
    )


def _scan(mine: Sequence[Stored], measured: Measured) -> list[Block]:
    """The energy against the imposed half-wavelength, beside the random starts on the same mesh."""

    def rows(runs: Sequence[Stored]) -> list[tuple[Stored, float, float]]:
        sizes = [value_of(measured, s, "half_wavelength_mm", SHEET.thickness_mm) for s in runs]
        energies = [s.value("energy_N_mm", "total") for s in runs]
        return [
            (s, h, e)
            for s, h, e in zip(runs, sizes, energies, strict=True)
            if s.converged and math.isfinite(h)
        ]

    waves = rows([s for s in mine if s.run.imposed_mm is not None])
    if len(waves) < 2:
        return []
    nodes, load = waves[0][0].value("nodes"), top_move(waves[0][0].run)
    starts = rows(
        [
            s
            for s in mine
            if s.run.part in ("mesh", "seeds") and s.value("nodes") == nodes and top_move(s.run) == load
        ]
    )
    lowest = min(e for _, _, e in (*waves, *starts))
    spread = max(e for _, _, e in waves) - lowest
    drawing = Drawing(
        "shear-scan",
        "Energy against imposed wavelength",
        f"Straight waves at 45 degrees put into the start instead of noise, at {load[0]:g} mm without pre-stretch on "
        f"{whole(nodes)} nodes: (a) the half-wavelength across the wrinkles that the state ends with; (b) its energy. "
        f"All energies lie within {number(spread, 2)} N\u00a0mm of {number(lowest, 5)} N\u00a0mm: the energy is nearly "
        "flat in the wavelength, which is why the number of wrinkles is not unique.",
        "Half-wavelength found against half-wavelength imposed, and energy against half-wavelength found.",
        partial(
            figures.scan,
            imposed=np.array([float(s.run.imposed_mm or 0.0) for s, _, _ in waves]),
            found=np.array([h for _, h, _ in waves]),
            energy=np.array([e - lowest for _, _, e in waves]),
            seeds=np.array([(h, e - lowest) for _, h, e in starts]).reshape(-1, 2),
        ),
        2.6,
    )
    return [drawing]


def small_words(small: Mapping[Load, Stored | None]) -> Text:
    """Whether the displacement of the caption wrinkles the sheet at all."""
    words = []
    for (move, rise), stored in sorted(small.items()):
        load = f"{move:g} mm with " + (f"a pre-stretch of {rise:g} mm" if rise else "no pre-stretch")
        if stored is None or not stored.converged:
            status = "not run" if stored is None else stored.status.replace("_", " ")
            words.append(f"{load}: no converged result ({status}).")
            continue
        height = stored.value("out_of_plane_mm", "max_abs")
        flat = height < WRINKLED * SHEET.thickness_mm
        words.append(
            f"{load}: "
            + (
                f"stays flat ({f'no point rises by more than {height:.1g} mm' if height else 'all heights are 0'})."
                if flat
                else f"wrinkles, up to {height:.2g} mm high."
            )
        )
    return Text(
        "The paper's text says 0.5 mm, the caption of its figure 0.05 mm. What the smaller one does:",
        tuple(words),
    )


_INTRODUCTION = (
    "A Kapton sheet 380 mm wide, 128 mm high and 0.025 mm thick between two clamps; the upper one is moved sideways. "
    "The paper states no pre-stretch; others who model the same experiment lift the upper clamp by 0.05 mm first, so "
    "both were run. The number of wrinkles is the softest of all quantities: neighbouring numbers are stable states "
    "of nearly the same energy, and which one a run ends in depends on the mesh and on the random start. It is "
    "therefore given with a band from both."
)
_ESTIMATE = (
    "The estimate is in the style of Wong and Pellegrino (2006): with the shear angle γ = displacement / height, "
    "half-wavelength √(π H h / √(3 (1 − ν²) γ)) and amplitude (half-wavelength / π) √(2 (1 − ν) γ). We could not "
    "check these formulas against their text."
)
