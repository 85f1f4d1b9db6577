"""What the commands do, once their words are understood."""

from __future__ import annotations

import argparse
import math
import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cases.interrupt import Interruption
from cases.problems import Problem, SceneError, did_you_mean, one_of, shown
from cases.scene import Scene, load_scene, scene_names
from cases.schema import LARGEST_NODES, SMALLEST_NODES

if TYPE_CHECKING:
    from cases.unstructured import AnySolution

MOST_THREADS = 1024
LARGEST_SEED = 2**63 - 1


@dataclass(frozen=True)
class Request:
    """A scene and the numbers to solve it with, all checked."""

    scene: Scene
    methods: tuple[str, ...]
    nodes: int | None
    seed: int
    threads: int
    tolerance: float | None


def list_scenes(_: argparse.Namespace, __: Interruption) -> int:
    """Print name, title, methods and default nodes of every built-in scene."""
    from cases.methods import methods_of

    scenes = [load_scene(name) for name in scene_names()]
    rows = [("scene", "title", "methods", "nodes")] + [
        (scene.name, scene.title, ", ".join(methods_of(scene)), str(scene.mesh.nodes)) for scene in scenes
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    for row in rows:
        print("  ".join([*(word.ljust(width) for word, width in zip(row, widths, strict=False)), row[3]]))
    return 0


def run_scene(arguments: argparse.Namespace, interruption: Interruption) -> int:
    """Solve one scene by one method into one folder; the exit code is the status's."""
    request = read_request(arguments, [arguments.method])
    method = request.methods[0]
    _check_fit(request.scene, method)
    if arguments.accuracy is not None:
        return _run_to_accuracy(arguments, request, interruption)
    out = out_folder(arguments.out, f"runs/{request.scene.name}-{method}")
    from cases.progress import display
    from cases.runner import run

    with display(arguments.quiet) as progress:
        solution = run(
            request.scene,
            method,
            nodes=request.nodes,
            seed=request.seed,
            threads=request.threads,
            tolerance=request.tolerance,
            out=out,
            resume=arguments.resume,
            force=arguments.force,
            progress=interruption.watch(progress),
            strict=arguments.strict,
        )
    return _told(arguments, solution, out)


def _run_to_accuracy(arguments: argparse.Namespace, request: Request, interruption: Interruption) -> int:
    """Refine until the run's own error estimate is small enough."""
    from cases.accuracy import read_accuracy, run_to_accuracy
    from cases.progress import display

    accuracy = read_accuracy(arguments.accuracy)
    if request.nodes is not None:
        message = "--accuracy chooses the nodes; give one of the two"
        raise SceneError([Problem("", "--nodes", str(request.nodes), message)])
    out = out_folder(arguments.out, f"runs/{request.scene.name}-{request.methods[0]}")
    with display(arguments.quiet) as progress:
        solution = run_to_accuracy(
            request.scene,
            request.methods[0],
            accuracy,
            seed=request.seed,
            threads=request.threads,
            tolerance=request.tolerance,
            out=out,
            force=arguments.force,
            progress=interruption.watch(progress),
            strict=arguments.strict,
        )
    return _told(arguments, solution, out)


def _told(arguments: argparse.Namespace, solution: AnySolution, out: Path) -> int:
    """Say how a run ended; the exit code is the status's."""
    for warning in solution.warnings:
        print(f"wrinkle: warning: {warning}", file=sys.stderr)
    code = solution.status.exit_code
    residual = f"residual {solution.residual:.2g}, {solution.seconds:.3g} s"
    print(f"{out}: {solution.status.value}; {solution.grid.nodes} nodes, {solution.steps} steps, {residual}")
    if code != 0:
        print(f"wrinkle: {solution.message}", file=sys.stderr)
    if code == 130:
        print(f"wrinkle: to go on: {_again(arguments)}", file=sys.stderr)
    return code


def _check_fit(scene: Scene, method: str) -> None:
    """Raise SceneError for a method that the scene does not have, before a folder is made for it."""
    from cases.methods import METHODS, methods_of, why_unfit

    fitting = methods_of(scene)
    if method in METHODS and method not in fitting:
        message = f"{why_unfit(scene, method)}; there are {one_of(fitting)}"
        raise SceneError([Problem("", "--method", method, message)])


def compare_methods(arguments: argparse.Namespace, interruption: Interruption) -> int:
    """Solve one scene by several methods and write their differences."""
    words = None if arguments.methods is None else words_of(arguments.methods, "--methods")
    request = read_request(arguments, words)
    from cases.compare import compare
    from cases.methods import methods_of
    from cases.progress import display

    methods = request.methods or methods_of(request.scene)
    out = out_folder(arguments.out, f"runs/{request.scene.name}-compare")
    with display(arguments.quiet) as progress:
        found = compare(
            request.scene,
            methods,
            nodes=request.nodes,
            out=out,
            seed=request.seed,
            threads=request.threads,
            tolerance=request.tolerance,
            resume=arguments.resume,
            force=arguments.force,
            progress=interruption.watch(progress),
        )
    for name, why in found.refused.items():
        print(f"wrinkle: warning: {name} was left out: {why}", file=sys.stderr)
    table = found.table.set_index("method").astype(object)
    print(table.where(table.notna(), "-").T.to_string(float_format=_short))
    for reference, rows in found.differences.groupby("reference", sort=False):
        print(f"\ndifferences from {reference}")
        shown = rows.drop(columns="reference").dropna(axis="columns", how="all")
        print(shown.to_string(index=False, float_format=_short, na_rep="-"))
    print(out)
    return 0


def _short(number: float) -> str:
    return f"{number:.5g}"


def doctor(arguments: argparse.Namespace, _: Interruption) -> int:
    """Print what this installation has and lacks."""
    from cases.doctor import examine

    return examine(arguments.bench)


def read_request(arguments: argparse.Namespace, methods: Sequence[str] | None) -> Request:
    """The scene and the numbers of a command line. Raises SceneError with every problem of both."""
    problems: list[Problem] = []
    scene = None
    try:
        scene = load_scene(arguments.scene, arguments.set)
    except SceneError as error:
        problems += error.problems
    nodes = whole_number("--nodes", arguments.nodes, SMALLEST_NODES, LARGEST_NODES, problems)
    seed = whole_number("--seed", arguments.seed, 0, LARGEST_SEED, problems)
    threads = whole_number("--threads", arguments.threads, 1, MOST_THREADS, problems)
    tolerance = _tolerance(arguments.tol, problems)
    chosen = method_names(methods or (), problems)
    if problems or scene is None:
        raise SceneError(problems)
    return Request(scene, chosen, nodes, seed or 0, threads or 1, tolerance)


def whole_number(option: str, text: str | None, low: int, high: int, problems: list[Problem]) -> int | None:
    """A whole number in a range; None (and a problem, if something was given) otherwise."""
    if text is None:
        return None
    digits = text.strip().replace("_", "")
    number = int(digits) if digits.lstrip("+-").isdecimal() and len(digits) <= 20 else None
    if number is not None and low <= number <= high:
        return number
    near = "" if number is None else f"; the nearest is {min(max(number, low), high)}"
    value = shown(text) if number is None else digits
    problems.append(Problem("", option, value, f"must be a whole number from {low} to {high}{near}"))
    return None


def _tolerance(text: str | None, problems: list[Problem]) -> float | None:
    if text is None:
        return None
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if 1e-14 <= number <= 0.1:
        return number
    problems.append(Problem("", "--tol", shown(text), "must be a residual from 1e-14 to 0.1"))
    return None


def method_names(words: Sequence[str], problems: list[Problem]) -> tuple[str, ...]:
    """Names of methods that exist."""
    if not words:
        return ()
    from cases.methods import METHODS

    now = ("auto", *METHODS)
    for word in words:
        if word not in now:
            message = f"must be {one_of(now)}{did_you_mean(word, now)}"
            problems.append(Problem("", "--method", shown(word), message))
    return tuple(dict.fromkeys(words))


def words_of(text: str, option: str) -> list[str]:
    """Words separated by commas. Raises SceneError if there is none."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words:
        raise SceneError([Problem("", option, shown(text), "must be names separated by commas")])
    return words


def out_folder(given: str | None, default: str) -> Path:
    """The folder for results. Raises SceneError for a path that cannot be one."""
    text = default if given is None else given
    path = Path(text)
    try:
        blocking = next(
            (place for place in (path, *path.parents) if place.exists() and not place.is_dir()), None
        )
        unusable = None if blocking is None else f"{shown(str(blocking))} is a file"
    except (OSError, ValueError) as error:
        unusable = str(error)
    if not text:
        unusable = "the name is empty"
    if unusable is not None:
        raise SceneError(
            [Problem("", "--out", shown(text), f"must be a folder that can be made: {unusable}")]
        )
    return path


def _again(arguments: argparse.Namespace) -> str:
    """The command that continues an interrupted run."""
    words = ["wrinkle", "run", arguments.scene, "--method", arguments.method]
    for option in ("nodes", "accuracy", "seed", "threads", "tol", "out"):
        value = getattr(arguments, option)
        if value is not None and (option, value) not in (("seed", "0"), ("threads", "1")):
            words += [f"--{option}", value]
    for change in arguments.set:
        words += ["--set", change]
    return shlex.join([*words, "--resume"])
