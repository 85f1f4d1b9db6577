"""The report's section on parameter studies: the built-in ones, from the tables that `wrinkle study` leaves."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from reports import figures_study as figures
from reports.content import Block, Drawing, Section, Table, Text

if TYPE_CHECKING:
    import pandas as pd

THICKNESS, BAND = "thickness-and-pull", "twist-and-lift"


def read_studies(folder: Path) -> dict[str, pd.DataFrame]:
    """Name -> table of the built-in studies that have one in a folder."""
    import pandas as pd

    paths = {name: folder / f"{name}-study" / "study.csv" for name in (THICKNESS, BAND)}
    return {name: pd.read_csv(path) for name, path in paths.items() if path.is_file()}


def build(studies: Mapping[str, pd.DataFrame]) -> Section:
    """Assemble the section; of a study without a table it says how to make it."""
    blocks: list[Block] = []
    for name, draw in (("thickness-and-pull", _thickness), ("twist-and-lift", _band)):
        if name in studies:
            blocks += [draw(studies[name]), _statuses(name, studies[name])]
        else:
            blocks.append(Text(f"The study {name} was not run: `wrinkle study {name}` does."))
    return Section("studies", "Parameter studies", blocks)


def _thickness(table: pd.DataFrame) -> Drawing:
    return Drawing(
        "study-thickness-and-pull",
        "Thickness and pull",
        "Stretched sheet: wavelength and amplitude of the wrinkles on the horizontal centre line against thickness, a"
        " colour per pull and a marker per method; sheets that stay flat have no point. The grey slope is that of the"
        " square root of the thickness (Cerda and Mahadevan 2003).",
        "Wavelengths and amplitudes growing with the thickness of a stretched sheet.",
        partial(figures.thickness, table=table),
        3.0,
    )


def _band(table: pd.DataFrame) -> Drawing:
    return Drawing(
        "study-twist-and-lift",
        "The wrinkled band of the annulus",
        "Where the annulus is wrinkled, between its two tense rims, against the twist of the inner circle, for every"
        " lift: filled, the closed form; bars, the relaxed membrane, whose ends are known to one zone.",
        "Bands of radii that are wrinkled, wider for more twist.",
        partial(figures.band, table=table),
        3.0,
    )


def _statuses(name: str, table: pd.DataFrame) -> Table:
    counts = table.groupby(["method", "status"]).size().reset_index(name="runs")
    rows = tuple(
        (str(method), str(status), str(count)) for method, status, count in counts.to_numpy().tolist()
    )
    return Table(f"How the runs of the study {name} ended.", ("method", "status", "runs"), rows)
