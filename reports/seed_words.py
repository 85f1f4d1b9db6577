"""Random starts compared: a table, and what they say about families of wrinkles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from reports.content import Table, Text
from reports.loads import readable_states
from reports.stored import Stored
from reports.style import number, whole

if TYPE_CHECKING:
    import pandas as pd

CONTINUOUS_DEG = 60.0  # two families leave gaps of 90 degrees between their phases, an orbit fills them
SAME = 0.999  # correlation of profiles that differ by their phase alone
CAPTION = (
    "Random starts at a pull of 10 %, on one mesh. Symmetry is the correlation with the mirror image; the phase is 0 "
    "for a crest or trough in the middle, 90 degrees for an antisymmetric state. Same but for phase: correlation with "
    "the first seed's profile over all shifts of the phase, 1 for the same wrinkles moved under the same envelope. "
    "Energies and rms heights do not depend on the phase; the largest height does, as a crest may stand anywhere under "
    "the envelope."
)
COLUMNS = {
    "above lowest energy (N\u00a0mm)": ("energy_N_mm", 2),
    "bending (N\u00a0mm)": ("bending_N_mm", 4),
    "rms z (mm)": ("rms_mm", 4),
    "largest |z| (mm)": ("amplitude_mm", 3),
    "wavelength (mm)": ("mean_wavelength_mm", 4),
    "half waves": ("half_waves", 0),
    "symmetry (–)": ("symmetry", 3),
    "phase (degrees)": ("phase_deg", 3),
    "same but for phase (–)": ("correlation", 5),
    "envelope differs (–)": ("envelope_difference", 2),
}


def seed_states(seeds: Sequence[Stored]) -> pd.DataFrame:
    """The table of `families` for the seeds with a readable result, indexed by the run's name; empty without any."""
    import pandas as pd

    from cases.families import families

    found = list(readable_states(seeds))
    if not found:
        return pd.DataFrame()
    table = families([state for _, _, state in found], found[0][1])
    table.index = pd.Index([run.run.name for run, _, _ in found])
    return table


def seed_table(seeds: Sequence[Stored], states: pd.DataFrame) -> Table:
    """Energy, size, wavelength, symmetry and phase of every start; en dashes for those without a result."""
    lowest = states["energy_N_mm"].min() if len(states) else math.nan
    rows = []
    for run in seeds:
        found = states.loc[run.run.name].to_dict() if run.run.name in states.index else {}
        cells = []
        for key, digits in COLUMNS.values():
            value = float(found.get(key, math.nan)) - (lowest if key == "energy_N_mm" else 0.0)
            cells.append(whole(value) if digits == 0 else number(value, digits))
        status = run.status.replace("_", " ")
        rows.append((str(run.run.seed), status, *cells, number(run.value("cpu_seconds"), 2)))
    return Table(CAPTION, ("seed", "status", *COLUMNS, "CPU (s)"), tuple(rows))


def seed_words(states: pd.DataFrame) -> Text:
    """Two families or one continuous orbit: the sentences, with their numbers."""
    from cases.families import orbit

    good = states[states["status"] == "converged"] if len(states) else states
    try:
        found = orbit(good)
    except (KeyError, ValueError):
        return Text(
            "Fewer than two random starts converged to wrinkles, so nothing can be said about families."
        )
    mean = float(good["energy_N_mm"].mean())
    share = found.energy * abs(mean) / float(good["bending_N_mm"].mean())
    evidence = (
        f"The energies of the {len(good)} converged starts agree to {number(found.energy, 2)} (relative), which is "
        f"{number(share, 2)} of the bending energy; their rms heights to {number(found.rms, 2)}, their mean "
        f"wavelengths to {number(found.wavelength, 2)}. Shifted in phase, each profile has a correlation of at least "
        f"{found.correlation:.5f} with the first. Their phases leave no gap of more than {found.largest_gap_deg:.0f} "
        "degrees out of 180; two families alone would leave 90."
    )
    one = found.largest_gap_deg < CONTINUOUS_DEG and found.correlation > SAME
    conclusion = (
        "So there are not two families but one continuous orbit of equally good states, of which the symmetric and the "
        "antisymmetric one are two points; this is what Healey et al. (2013) found, and what the paper suspects."
        if one
        else "These starts alone do not tell two families from one continuous orbit."
    )
    return Text(f"{evidence} {conclusion}")
