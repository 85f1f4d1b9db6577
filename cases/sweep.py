"""Wrinkles against a load: a plate solved at a list of loads, wrinkled and kept flat, as one table.

Two questions have two answers each. Does the sheet wrinkle? The relaxed plate has wrinkles, or the lowest eigenvalue of
its flat state is negative; where both say the same, that is the truth. Where does it begin and end to wrinkle? Between
two neighbouring loads of the table, or where that eigenvalue passes zero.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from cases.energy_gained import energy_gained, flat_state
from cases.envelope import envelope, mean_wavelength
from cases.probe import measure_section, sample_section
from cases.runner import run
from cases.scene import load_scene
from cases.schema import Scene
from fdsolver.result import Solution, Status

WRINKLED = 0.01  # height / thickness on the section, above which there are wrinkles: a hundred times the random start
Overrides = Mapping[str, object]


@dataclass(frozen=True)
class Sweep:
    """Loads of one scene, as data.

    scene : its name or path. key : of the load, in words ("pull"). unit : of its values. values : rising.
    overrides : value -> the scene keys that set it. nodes : mesh vertices. section : where the wrinkles are measured.
    """

    scene: str
    key: str
    unit: str
    values: tuple[float, ...]
    overrides: Callable[[float], Overrides]
    nodes: int
    section: str = "midsection"

    def at(self, value: float) -> Scene:
        """The scene at one load."""
        return load_scene(self.scene, {**self.overrides(value), "mesh.nodes": self.nodes})


@dataclass(frozen=True)
class Window:
    """Where a sheet wrinkles, in the unit of the load: brackets (last flat, first wrinkled) and (last wrinkled, first
    flat), None where the table does not hold one.
    """

    appears: tuple[float, float] | None
    vanishes: tuple[float, float] | None


def pull_of_the_strip(percent: float) -> Overrides:
    """Keys that pull the scene `stretch` by a part of its 254 mm, %; at 1e-8 low wrinkles are still 7 % too high."""
    return {"edges.top.move_mm": [0.0, 2.54 * percent, 0.0], "solver.tolerance": 1e-9}


STRETCH = Sweep(
    "stretch",
    "pull",
    "%",
    (2.0, 2.25, 2.5, 2.75, 3.0, 4.0, 5.0, 7.0, 8.5, 10.0, 11.5, 13.0, 15.0, 17.0, 19.0, 20.0, 20.5)
    + (21.0, 21.5, 22.0, 22.5, 23.0, 24.0, 26.0, 28.0, 30.0),
    pull_of_the_strip,
    7500,
)


def sweep(
    plan: Sweep, out: Path | None = None, progress: Callable[[float], None] | None = None
) -> pd.DataFrame:
    """Solve a sweep; one row per load.

    out : folder in which every load leaves its result folder KEY-VALUE; what is there already is not solved again.
    progress : called with every load that begins.

    Columns: the key, status, stable, wrinkled (a height that counts), amplitude_mm, envelope_mm
    (largest height of the envelope, whatever the phase), rms_mm, mean_wavelength_mm, half_waves, bending_N_mm,
    gained_N_mm (`energy_gained`; NaN where one of the states is not converged), flat_lowest (eigenvalue of the flat
    state, see `fdsolver.planar`), flat_stable, cpu_seconds.
    """
    rows = []
    for value in plan.values:
        if progress is not None:
            progress(value)
        scene = plan.at(value)
        folder = None if out is None else out / f"{plan.key}-{value:g}"
        plate = run(scene, "koiter", out=folder)
        assert isinstance(plate, Solution), "koiter runs on structured meshes"
        rows.append({plan.key: value, **_row(scene, plan, plate, flat_state(scene))})
    return pd.DataFrame(rows)


def _row(scene: Scene, plan: Sweep, plate: Solution, flat: Solution) -> dict[str, object]:
    section = sample_section(plate.grid, plate.r, scene.sections[plan.section])
    found = measure_section(section, plate.sheet.thickness_mm)
    comparable = plate.status is Status.CONVERGED and flat.status is Status.CONVERGED
    gained = energy_gained(plate, flat) if comparable else np.nan
    wrinkled = found.amplitude_mm > WRINKLED * plate.sheet.thickness_mm
    return {
        "status": plate.status.value,
        "stable": plate.stability["stable"],
        "wrinkled": wrinkled,
        "amplitude_mm": found.amplitude_mm,
        "envelope_mm": float(envelope(section.z).max()),
        "rms_mm": found.rms_mm,
        "mean_wavelength_mm": mean_wavelength(section.s, section.z) if wrinkled else np.nan,
        "half_waves": found.half_waves if wrinkled else 0,
        "bending_N_mm": plate.energy_N_mm["bending"],
        "gained_N_mm": gained,
        "flat_lowest": flat.stability["lowest"],
        "flat_stable": flat.stability["stable"],
        "cpu_seconds": plate.cpu_seconds + flat.cpu_seconds,
    }


def window(table: pd.DataFrame, key: str) -> Window:
    """The brackets of a table of `sweep` between which wrinkles appear and vanish.

    Raises ValueError where the wrinkled loads are not one unbroken range: then there is more than one window.
    """
    load, wrinkled = table[key].to_numpy(dtype=float), table["wrinkled"].to_numpy(dtype=bool)
    changes = np.flatnonzero(np.diff(wrinkled.astype(int)))
    begins, ends = ([k for k in changes if wrinkled[k + 1] == rising] for rising in (True, False))
    if len(begins) > 1 or len(ends) > 1 or (begins and ends and ends[0] < begins[0]):
        raise ValueError("the sheet wrinkles in more than one range of loads")
    appears, vanishes = ((float(load[k[0]]), float(load[k[0] + 1])) if k else None for k in (begins, ends))
    return Window(appears, vanishes)


def critical_load(plan: Sweep, low: float, high: float, accuracy: float = 0.01) -> float:
    """The load between `low` and `high` at which the flat sheet's lowest eigenvalue passes zero, in the sweep's unit.

    Raises ValueError if it has the same sign at both, or if a flat state is not found or not examined.
    """

    def lowest(value: float) -> float:
        flat = flat_state(plan.at(value))
        found = flat.stability["lowest"]
        if flat.status is not Status.CONVERGED or not isinstance(found, float):
            raise ValueError(
                f"there is no flat state at a {plan.key} of {value:g} {plan.unit}: {flat.message}"
            )
        return found

    ends = lowest(low), lowest(high)
    if ends[0] * ends[1] > 0.0:
        raise ValueError(f"the flat state keeps its stability from {low:g} to {high:g} {plan.unit}")
    return float(brentq(lowest, low, high, xtol=accuracy))
