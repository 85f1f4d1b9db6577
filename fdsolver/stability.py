"""Is an equilibrium stable? The lowest eigenvalue of its tangent.

A relaxation can come to rest on an unstable equilibrium: the residual of a flat sheet falls below any tolerance long
before its wrinkles grow. Planar states are judged by their exact out-of-plane tangent (`planar`), bent plates by a
factor of theirs (`spatial`). For meshes too large for that, membranes, and parts of sheets, Lanczos iteration looks for
negative eigenvalues of the tangent K against the nodal masses m of the relaxation, K v = w m v: a Ritz value is never
below the lowest eigenvalue, so a negative one proves instability; that none is found is no proof of stability where
waves are much longer than the cells.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh_tridiagonal

from fdsolver.damping import twice_kinetic_in_space
from fdsolver.effects import Force
from fdsolver.finish import relax_or_finish
from fdsolver.level import Level
from fdsolver.planar import is_tense, lowest_out_of_plane
from fdsolver.reduced import unfolded
from fdsolver.relax import Settings, State, kick
from fdsolver.result import Status
from fdsolver.rows import compiled
from fdsolver.settled import Growth, growth_to_come
from fdsolver.spatial import examinable, lowest_in_space

MOST_STEPS = 800
LOOK_EVERY = 50
NEUTRAL = 1e-6  # above minus this an eigenvalue is zero: wrinkles slide and fold almost freely, and differences round
PROBE = 1e-7  # size of the displacement, in L, whose change of force gives K v

MOST_KICKS = 4
MOST_GROWTHS = 8  # steps towards the height of waves: three or four do
FINEST = 1e-10  # tolerance below which no kicked state need come to rest
KICKED_TOLERANCE = 1e-5  # a state that was kicked once comes to rest at a tenth of it
FLAT_TOLERANCE = 1e-7  # of a flat state that is examined: the compression that wrinkles thin sheets is small
PLANAR = 0.01  # out-of-plane displacement / thickness below which a state is flat
CONVEX = "the relaxed energy is convex"
UNKNOWN = "not examined: the tangent is too large, or its lowest eigenvalue was not found"
HELD_FLAT = "no zone is compressed: tension and bending hold the sheet in its plane"
UNSETTLED = "not settled: the waves would still change by {:.0%} of their height"
FACTOR = "factor of the tangent: no eigenvalue of it, against that of the flat sheet's bending, is below this"
BENT = "lowest eigenvalue of the tangent, against that of the flat sheet's bending"
EXACT = "lowest eigenvalue of the out-of-plane tangent of the flat sheet, against that of the sheet without compression"


@dataclass(frozen=True)
class Stability:
    """The verdict on an equilibrium.

    stable : whether no negative eigenvalue was found. lowest : the lowest, as `how` says. evaluations : of the force.
    mode : (3, ni, nj) of that value, largest component 1, when unstable.
    """

    stable: bool
    lowest: float
    how: str
    evaluations: int
    mode: np.ndarray | None


def examine(level: Level, state: State, flat: float = 0.0) -> Stability:
    """Look for a direction in which the equilibrium `state` of a level is unstable.

    The state's masses and positions are read, not changed. flat : range of z, L, up to which the state counts as
    planar.
    """
    force, seed = level.examined, level.problem.seed
    if force.local and np.ptp(state.r[2]) <= flat:
        if is_tense(force, state.r):
            return Stability(True, 1.0, HELD_FLAT, 1, None)
        if (planar := lowest_out_of_plane(force, state.r, ~level.fixed, seed)) is not None:
            lowest, shape, evaluations = planar
            mode = np.stack([0.0 * shape, 0.0 * shape, shape])
            stable = lowest >= -NEUTRAL
            return Stability(stable, lowest, EXACT, evaluations, None if stable else mode)
    elif examinable(force):
        found = lowest_in_space(force, state.r, level.scaled(level.flat), level.weight, seed)
        if found is not None:
            return Stability(found[1] is None, found[0], FACTOR if found[1] is None else BENT, *found[2:0:-1])
    return search(force, state, seed)


def search(force: Force, state: State, seed: int = 0) -> Stability:
    """Look for a negative eigenvalue of the tangent of any state by Lanczos iteration, as `examine`."""
    free = state.inverse_mass[2] > 0.0
    start = np.zeros_like(state.r)
    start[2, free] = np.random.default_rng(seed).standard_normal(int(free.sum()))
    diagonal, off, steps = _lanczos(force, state, start, None)
    values, vectors = eigh_tridiagonal(diagonal, off, select="i", select_range=(0, 0))
    lowest, how = (
        float(values[0]),
        f"lowest Ritz value of the tangent against the nodal masses, {steps} Lanczos steps",
    )
    if lowest >= -NEUTRAL:
        return Stability(True, lowest, how, steps, None)
    mode = np.zeros_like(start)
    _lanczos(force, state, start, (vectors[:, 0], mode))
    return Stability(False, lowest, how, 2 * steps, mode / np.abs(mode).max())


def _lanczos(
    force: Force, state: State, start: np.ndarray, combine: tuple[np.ndarray, np.ndarray] | None
) -> tuple[np.ndarray, np.ndarray, int]:
    """Tridiagonal form of m^-1 K from `start`; or, with `combine` = (coefficients, sum), the sum of its basis vectors.

    The basis is not kept (it would be hundreds of fields): the second pass makes the same vectors again. Lost
    orthogonality only repeats eigenvalues that have converged, and does not move the lowest.
    """
    nodes = state.r.shape[1] * state.r.shape[2]
    mass, inverse = state.mass.reshape(6, nodes), state.inverse_mass.reshape(6, nodes)
    at_rest, moved, place = np.zeros_like(state.r), np.zeros_like(state.r), np.empty_like(state.r)
    force(state.r, at_rest)
    change = moved.reshape(3, nodes)
    q, previous, image = start.reshape(3, nodes).copy(), np.zeros((3, nodes)), np.empty((3, nodes))
    q /= np.sqrt(twice_kinetic_in_space(q, mass))
    diagonal: list[float] = []
    off: list[float] = []
    best = np.inf
    for k in range(MOST_STEPS if combine is None else combine[0].size):
        if combine is not None:
            combine[1][:] += combine[0][k] * q.reshape(state.r.shape)
        probe = PROBE / max(q.max(), -q.min())
        np.multiply(q.reshape(state.r.shape), probe, out=place)
        place += state.r
        force(place, moved)
        coupling = off[-1] if off else 0.0
        along, size = _orthogonalise(
            q, previous, at_rest.reshape(3, nodes), change, probe, coupling, mass, inverse, image
        )
        diagonal.append(along)
        previous, q, image = q, image, previous
        q /= size
        if combine is None and (k + 1) % LOOK_EVERY == 0:
            lowest = eigh_tridiagonal(diagonal, off, select="i", select_range=(0, 0), eigvals_only=True)[0]
            settled = lowest > 1.05 * best if best < -NEUTRAL else lowest > 0.999 * best > 0.0
            if settled:
                break
            best = float(lowest)
        off.append(size)
    return np.asarray(diagonal), np.asarray(off[: len(diagonal) - 1]), len(diagonal)


@compiled
def _orthogonalise(q, previous, at_rest, moved, probe, coupling, mass, inverse, image):
    """image = m^-1 K q less its parts along q and `previous`; returns the part along q and the size of the rest."""
    along = 0.0
    for k in range(q.shape[1]):
        x, y, z = (
            (at_rest[0, k] - moved[0, k]) / probe,
            (at_rest[1, k] - moved[1, k]) / probe,
            (at_rest[2, k] - moved[2, k]) / probe,
        )
        along += x * q[0, k] + y * q[1, k] + z * q[2, k]  # q is zero where anything is held
        xy, xz, yz = inverse[3, k], inverse[4, k], inverse[5, k]
        image[0, k] = inverse[0, k] * x + xy * y + xz * z
        image[1, k] = xy * x + inverse[1, k] * y + yz * z
        image[2, k] = xz * x + yz * y + inverse[2, k] * z
    for axis in range(3):
        for k in range(q.shape[1]):
            image[axis, k] -= along * q[axis, k] + coupling * previous[axis, k]
    return along, np.sqrt(twice_kinetic_in_space(image, mass))


def _relax_to_examine(
    level: Level, state: State, settings: Settings, on_block: Callable[[State], None] | None
) -> Status:
    """Relax to the tolerance at which the state can be examined; see `relax_to_stable`."""
    tolerance = settings.tolerance
    if state.kicks:
        tolerance = min(tolerance, max(KICKED_TOLERANCE * 0.1**state.kicks, FINEST))
    status = relax_or_finish(level, state, replace(settings, tolerance=tolerance), on_block)
    height = PLANAR * level.problem.sheet.thickness_mm / level.grid.length_mm
    flat = level.model.buckles and len(state.r) == 3 and np.ptp(state.r[2]) <= height
    if status is Status.CONVERGED and flat and tolerance > FLAT_TOLERANCE:
        status = relax_or_finish(level, state, replace(settings, tolerance=FLAT_TOLERANCE), on_block)
    return status


def _examine(level: Level, state: State, flat: float) -> Stability:
    """`examine` the state of a level; one that is computed in the plane, in space."""
    if len(state.r) == 3:
        return examine(level, state, flat)
    level, state = unfolded(level, state)
    if is_tense(level.force, state.r):
        return Stability(True, 1.0, HELD_FLAT, 1, None)
    space = Level(level.problem, replace(level.model, out_of_plane=True), level.grid, 1)
    r = np.concatenate([state.r, np.zeros_like(state.r[:1])])
    found = lowest_out_of_plane(space.force, r, ~level.fixed, level.problem.seed)
    if found is None:
        return Stability(False, float("nan"), UNKNOWN, 0, None)
    return Stability(found[0] >= -NEUTRAL, found[0], EXACT, found[2], None)


def _growth(level: Level, state: State, flat: float) -> Growth | None:
    """What the waves of a state still have to grow; None where there are none or they have settled."""
    if not level.model.buckles or len(state.r) < 3 or np.ptp(state.r[2]) <= flat:
        return None
    growth = growth_to_come(level.force, level.examined, state)
    state.evaluations += growth.evaluations
    return None if growth.settled else growth


def _judge(level: Level, state: State, flat: float) -> Stability | Growth:
    """How the waves of a state still grow, or whether it is stable: of an unstable one the height tells nothing."""
    if state.growths and (growth := _growth(level, state, flat)) is not None:
        return growth  # it was stable before
    verdict = _examine(level, state, flat)
    state.evaluations += verdict.evaluations
    if verdict.stable and not state.growths and (growth := _growth(level, state, flat)) is not None:
        return growth
    return verdict


def relax_to_stable(
    level: Level,
    state: State,
    settings: Settings,
    on_block: Callable[[State], None] | None = None,
    finest: bool = True,
) -> tuple[Status, dict[str, object]]:
    """Relax, examine, and leave an unstable equilibrium along its mode, until a stable one is found.

    finest : a coarser mesh of a sheet in its plane is not examined, because nothing can be kicked out of it.

    The kick is one thickness. The tolerance falls with every kick: near a saddle the force is small far from the
    equilibrium that is sought. Waves that have not settled are taken to their height. Models that do not buckle are
    examined, not kicked. Returns the Status (of the last relaxation, INTERRUPTED, UNSTABLE_FLAT when kicks do not
    move a flat sheet, or STALLED when waves do not settle) and the verdict {"stable", "how", "lowest"}.
    """
    height = level.problem.sheet.thickness_mm / level.grid.length_mm
    while True:
        status = _relax_to_examine(level, state, settings, on_block)
        if level.model.relaxed:
            return status, {"stable": True, "how": CONVEX, "lowest": None}
        if status is not Status.CONVERGED:
            return status, {"stable": None, "how": "not examined: the state is not converged", "lowest": None}
        if not finest and len(state.r) == 2:
            return status, {"stable": None, "how": "not examined: a finer mesh follows", "lowest": None}
        started = time.perf_counter()
        try:
            verdict = _judge(level, state, PLANAR * height)
        except KeyboardInterrupt:
            return Status.INTERRUPTED, {"stable": None, "how": "not examined: interrupted", "lowest": None}
        state.seconds += time.perf_counter() - started
        if isinstance(verdict, Growth):
            if state.growths == MOST_GROWTHS:
                return Status.STALLED, {
                    "stable": None,
                    "how": UNSETTLED.format(verdict.share),
                    "lowest": None,
                }
            kick(state, verdict.displacement, growth=True)
            continue
        answer = {"stable": verdict.stable, "how": verdict.how, "lowest": verdict.lowest}
        if verdict.mode is None or not level.model.buckles:
            return status, answer
        if state.kicks == MOST_KICKS:
            flat = np.abs(state.r[2]).max() < PLANAR * height
            return Status.UNSTABLE_FLAT if flat else status, answer
        kick(state, height * verdict.mode)
