"""`wrinkle hard`: the table of hard cases."""

from __future__ import annotations

import argparse
import sys

from cases.commands import out_folder, words_of
from cases.hard import VERDICTS
from cases.interrupt import Interruption
from cases.problems import Problem, SceneError, did_you_mean, one_of, shown


def hard(arguments: argparse.Namespace, interruption: Interruption) -> int:
    """Run the hard cases; 0 when finished, whatever their verdicts, which the table shows."""
    from cases.hard_table import counts, hard_cases, run_hard

    known = tuple(dict.fromkeys(case.family for case in hard_cases()))
    families = [] if arguments.families is None else words_of(arguments.families, "--families")
    unknown = [word for word in families if word not in known]
    if unknown:
        raise SceneError(
            Problem("", "--families", shown(word), f"must be {one_of(known)}{did_you_mean(word, known)}")
            for word in unknown
        )
    out = out_folder(arguments.out, "runs/hard")
    say = None if arguments.quiet else _say
    table = run_hard(out, families, say, interruption)
    found = counts(table)
    for row in table.itertuples():
        if row.verdict != VERDICTS[0]:
            print(f"{row.name}: {row.verdict}: {row.status} {row.message}")
    print(f"{out / 'hard.csv'}: {len(table)} cases; " + ", ".join(f"{found.get(v, 0)} {v}" for v in VERDICTS))
    return 0


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
