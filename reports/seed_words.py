"""Random starts compared: a table, and what they say about families of wrinkles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from reports.content import Table, Text
from reports.loads import measure
from reports.phases import phase_of
from reports.stored import Stored
from reports.style import number, whole

CLOSE_TO_PURE_DEG = 10.0  # a phase so near to a multiple of 90 degrees counts as symmetric or antisymmetric
CONTINUOUS = 3  # so many mixed states are not an accident of two families


def seed_table(seeds: Sequence[Stored]) -> Table:
    """Energy, size, wavelength and symmetry of every start."""
    lowest = min((s.value("energy_N_mm", "total") for s in seeds if s.converged), default=float("nan"))
    rows = []
    for run in seeds:
        phase = phase_of(run)
        rows.append(
            (
                str(run.run.seed),
                run.status.replace("_", " "),
                number(run.value("energy_N_mm", "total") - lowest, 2),
                number(run.value("energy_N_mm", "bending"), 4),
                number(measure(run, "rms_mm"), 4),
                number(measure(run, "amplitude_mm"), 4),
                number(measure(run, "wavelength_mm"), 4),
                whole(measure(run, "half_waves")),
                number(measure(run, "symmetry"), 3),
                number(phase.angle_deg, 3) if phase is not None else "–",
                number(run.value("residual"), 2),
                whole(run.value("steps")),
                number(run.value("cpu_seconds"), 2),
            )
        )
    columns = (
        "seed",
        "status",
        "energy above the lowest (N\u00a0mm)",
        "bending (N\u00a0mm)",
        "rms z (mm)",
        "largest |z| (mm)",
        "wave\u00adlength (mm)",
        "half waves",
        "symmetry (–)",
        "phase (degrees)",
        "residual (–)",
        "steps",
        "CPU (s)",
    )
    caption = (
        "Random starts at a pull of 10 %, on one mesh. Symmetry is the correlation with the mirror image. rms height "
        "and energies do not depend on the phase; the largest height does, as a crest may or may not stand where the "
        "envelope is highest."
    )
    return Table(caption, columns, tuple(rows))


def seed_words(seeds: Sequence[Stored]) -> Text:
    """Two families or one continuous orbit: the sentence, with its numbers."""
    good = [s for s in seeds if s.converged and phase_of(s) is not None]
    if len(good) < 2:
        return Text(
            "Fewer than two random starts converged to wrinkles, so nothing can be said about families."
        )
    energy = np.array([s.value("energy_N_mm", "total") for s in good])
    size = np.array([measure(s, "rms_mm") for s in good])
    angles = np.array([phase.angle_deg for s in good if (phase := phase_of(s)) is not None])
    off = np.abs((angles + 45.0) % 90.0 - 45.0)
    mixed = int((off > CLOSE_TO_PURE_DEG).sum())
    spread = number(float(np.ptp(energy) / np.abs(energy).mean()), 2)
    gained = np.array([s.value("energy_N_mm", "bending") for s in good]).mean()
    verdict = (
        f"{mixed} of {len(good)} starts end more than {CLOSE_TO_PURE_DEG:g} degrees away from both the symmetric and "
        "the antisymmetric state"
    )
    conclusion = (
        "So there are not two families but one continuous orbit of equally good states, of which the symmetric and "
        "the antisymmetric one are two points; this is what Healey et al. (2013) found, and what the paper suspects."
        if mixed >= CONTINUOUS
        else "So these starts alone do not tell two families from one continuous orbit."
    )
    return Text(
        f"{verdict}, while all energies agree to {spread} (relative), {number(float(np.ptp(energy) / gained), 2)} of "
        f"the bending energy, and the rms heights to {number(float(np.ptp(size) / size.mean()), 2)}. {conclusion}"
    )
