"""What a run of a rectangle was loaded by, and what its wrinkles measure along the middle."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from cases.envelope import envelope, mean_wavelength
from cases.results import ResultError, load_result
from cases.schema import Line
from fdsolver.result import Solution
from reports.plan_sheets import STRIP_LENGTH_MM
from reports.run import ReportRun
from reports.stored import Stored

BUILT_IN_MOVE = {"stretch": (0.0, 25.4, 0.0), "shear": (0.5, 0.0, 0.0)}  # of the upper edge, mm
MIDDLE = "midsection"
WRINKLED = 0.05  # of the thickness: below, what a random start leaves on a flat sheet; 100 times that start


def top_move(run: ReportRun) -> tuple[float, float, float]:
    """Displacement of the upper edge, mm."""
    move = run.overrides.get("edges.top.move_mm", BUILT_IN_MOVE.get(run.scene, (0.0, 0.0, 0.0)))
    assert isinstance(move, list | tuple)
    x, y, z = (float(part) for part in move)
    return x, y, z


def pull_percent(stored: Stored) -> float:
    """Pull of the strip, % of its length."""
    return round(100.0 * top_move(stored.run)[1] / STRIP_LENGTH_MM, 6)


def measure(stored: Stored, name: str) -> float:
    """A measure of the wrinkles across the middle, such as "rms_mm"; NaN if it is absent or null."""
    return stored.value("sections", MIDDLE, name)


def section_line(run: Stored) -> Line | None:
    """The line across the middle, from the run's own scene; None without one."""
    sections = run.scene.get("sections")
    line = sections.get(MIDDLE) if isinstance(sections, dict) else None
    return None if line is None else Line(**line)


def readable_states(runs: Iterable[Stored]) -> Iterator[tuple[Stored, Line, Solution]]:
    """Every run on a structured mesh with a readable shape and a line across the middle, with these."""
    for run in runs:
        line = section_line(run)
        if not run.drawable or line is None:
            continue
        try:
            state = load_result(run.folder)
        except ResultError:
            continue
        if isinstance(state, Solution):
            yield run, line, state


def crest_height(stored: Stored) -> float:
    """Largest height of the crests' envelope across the middle, mm: whatever the phase; NaN without a section."""
    section = stored.section(MIDDLE)
    return float(envelope(section["z_mm"]).max()) if section else math.nan


def wavelength(stored: Stored) -> float:
    """Mean wavelength across the middle, mm: half of the profile's power is in longer waves; NaN without any."""
    section = stored.section(MIDDLE)
    return mean_wavelength(section["s_mm"], section["z_mm"]) if section else math.nan


def wrinkled(stored: Stored) -> bool:
    """Whether the middle rises above what the start leaves of its noise on a sheet that stays flat."""
    thickness = stored.scene.get("sheet", {})
    assert isinstance(thickness, Mapping)
    return measure(stored, "amplitude_mm") > WRINKLED * float(thickness.get("thickness_mm", math.nan))


def by_pull(stored: Iterable[Stored]) -> dict[float, list[Stored]]:
    """Runs of the strip by their pull (%), ascending; each from coarse to fine."""
    groups: dict[float, list[Stored]] = {}
    for run in stored:
        groups.setdefault(pull_percent(run), []).append(run)
    return {pull: sorted(groups[pull], key=planned_nodes) for pull in sorted(groups)}


def by_shear(stored: Iterable[Stored]) -> dict[tuple[float, float], list[Stored]]:
    """Runs of the sheared sheet by displacement and pre-stretch (mm); each from coarse to fine."""
    groups: dict[tuple[float, float], list[Stored]] = {}
    for run in stored:
        groups.setdefault(top_move(run.run)[:2], []).append(run)
    return {load: sorted(groups[load], key=planned_nodes) for load in sorted(groups)}


def planned_nodes(stored: Stored) -> float:
    """Nodes of a result; of a run without one, those of its plan."""
    nodes = stored.value("nodes")
    return nodes if math.isfinite(nodes) else float(stored.run.nodes_quick or stored.run.nodes_full or 0)


def finest(stored: Iterable[Stored]) -> Stored | None:
    """The finest run that converged; the finest with a shape, or the last, if none did."""
    runs = sorted(stored, key=lambda s: (s.converged, s.drawable, planned_nodes(s)))
    return runs[-1] if runs else None


def energy_gained(wrinkled_run: Stored, flat: Stored | None) -> float:
    """Energy of the flat state less that of the wrinkled one on the same mesh, N mm; NaN without a flat one."""
    if flat is None or not (flat.converged and wrinkled_run.converged):
        return math.nan
    if flat.value("nodes") != wrinkled_run.value("nodes"):
        return math.nan
    return flat.value("energy_N_mm", "total") - wrinkled_run.value("energy_N_mm", "total")


def flat_partners(stored: Iterable[Stored]) -> Mapping[tuple[object, ...], Stored]:
    """Flat runs by scene, load and mesh, as `partner_key` names them."""
    return {partner_key(run): run for run in stored if run.run.part == "flat"}


def partner_key(stored: Stored) -> tuple[object, ...]:
    """Scene, load and mesh of a run."""
    return (stored.run.scene, top_move(stored.run), stored.run.nodes_quick, stored.run.nodes_full)
