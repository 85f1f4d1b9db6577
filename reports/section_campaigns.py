"""Two campaigns outside the test suite: wrong changes planted in the physics, and faults made to happen to runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from reports import figures_campaigns as figures
from reports.content import Block, Drawing, Section, Table, Text
from reports.measured import read_document
from reports.style import number, whole

Row = Mapping[str, Any]
MUTANTS, FAULTS = "mutants.json", "faults.json"
SURVIVED = "survived"


def build(folder: Path) -> Section:
    """The section from what the campaigns left in the folder of the verification runs; either may be missing."""
    mutants, faults = read_rows(folder / MUTANTS), read_rows(folder / FAULTS)
    blocks: list[Block] = [Text(mutant_words(mutants))]
    blocks += [mutant_map(mutants), mutant_table(mutants)] if mutants else []
    blocks.append(Text(fault_words(faults)))
    blocks += [fault_map(faults), fault_table(faults)] if faults else []
    return Section("campaigns", "Planted mistakes and faults", blocks)


def read_rows(path: Path) -> list[Row]:
    """The rows that a campaign left; none if there is no such file, or one that a campaign was still writing."""
    return list(read_document(path) or [])


def mutant_words(rows: Sequence[Row]) -> str:
    """How many of the planted changes the tests caught."""
    if not rows:
        return (
            "Planted mistakes were not run beside this report: `python -m tests.mutation.campaign` plants them one by "
            "one and runs the tests."
        )
    caught = sum(row["caught"] is True for row in rows)
    names = "; ".join(str(row["name"]) for row in rows if row["caught"] is not True)
    missed = f" Not caught: {names}." if names else " None passed."
    return (
        "Small wrong changes of the physics were planted one by one in copies of the project, and the tests run on "
        f"each: {caught} of {len(rows)} were caught.{missed} {number(_sum(rows, 'seconds'), 3)} s in all, with the "
        "compilation of every copy."
    )


def mutant_map(rows: Sequence[Row]) -> Drawing:
    """The planted changes, file by file."""
    lines = figures.mutant_lines(rows)
    draw = partial(figures.draw_squares, lines=lines, good="caught by a test", bad="not caught")
    caption = "Every planted change, one square each, by the file that it was planted in."
    alt = f"{sum(row['caught'] is True for row in rows)} of {len(rows)} planted changes were caught."
    return Drawing("mutant-map", "Planted mistakes", caption, alt, draw, figures.height_in(lines))


def fault_map(rows: Sequence[Row]) -> Drawing:
    """The faults, kind by kind."""
    lines = figures.fault_lines(rows)
    draw = partial(figures.draw_squares, lines=lines, good="survived", bad="not survived")
    caption = "Faults by kind, a square for each thing that they were done to; in it, how often. The table names them."
    alt = f"{sum(row['outcome'] == SURVIVED for row in rows)} of {len(rows)} kinds of faults were survived."
    return Drawing("fault-map", "Faults", caption, alt, draw, figures.height_in(lines))


def mutant_table(rows: Sequence[Row]) -> Table:
    """Every planted change, and the test that failed first."""
    cells = tuple(
        (
            str(row["name"]),
            str(row["file"]),
            "yes" if row["caught"] is True else "NO",
            words_of_test(str(row["by"])),
            whole(float(row["seconds"])),
        )
        for row in rows
    )
    columns = ("planted change", "file", "caught", "by the test", "time (s)")
    return Table("Every planted change and the first test that failed.", columns, cells, wide=(0, 3))


def words_of_test(by: str) -> str:
    """A test's file and function in words that a line can be broken between; an en dash for none."""
    path, _, function = by.partition("::")
    if not function:
        return path or "–"
    return f"{Path(path).stem}: {function.split('[')[0].removeprefix('test_').replace('_', ' ')}"


def fault_words(rows: Sequence[Row]) -> str:
    """How many faults were survived, kind by kind."""
    if not rows:
        return (
            "Faults were not made beside this report: `python -m tests.faults.campaign` kills runs, studies and "
            "reports, plants what is not finite, damages files and gives wrong scenes."
        )
    moments: Counter[str] = Counter()
    for row in rows:
        moments[str(row["fault"])] += int(row["moments"])
    bad = "; ".join(f"{row['fault']}, {row['what']}" for row in rows if row["outcome"] != SURVIVED)
    kinds = ", ".join(f"{kind}: {count}" for kind, count in moments.items())
    survived = sum(row["outcome"] == SURVIVED for row in rows)
    return (
        f"Faults made to happen at random moments and places, {moments.total()} in all ({kinds}): {survived} of "
        f"{len(rows)} kinds were survived, which means resumed without loss or refused by name, and no wrong answer. "
        + (f"Not survived: {bad}." if bad else "None failed.")
        + (
            f" {number(_sum(rows, 'seconds'), 3)} s of CPU in all."
            if all("seconds" in row for row in rows)
            else ""
        )
    )


def fault_table(rows: Sequence[Row]) -> Table:
    """Every kind of fault and how it ended."""
    cells = tuple(
        (
            str(row["fault"]),
            str(row["what"]).replace("_", " "),
            whole(float(row["moments"])),
            str(row["outcome"]) if row["outcome"] == SURVIVED else str(row["outcome"]).upper(),
            str(row["detail"]),
        )
        for row in rows
    )
    columns = ("fault", "of", "times", "outcome", "how it ended")
    return Table("Every kind of fault and how it ended.", columns, cells, wide=(1, 4))


def _sum(rows: Sequence[Row], key: str) -> float:
    return sum(float(row[key]) for row in rows)
