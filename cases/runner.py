"""One solve of a scene by one method, into one result folder."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from cases.advice import FEWEST_NODES_PER_WRINKLE, advice
from cases.effects import Effects, as_document, not_justified
from cases.folders import FolderRefused, alone, recover
from cases.memory import refuse_too_many
from cases.methods import (
    Method,
    MethodError,
    Task,
    choose,
    effects_of,
    with_numbers,
)
from cases.results import (
    CHECKPOINT_NAME,
    Probes,
    ResultError,
    load_result,
    probe,
    read_document,
    write_result,
)
from cases.scene import SceneError, load_scene
from cases.scene_text import scene_hash, scene_toml
from cases.schema import LARGEST_NODES, SMALLEST_NODES, Scene
from cases.unstructured import AnySolution
from fdsolver.checkpoint import Checkpoint, make_folder, storage_error, write_atomically
from fdsolver.relax import Progress
from fdsolver.result import Status

# A run that ended so can go on from its checkpoint.
UNFINISHED = (Status.INTERRUPTED, Status.STEP_LIMIT, Status.TIME_LIMIT)


def run(
    scene: Scene,
    method: str = "auto",
    nodes: int | None = None,
    seed: int = 0,
    threads: int = 1,
    tolerance: float | None = None,
    out: Path | str | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Callable[[Progress], None] | None = None,
    strict: bool = False,
) -> AnySolution:
    """Solve a scene; with `out`, leave a result folder there and return what is in it.

    method : a name of `cases.methods.NAMES`. nodes, tolerance : instead of the scene's. seed : of the random
        start.
    out : a folder that already holds this very run (scene, method, nodes, seed, tolerance) is not solved
        again: its result is returned, its checkpoint continued.
    resume : also continue a run that ended at a step or time limit. force : replace a different result in
        `out`.
    progress : called now and then by the engine. strict : less than 6 nodes per wrinkle is the status
        under_resolved, an effect wrongly left out the status not_justified.

    Raises MethodError, TooManyNodes, FolderRefused, CheckpointError (nothing is written) and StorageError
    (what was there is unchanged).
    """
    _check_numbers(nodes, seed, threads, tolerance)
    chosen, why = choose(scene, method)
    resolved = with_numbers(scene, chosen, nodes, tolerance)
    identity = scene_hash(resolved, chosen.name, seed=seed, start=_fingerprint(resolved))
    task = Task(resolved, seed, threads, progress, None)
    points = (resolved.mesh.vertices if chosen.finite_elements else None) or resolved.mesh.nodes
    if out is None:
        refuse_too_many(points)
        return _solve(chosen, task, why, strict)[0]
    out = Path(out)
    stored = _stored(out, identity, resolved, resume, force)
    if stored is not None:
        return stored
    refuse_too_many(points)
    make_folder(out)
    with alone(out):
        # it may have been finished, or become something else, just before it was ours
        stored = _stored(out, identity, resolved, resume, force)
        if stored is not None:
            return stored
        checkpoint = _open(out, resolved, identity, fresh=force and not resume)
        solution, probes, effects = _solve(chosen, replace(task, checkpoint=checkpoint), why, strict)
        if not (solution.status is Status.INTERRUPTED and _has_result(out)):
            # An interrupted run never takes the place of a finished one; its checkpoint is there to go on.
            unfinished = solution.status in UNFINISHED
            write_result(out, solution, resolved, probes, as_document(effects), identity, unfinished)
    return solution


def _solve(chosen: Method, task: Task, why: str, strict: bool) -> tuple[AnySolution, Probes, Effects]:
    """The judged solution, what was measured along the lines of its scene, and its effects."""
    solution = chosen.solve(task)
    probes = probe(solution, task.scene)
    effects = effects_of(chosen, solution, task.scene)
    return _judged(solution, task.scene, probes, effects, why, strict), probes, effects


def _fingerprint(scene: Scene) -> str | None:
    """What identifies the state that the scene starts from, whatever its folder is called; None if it names no folder.

    Raises ResultError if there is no such state.
    """
    if scene.start.source is None or scene.start.source.startswith("mode:"):
        return None
    solution = load_result(scene.start.source)
    return hashlib.sha256(solution.grid.u.tobytes() + solution.r.tobytes()).hexdigest()


def _check_numbers(nodes: int | None, seed: int, threads: int, tolerance: float | None) -> None:
    """Raise MethodError for numbers out of range (the scene's own have been checked with the scene)."""
    if nodes is not None and not (_whole(nodes) and SMALLEST_NODES <= nodes <= LARGEST_NODES):
        raise MethodError(
            f"nodes must be a whole number from {SMALLEST_NODES} to {LARGEST_NODES}, not {nodes!r}."
        )
    if not (_whole(seed) and 0 <= seed < 2**63):
        raise MethodError(f"seed must be a whole number from 0 to 2^63 - 1, not {seed!r}.")
    if not (_whole(threads) and 1 <= threads <= 1024):
        raise MethodError(f"threads must be a whole number from 1 to 1024, not {threads!r}.")
    if tolerance is not None and not (math.isfinite(tolerance) and 1e-14 <= tolerance <= 0.1):
        raise MethodError(f"tolerance must be a residual from 1e-14 to 0.1, not {tolerance!r}.")


def _whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _stored(out: Path, identity: str, scene: Scene, resume: bool, force: bool) -> AnySolution | None:
    """The finished result of this very run in `out`, or None if there is something to solve.

    Raises FolderRefused for a folder that holds anything else (unless it is a run and `force` replaces it).
    """
    recover(out)
    if not out.exists() or (out.is_dir() and not any(out.iterdir())):
        return None
    names = {path.name for path in out.iterdir()} if out.is_dir() else set()
    if not names & {"result.json", "scene.toml", CHECKPOINT_NAME}:
        raise FolderRefused(f"{out} exists and is no result folder; choose another place with --out.")
    if force:
        return None
    if "result.json" not in names:
        if _same_scene(out, scene):
            return None
        raise FolderRefused(f"{out} holds an unfinished run of something else; --force replaces it.")
    document = _document(out)
    if document.get("scene_hash") != identity:
        raise FolderRefused(
            f"{out} holds a result of another scene, mesh or setting ({document.get('scene')} by"
            f" {document.get('method')}); --force replaces it."
        )
    status = document["status"]
    if status == Status.INTERRUPTED.value or (resume and status in [end.value for end in UNFINISHED]):
        return None
    try:
        return load_result(out)
    except ResultError as reason:
        raise FolderRefused(f"{reason} --force replaces it.") from reason


def _document(out: Path) -> dict:
    try:
        return read_document(out)
    except ResultError as reason:
        raise FolderRefused(f"{reason} --force replaces it.") from reason


def _same_scene(out: Path, scene: Scene) -> bool:
    """Whether an unfinished run in `out` began from this scene, whatever its limits (its checkpoint names method and
    seed itself).
    """
    try:
        return scene_hash(load_scene(out / "scene.toml"), "") == scene_hash(scene, "")
    except (SceneError, OSError):
        return False


def _has_result(out: Path) -> bool:
    """Whether a finished result stands in `out`."""
    try:
        return read_document(out)["status"] != Status.INTERRUPTED.value
    except ResultError:
        return False


def _open(out: Path, scene: Scene, identity: str, fresh: bool) -> Checkpoint:
    """The checkpoint of a run that starts in its folder; `fresh` drops an old one.

    Raises StorageError, and CheckpointError for a checkpoint that cannot be continued.
    """
    checkpoint = Checkpoint(out / CHECKPOINT_NAME, identity)
    try:
        if fresh:
            checkpoint.delete()
    except OSError as reason:
        raise storage_error(out, reason) from reason
    checkpoint.load()  # refuse now what could not be continued
    if not (out / "result.json").exists():
        text = scene_toml(scene).encode("utf-8")
        write_atomically(out / "scene.toml", lambda file: file.write(text))
    return checkpoint


def _judged(
    solution: AnySolution, scene: Scene, probes: Probes, effects: Effects, why: str, strict: bool
) -> AnySolution:
    """Add what the scene, the probes and the audit say: assumptions, the choice of `auto`, wrinkles that the mesh
    does not carry, effects that should not have been left out.
    """
    warnings = list(solution.warnings)
    if why:
        warnings.insert(0, why)
    if scene.assumed:
        warnings.append(f"assumed, as the scene does not give them: {', '.join(scene.assumed)}")
    per_wrinkle, status = probes.nodes_per_wrinkle, solution.status
    message = solution.message + advice(status, solution.grid.nodes, per_wrinkle)
    if per_wrinkle is not None and per_wrinkle < FEWEST_NODES_PER_WRINKLE:
        warnings.append(
            f"the wrinkles have {per_wrinkle:.1f} nodes each, fewer than"
            f" {FEWEST_NODES_PER_WRINKLE}: their number may be the mesh's"
        )
        if strict and status.exit_code in (0, 3):
            status, message = Status.UNDER_RESOLVED, Status.UNDER_RESOLVED.sentence
    wrong = not_justified(effects)
    warnings += [f"leaving out {name} is not justified: {effects[name].why}" for name in wrong]
    if wrong and strict and status.exit_code in (0, 3):
        status, message = Status.NOT_JUSTIFIED, Status.NOT_JUSTIFIED.sentence
    return replace(solution, status=status, message=message, warnings=tuple(warnings))
