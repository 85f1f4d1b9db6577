"""Hard cases: how sheets, meshes, starts and steps at the edge of what can be solved came to an end."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from cases.hard import AS_EXPECTED, VERDICTS
from reports import figures_hard
from reports.content import Block, Drawing, Section, Table, Text
from reports.figures_hard import NAMED, PEER_COLOURS, Case
from reports.measured import read_document
from reports.style import number, whole

PEER_FILE = "hard_peer.json"
Peer = Mapping[str, Case]


def read_peer(folder: Path) -> Peer:
    """How another code ended on the cases, by their names; empty if it was not asked."""
    document = read_document(folder / PEER_FILE)
    return {row["name"]: row for row in document["rows"]} if document else {}


def build(rows: Sequence[Case], peer: Peer | None = None) -> Section:
    """The section; `rows` as `cases.hard_table.read_hard` gives them, none if they were not run.

    peer : as of `read_peer`.
    """
    title, other = "Hard cases", peer or {}
    if not rows:
        text = (
            "The hard cases were not run beside this report: `wrinkle hard` or `pytest -m benchmark` does it."
        )
        return Section("hard", title, [Text(text)])
    blocks: list[Block] = [Text(_words(rows)), _map(rows, other), _families(rows, other)]
    blocks += [Text(_peer_words(rows, other)), *_peer_mistakes(rows, other)] if other else []
    return Section("hard", title, [*blocks, _foretold(rows), _table(rows, other)])


def _words(rows: Sequence[Case]) -> str:
    found = Counter(row["verdict"] for row in rows)
    converged = sum(row["status"] == "converged" for row in rows)
    seconds = sum(row["seconds"] for row in rows)
    rising = sum(row["monotone"] is False for row in rows)
    return (
        f"{len(rows)} cases, each with its outcome and the reason for it stated beforehand: "
        + ", ".join(f"{found.get(verdict, 0)} {verdict}" for verdict in VERDICTS)
        + f". {converged} converged and were judged by their requirements; {number(seconds, 3)} s of solving in all."
        f" Strain plus kinetic energy rose at some look in {rising} of them: those that were kicked out of an unstable"
        " state, or whose unstable step was taken back."
    )


def _map(rows: Sequence[Case], peer: Peer) -> Drawing:
    found = Counter(row["verdict"] for row in rows)
    alt = "; ".join(f"{count} {verdict}" for verdict, count in found.items())
    caption = "How every hard case ended, one square each, family by family; the last table names them in this order."
    if peer:
        caption += " The strip below a square is how FElupe ended on the same case."
    draw = partial(figures_hard.draw_map, rows=rows, peer=peer)
    alt = f"Map of the hard cases: {alt}."
    return Drawing("hard-map", "Hard cases", caption, alt, draw, figures_hard.height_in(rows, peer))


def _families(rows: Sequence[Case], peer: Peer) -> Table:
    """Family by outcome."""
    cells = []
    for family in dict.fromkeys(row["family"] for row in rows):
        mine = [row for row in rows if row["family"] == family]
        verdicts = Counter(row["verdict"] for row in mine)
        named = sum(row["verdict"] == AS_EXPECTED and row["status"] != "converged" for row in mine)
        ends = Counter(peer[row["name"]]["outcome"] for row in mine if row["name"] in peer)
        counts = (len(mine), verdicts[AS_EXPECTED] - named, named, *(verdicts[v] for v in VERDICTS[1:]))
        others = (ends[outcome] for outcome in PEER_COLOURS) if peer else ()
        cells.append((family, *(str(n) for n in (*counts, *others))))
    cells.append(("all", *(str(sum(int(line[k]) for line in cells)) for k in range(1, len(cells[0])))))
    columns: tuple[str, ...] = ("family", "cases", "converged as expected", NAMED, *VERDICTS[1:])
    columns += tuple(f"FElupe: {outcome}" for outcome in PEER_COLOURS) if peer else ()
    return Table("Hard cases by family and outcome.", columns, tuple(cells))


def _peer_words(rows: Sequence[Case], peer: Peer) -> str:
    ends = Counter(row["outcome"] for row in peer.values())
    versions = {row["versions"].get("felupe", "") for row in peer.values()} - {""}
    counted = ", ".join(f"{ends[outcome]} {outcome}" for outcome in PEER_COLOURS)
    left_out = Counter(row["family"] for row in rows if row["name"] not in peer)
    but = ", ".join(f"{count} of {family}" for family, count in left_out.items())
    return (
        f"{len(peer)} of the cases{f' (not asked: {but})' if but else ''} were given to FElupe "
        f"{', '.join(sorted(versions))}, a finite-element code, from the same start on the same nodes: {counted}."
        " Newton's method has no time step. Membranes have biquadratic"
        " elements, plates are solids of one layer of triquadratic elements (Poisson ratio 0.499 for 0.5); Newton's"
        " method goes to the full load at once and, where that fails, in ten steps; a process may take 100 s. Its"
        " answers are judged by the cases' own requirements, widened by 1 %, and by the energies found here, within 1 %"
        " (plates 5 %); whether a state is stable, and its bending energy, it is not asked. With load steps, imposed"
        " imperfections and a line search of one's own making, case by case, more can be had from it."
    )


def _peer_mistakes(rows: Sequence[Case], peer: Peer) -> list[Table]:
    """What FElupe gave as converged and was not the answer."""
    wrong = "silent wrong answer"
    cells = tuple(
        (row["title"], str(peer[row["name"]]["message"]))
        for row in rows
        if peer.get(row["name"], {}).get("outcome") == wrong
    )
    columns = ("case", "what was wrong, and what was required")
    return [
        Table("What FElupe gave as converged and was not the answer.", columns, cells, wide=(0, 1))
    ] * bool(cells)


def _foretold(rows: Sequence[Case]) -> Table:
    """What was stated beforehand, once for all cases that share it."""
    count = Counter((row["family"], row["expected"], row["reason"]) for row in rows)
    cells = tuple(
        (family, str(number_of), expected.replace("_", " "), reason)
        for (family, expected, reason), number_of in count.items()
    )
    columns = ("family", "cases", "expected", "because")
    return Table("What was stated beforehand.", columns, cells, wide=(2, 3))


def _table(rows: Sequence[Case], peer: Peer) -> Table:
    columns: tuple[str, ...] = ("case", "ended", "verdict", "steps", "CPU s", "energy fell", "checker-board")
    cells = tuple(
        (
            row["title"],
            (row["status"] or row["message"]).replace("_", " "),
            row["verdict"],
            whole(row["steps"]),
            number(row["seconds"], 2),
            {True: "yes", False: "no", None: "–"}[row["monotone"]],
            number(math.nan if row["hourglass"] is None else row["hourglass"], 2),
            *((peer.get(row["name"], {}).get("outcome", "–"),) if peer else ()),
        )
        for row in rows
    )
    columns += ("FElupe",) if peer else ()
    caption = "Every hard case; checkerboard: largest share of the mesh's own pattern in the displacement."
    return Table(caption, columns, cells, wide=(0,))
