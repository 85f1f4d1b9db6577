"""Wrinkles by finite elements beside those by finite differences: values with the error bars of both."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reports.bands import Banded, banded
from reports.loads import (
    by_pull,
    crest_height,
    energy_gained,
    finest,
    flat_partners,
    measure,
    partner_key,
    wrinkled,
)
from reports.plan_postbuckling import PART
from reports.plan_sheets import pull
from reports.run import ReportRun
from reports.stored import Stored
from reports.strip_curves import Flat
from reports.tables import find

MIDDLE = "sections.midsection"
_VERIFIED = re.compile(r"stretch-(\d+)-(postbuckling|koiter)-(\d+)")
NOTHING = Banded(0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Quantity:
    """What both methods measure.

    name : for readers. unit : of it. key : of the finite elements' error estimates. value : of a run on a grid; the
    second argument is the same strip kept flat, None where that was not run.
    """

    name: str
    unit: str
    key: str
    value: Callable[[Stored, Stored | None], float]


QUANTITIES = (
    Quantity("crest height", "mm", f"{MIDDLE}.envelope_mm", lambda run, _: crest_height(run)),
    Quantity("rms height", "mm", f"{MIDDLE}.rms_mm", lambda run, _: measure(run, "rms_mm")),
    Quantity("wavelength", "mm", f"{MIDDLE}.wavelength_mm", lambda run, _: measure(run, "wavelength_mm")),
    Quantity(
        "bending energy",
        "N\u00a0mm",
        "energy_N_mm.bending",
        lambda run, _: run.value("energy_N_mm", "bending"),
    ),
    Quantity("energy gained", "N\u00a0mm", "energy_N_mm.gained", energy_gained),
    Quantity(
        "force",
        "N",
        "reactions.top.force_N.y",
        lambda run, _: find(run, ("reactions", "top", "force_N", "#1")),
    ),
)


@dataclass(frozen=True)
class Both:
    """One quantity at one pull. elements : the finest mesh's value and its error. differences : limit and band."""

    quantity: Quantity
    elements: Banded
    differences: Banded

    @property
    def apart(self) -> float:
        """Difference of the methods over the sum of their bars; NaN where one of them has none."""
        bars = self.elements.error + self.differences.band
        # bars of nothing: both say that there are no wrinkles
        return (self.elements.finest - self.differences.value) / bars if bars > 0.0 else math.nan


def element_value(run: Stored, key: str) -> Banded:
    """A quantity of a finite-element run with the error that the run states; of a flat sheet no wrinkles."""
    if not run.converged:
        return Banded(math.nan)
    errors = run.result.get("errors")
    for entry in errors if isinstance(errors, list) else ():
        if entry.get("quantity") == key:
            value, error = float(entry["value"]), float(entry["discretisation"])
            return Banded(value, value, error, error)
    has_none = key.endswith("wavelength_mm") or wrinkled(run)
    return Banded(math.nan) if has_none else NOTHING


def level_values(run: Stored, key: str) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of the run's meshes, coarse to fine, and the quantity on each where it was measured."""
    levels = run.result.get("levels")
    found = [
        (level["nodes"], level["quantities"][key])
        for level in (levels if isinstance(levels, list) else ())
        if key in level.get("quantities", {})
    ]
    nodes, values = np.array(found, dtype=float).reshape(-1, 2).T
    return nodes, values


@dataclass(frozen=True)
class Strip:
    """Runs of the strip by pull (%), ascending.

    elements : the finest finite-element run. meshes : the finest that kept what its coarser meshes measured.
    differences : runs on grids in sets, the most trusted first, each coarse to fine. flat : of the strip kept flat.
    """

    elements: Mapping[float, Stored]
    meshes: Mapping[float, Stored]
    differences: Mapping[float, Sequence[list[Stored]]]
    flat: Flat

    def both_at(self, percent: float) -> list[Both]:
        """Every quantity at one pull."""
        run = self.elements[percent]
        return [Both(q, element_value(run, q.key), self._limit(percent, q)) for q in QUANTITIES]

    def _limit(self, percent: float, quantity: Quantity) -> Banded:
        """By the first set that has a band."""
        found = Banded(math.nan)
        for runs in self.differences.get(percent, ()):
            found = banded(runs, lambda run: self.value(run, quantity), wrinkled)
            if math.isfinite(found.band):
                break
        return found

    def value(self, run: Stored, quantity: Quantity) -> float:
        """A quantity of a run on a grid."""
        return quantity.value(run, self.flat.get(partner_key(run)))

    def grids(self, percent: float) -> list[Stored]:
        """All runs on grids at a pull, coarse to fine."""
        every = [run for runs in self.differences.get(percent, ()) for run in runs if run.converged]
        return sorted(every, key=lambda run: run.value("nodes"))


def strip_of(results: Iterable[Stored], verified: Iterable[Stored]) -> Strip:
    """The strip's runs of the report and of its verification."""
    mine = [s for s in results if s.run.scene == "stretch"]
    checked = list(verified)
    by_part = {part: by_pull([s for s in mine if s.run.part == part]) for part in (PART, "sweep")}
    trusted = {
        method: by_pull([s for s in checked if s.method == method]) for method in ("postbuckling", "koiter")
    }
    elements = {
        percent: [*runs, *trusted["postbuckling"].get(percent, [])] for percent, runs in by_part[PART].items()
    }
    differences = {
        percent: [runs for runs in (trusted["koiter"].get(percent), by_part["sweep"].get(percent)) if runs]
        for percent in elements
    }
    return Strip(
        {percent: run for percent, runs in elements.items() if (run := finest(runs))},
        {percent: run for percent, runs in elements.items() if (run := finest(filter(_has_meshes, runs)))},
        differences,
        flat_partners(mine),
    )


def _has_meshes(run: Stored) -> bool:
    return bool(level_values(run, QUANTITIES[0].key)[0].size)


def verified_runs(folder: Path) -> list[Stored]:
    """Runs of the strip that the verification left in its folder."""
    found = []
    for path in sorted(folder.glob("stretch-*-*-*")):
        named = _VERIFIED.fullmatch(path.name)
        if named:
            percent, method, nodes = named.groups()
            run = ReportRun(path.name, "stretch", method, int(nodes), int(nodes), pull(float(percent)))
            found.append(Stored(run, path))
    return found
