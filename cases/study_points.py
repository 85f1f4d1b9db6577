"""The points of a study: which scene with which changes, by which method, on which mesh, from which start."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cases.methods import METHODS, MethodError, choose, methods_of, with_numbers
from cases.overrides import WHERE as CHANGED
from cases.problems import Problem, SceneError, did_you_mean, one_of, shown
from cases.scene import load_scene
from cases.scene_text import scene_hash
from cases.schema import Scene

LONGEST_NAME = 80
MOST_POINTS = 10_000
Change = Mapping[str, object]


@dataclass(frozen=True)
class Point:
    """One solve of a study.

    name : of its result folder: what varies, in words, and eight digits of the identity of the solve.
    scene : built-in name or path. changes : dotted scene keys -> values. nodes : None for the method's default.
    refused : why it cannot be solved, or "".
    """

    name: str
    scene: str
    changes: Change
    method: str
    nodes: int | None
    seed: int
    refused: str = ""
    threads: int = 1


@dataclass(frozen=True)
class Choices:
    """What a study varies besides the keys of its scene; None leaves the choice to the scene."""

    methods: Sequence[str] | None = None
    nodes: Sequence[int] | None = None
    seeds: Sequence[int] = (0,)


def make_points(scene: str, changes: Sequence[Change], choices: Choices, where: str) -> tuple[Point, ...]:
    """All points of a study, none twice: changes x methods x nodes x seeds.

    where : the study file, for the sentences. Methods without a random start get the first seed alone.

    Raises SceneError with every problem of every point.
    """
    problems = unknown_methods(choices.methods or (), where)
    count = len(changes) * len(choices.methods or METHODS) * len(choices.nodes or (0,)) * len(choices.seeds)
    if count > MOST_POINTS:
        raise SceneError(
            [*problems, Problem(where, "", None, f"has {count} points; at most {MOST_POINTS} are allowed")]
        )
    points: dict[str, Point] = {}
    for change in changes:
        try:
            loaded = load_scene(scene, dict(change))
        except SceneError as error:
            problems += [_in_study(problem, where) for problem in error.problems]
            continue
        if not problems:
            made = _points_of(loaded, scene, change, choices)
            points |= {point.name: point for point in made}
    if problems:
        raise SceneError(dict.fromkeys(problems))
    return tuple(points.values())


def unknown_methods(names: Sequence[str], where: str) -> list[Problem]:
    """One problem per name that is no method of this version."""
    now = ("auto", *METHODS)
    return [
        Problem(where, "study.methods", shown(name), f"must be {one_of(now)}{did_you_mean(name, now)}")
        for name in names
        if name not in now
    ]


def _points_of(scene: Scene, source: str, change: Change, choices: Choices) -> Iterator[Point]:
    """The points of one choice of scene keys."""
    fitting = methods_of(scene)
    for name, nodes in itertools.product(choices.methods or fitting, choices.nodes or (None,)):
        meshed = scene
        if nodes is not None:
            meshed = replace(scene, mesh=scene.mesh.model_copy(update={"nodes": nodes}))
        method, refused = name, ""
        try:
            method = choose(meshed, name)[0].name
            if method not in fitting:
                refused = f"The scene {scene.name} has no closed form here."
        except MethodError as reason:
            refused = str(reason)
        random = method in METHODS and METHODS[method].bending
        for seed in choices.seeds if random else choices.seeds[:1]:
            title = _name(scene, change, method, nodes, seed)
            yield Point(title, source, change, method, nodes, seed, refused)


def _name(scene: Scene, change: Change, method: str, nodes: int | None, seed: int) -> str:
    """A folder name that says what varies and is another one for another solve."""
    resolved = with_numbers(scene, METHODS[method], nodes, None) if method in METHODS else scene
    mesh = resolved.mesh
    count = mesh.vertices if method in METHODS and METHODS[method].finite_elements else mesh.nodes
    identity = scene_hash(resolved, method, seed=seed)[:8]
    words = [f"{key.rpartition('.')[2]}-{shown(value)}" for key, value in change.items()]
    plain = re.sub(r"[^A-Za-z0-9_.+-]+", "_", "-".join([method, *words])).replace("_-", "-").strip("_-.")
    return f"{plain[:LONGEST_NAME]}-n{count}-s{seed}-{identity}"


def _in_study(problem: Problem, where: str) -> Problem:
    """A problem of a changed key stands in the study file, one of the scene in the scene."""
    return replace(problem, where=where) if problem.where == CHANGED else problem


def scene_source(scene: str, folder: Path | None) -> str:
    """The scene's built-in name, or its path seen from the study file's folder."""
    from cases.read import scene_names

    if scene in scene_names() or folder is None:
        return scene
    path = folder / scene
    return os.path.abspath(path) if os.path.exists(path) else scene
