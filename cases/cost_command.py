"""`wrinkle cost`: from the words of the command line to the table of costs."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from cases.commands import method_names, out_folder, whole_number, words_of
from cases.cost_plan import MAX_SECONDS, MESHES, Extent
from cases.interrupt import Interruption
from cases.overrides import read_overrides
from cases.problems import Problem, SceneError, shown
from cases.scene import load_scene
from cases.schema import LARGEST_NODES, SMALLEST_NODES

MOST_REPEATS = 1000


def cost_of_accuracy(arguments: argparse.Namespace, interruption: Interruption) -> int:
    """Measure what accuracy costs for one scene; 0 when finished, whatever the single runs' statuses."""
    problems: list[Problem] = []
    scene = None
    try:
        scene = load_scene(arguments.scene, arguments.set)
    except SceneError as error:
        problems += error.problems
    changes = read_overrides(arguments.set)[0]
    words = [] if arguments.methods is None else words_of(arguments.methods, "--methods")
    methods = method_names(words, problems)
    meshes = [
        whole_number("--nodes", word, SMALLEST_NODES, LARGEST_NODES, problems)
        for word in ([] if arguments.nodes is None else words_of(arguments.nodes, "--nodes"))
    ]
    seconds = _seconds(arguments.seconds, problems)
    repeats = whole_number("--repeats", arguments.repeats, 1, MOST_REPEATS, problems)
    if problems or scene is None:
        raise SceneError(problems)
    out = out_folder(arguments.out, f"runs/{scene.name}-cost")
    from cases.cost import cost

    source = arguments.scene if not Path(arguments.scene).exists() else str(Path(arguments.scene).absolute())
    found = cost(
        source,
        out,
        changes,
        methods or None,
        Extent(
            sorted(count for count in meshes if count) or MESHES,
            not arguments.no_options,
            repeats or 1,
            seconds,
        ),
        None if arguments.quiet else _say,
        interruption,
    )
    for sentence in found.sentences:
        print(sentence)
    print(f"{out / 'cost.csv'}: {len(found.rows)} runs, {sum(one.converged for one in found.rows)} converged")
    return 0


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _seconds(text: str | None, problems: list[Problem]) -> float:
    """The time limit of a run."""
    try:
        value = MAX_SECONDS if text is None else float(text)
    except ValueError:
        value = -1.0
    if not 0.0 < value <= 1e8:
        message = "must be a positive number of seconds, at most 1e8"
        problems.append(Problem("", "--seconds", shown(text), message))
    return value
