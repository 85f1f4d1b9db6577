"""The sheared sheet (section 4.2 of the paper, Fig. 6): bands from meshes and seeds, imposed waves, a small load."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cases import Scene, load_scene, run
from cases.energy_gained import energy_gained, flat_state
from cases.estimates import estimate_of
from cases.sheared import ShearMeasures, shear_measures, with_bands
from cases.starts import wavelength_scan
from fdsolver.result import Solution
from tests.benchmarks.record import Verification

MESHES = (10000, 20000, 40000)
SEED_NODES, SEEDS = 10000, (0, 1, 2)
UNITS = {"deg": "degrees", "mm": "mm", "N": "N"}
SCAN = (20, 24, 26, 28, 30, 32, 34, 38)  # half-waves on section A


def sheet(move_mm: float, rise_mm: float, nodes: int) -> Scene:
    return load_scene(
        "shear",
        {
            "edges.top.move_mm": [move_mm, rise_mm, 0.0],
            "mesh.nodes": nodes,
            # left to itself a sheet that is stable when flat is solved in its plane, which would beg the question
            "effects.out_of_plane": "on",
        },
    )


def solved(verify: Verification, scene: Scene, name: str, seed: int = 0) -> Solution:
    solution = run(scene, method="koiter", seed=seed, out=verify.folder(name))
    assert isinstance(solution, Solution)
    verify.equal(f"status of {name}", solution.status.value, "converged", "else no equilibrium to judge")
    verify.equal(
        f"stable: {name}", str(solution.stability["stable"]), "True", "an unstable state is not the answer"
    )
    verify.note(f"CPU seconds of {name}", solution.cpu_seconds, "s")
    return solution


@pytest.mark.parametrize(("move", "rise"), [(0.5, 0.0), (0.5, 0.05), (3.0, 0.0), (3.0, 0.05)])
def test_wrinkles_with_bands_from_meshes_and_seeds(verify, move, rise):
    """Shear by 0.5 and 3 mm, without and with a pre-stretch: measures with bands from meshes and seeds"""
    line = sheet(move, rise, MESHES[0]).sections["midsection"]
    meshes: dict[int, ShearMeasures] = {}
    seeds: list[ShearMeasures] = []
    for nodes in MESHES:
        scene = sheet(move, rise, nodes)
        for seed in SEEDS if nodes == SEED_NODES else SEEDS[:1]:
            state = solved(verify, scene, f"shear-{move:g}-{rise:g}-{nodes}-seed-{seed}", seed)
            found = shear_measures(state, line)
            if seed == 0:
                meshes[state.grid.nodes] = found
                gained = energy_gained(state, flat_state(scene))
                verify.above(f"energy gained at {nodes}", gained, 0.0, "else flat is the answer", "N mm")
            if nodes == SEED_NODES:
                seeds.append(found)
    table = with_bands(meshes, seeds)
    for row in table.itertuples():
        unit = "N mm" if row.measure.endswith("_N_mm") else UNITS.get(row.measure.split("_")[-1], "")
        verify.note(f"{row.measure}: finest mesh", row.finest, unit)
        verify.note(f"{row.measure}: lowest to believe", row.low, unit)
        verify.note(f"{row.measure}: highest to believe", row.high, unit)
        of_limit = f"limit, of order {row.order:.2g}" if row.order > 0.0 else "one value"
        verify.note(f"{row.measure}: what the meshes have", "no limit, a range" if row.refused else of_limit)
        verify.note(f"{row.measure}: seeds", f"{row.lowest_seed:.6g} to {row.highest_seed:.6g}", unit)
    finest = meshes[max(meshes)]
    estimate = estimate_of(sheet(move, rise, MESHES[0]))
    verify.note("half-wavelength estimated by hand, unchecked", estimate.half_wavelength_mm, "mm")
    verify.note("amplitude estimated by hand, unchecked", estimate.amplitude_mm, "mm")
    # strains g = move / H and e = rise / H: the larger principal one lies 45 degrees + atan(e / g) / 2 above x
    turn = 0.5 * math.degrees(math.atan(rise / move))
    verify.within(
        "direction of the crests in the middle",
        finest.crest_deg,
        45.0 + turn - 5.0,
        45.0 + turn + 5.0,
        "wrinkles along the tension of a sheared sheet, which the pre-stretch turns upward",
        "degrees",
    )
    verify.above("coherence of the wrinkles in the middle", finest.coherence, 0.8, "parallel wrinkles")
    verify.above(
        "height of the fans over that of the middle",
        finest.fan_maximum_mm / finest.middle_amplitude_mm,
        limit=1.1,
        reason="corner fans are the highest waves in experiment and paper",
    )
    force = table.set_index("measure").loc["shear_N"]
    for name, low, high in (
        ("meshes", force["finest"] - force["band"], force["finest"] + force["band"]),
        ("seeds", force["lowest_seed"], force["highest_seed"]),
    ):
        verify.below(
            f"shear force: band of the {name} over its value",
            float((high - low) / force["finest"]),
            limit=0.05,
            reason="the force is firm where the number of wrinkles is not",
        )


def test_the_energy_is_flat_in_the_wavelength(verify):
    """Shear by 0.5 mm from imposed waves of several lengths: energy against number of half-waves"""
    scene = sheet(0.5, 0.0, SEED_NODES)
    slant = math.sqrt(0.5) * 380.0
    estimate = estimate_of(scene)
    table = wavelength_scan(scene, [slant / count for count in SCAN], estimate.amplitude_mm)
    for row in table.itertuples():
        text = f"{row.half_waves} half-waves of {row.half_wavelength_mm:.3f} mm, {row.energy_N_mm:.8f} N mm"
        verify.note(f"from {row.imposed_half_waves} imposed half-waves", text)
    verify.equal(
        "runs not converged", int((table["status"] != "converged").sum()), 0, "all are to be compared"
    )
    verify.above(
        "different numbers of half-waves found", table["half_waves"].nunique(), 2, "the number is not unique"
    )
    energies = table["energy_N_mm"]
    verify.below(
        "range of the energies over their mean",
        float(np.ptp(energies) / energies.mean()),
        limit=1e-3,
        reason="nearly flat in the wavelength: which number is found is a matter of the start",
    )
    best = table.loc[energies.idxmin()]
    verify.within(
        "half-wavelength of the lowest energy over the estimate by hand",
        best["half_wavelength_mm"] / estimate.half_wavelength_mm,
        0.75,
        1.25,
        "an estimate that leaves out the clamped edges and the spread of the directions",
    )


@pytest.mark.parametrize(("rise", "wrinkles"), [(0.0, True), (0.05, False)])
def test_the_smallest_shear(verify, rise, wrinkles):
    """Shear by 0.05 mm, the caption's: wrinkles without a pre-stretch, none with 0.05 mm of it"""
    scene = sheet(0.05, rise, SEED_NODES)
    state = solved(verify, scene, f"shear-0.05-{rise:g}-{SEED_NODES}")
    flat = flat_state(scene)
    lowest = float(flat.stability["lowest"])
    verify.note("lowest eigenvalue of the flat sheet", lowest)
    height = float(np.abs(state.r[..., 2]).max()) / state.sheet.thickness_mm
    reason = "the plate and the flat sheet's eigenvalue are to give one answer"
    if wrinkles:
        verify.below("lowest eigenvalue of the flat sheet", lowest, 0.0, reason)
        verify.above("height over the thickness", height, 1.0, reason)
    else:
        verify.above("lowest eigenvalue of the flat sheet", lowest, 0.0, reason)
        verify.below("height over the thickness, left of the random start", height, 0.05, reason)
    found = shear_measures(state, scene.sections["midsection"])
    verify.note("height in the middle", found.middle_amplitude_mm, "mm")
    verify.note("zero crossings on section A", found.zero_crossings if wrinkles else 0)
