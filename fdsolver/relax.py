"""Dynamic relaxation: the only iteration loop of the plate and the membrane (paper section 3.2).

Explicit central differences [67-68] of m a + c v = f with a unit time step and masses of our choosing. The loop works
in blocks of `BLOCK` steps. A block begins with a look at the state: is the force below the tolerance, is everything
finite, has the strain energy grown beyond what the motion could give it? It ends with another: was the motion slow
enough for the time step? (The energy alone does not tell: capped velocities make an unstable step tremble, not grow.)
All that changes between blocks is in `State`, so a run continued from a saved state makes the same bits as one that
was never stopped.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fdsolver import damping
from fdsolver.effects import Force
from fdsolver.mass import invert, nodal_masses
from fdsolver.residual import residual, wanted
from fdsolver.result import Status

BLOCK = 10  # steps between two looks at residual and energy
MASS_EVERY = 10  # blocks between two updates of the masses
CAP = 5e-4  # largest speed of a node, lengths L per step: sharp folds form slowly enough to stay upright
FASTEST = 4.0  # omega^2 of a motion that central differences of unit step blow up: the masses are too light
GROWTH = 1.02  # a strain energy above this share of the last total energy is an unstable step
HEAVIER = 1.5  # factor on all masses at each recovery
RECOVERIES = 12  # before the run is given up
STALL_STEPS = 20000  # without a lower residual before the masses are raised, and again before giving up


Evaluate = Callable[
    [np.ndarray, np.ndarray], np.ndarray
]  # writes the force at r into f, returns the energies


@dataclass(frozen=True)
class Settings:
    """How to relax.

    tolerance : residual at which a state counts as converged; under small loads it has to be smaller (see
        `residual.wanted`).
    damping : "adaptive" (viscous, from the Rayleigh quotient), "kinetic", "kinetic-published" [72-73] or "viscous".
    mass : "nodal", "isotropic" or "uniform" (see `mass.nodal_masses`).
    levels : number of nested meshes; None chooses.
    thicken : coarser levels of a plate get a thickness in proportion to their zone area, so that wrinkles, whose
        length goes with the square root of the thickness, keep their number of nodes. For sheets that fold sharply.
    thinning : thicknesses, over the plate's own, in which it is solved one after the other on its finest mesh before
        its own; coarser meshes have the first. Where wrinkles double their number, they do so step by step.
    max_steps, max_seconds : limits of the whole run. threads : bands of rows side by side.
    snapshots : shapes to keep of the way to the equilibrium (see `snapshots`).
    finish : "auto" or "on": a smoothed state is taken to its equilibrium in the metric of its exact tangent where that
        works (see `finish`); "auto" only where it is faster. "off": relaxation goes on to the end.
    """

    tolerance: float = 1e-6
    damping: str = "adaptive"
    mass: str = "nodal"
    levels: int | None = None
    thicken: bool = False
    thinning: tuple[float, ...] = ()
    max_steps: int = 400_000
    max_seconds: float = 1800.0
    threads: int = 1
    snapshots: int = 0
    finish: str = "auto"


@dataclass(frozen=True)
class Progress:
    """What a progress display needs: where the run is, how fast, how far from the tolerance."""

    level: int
    levels: int
    nodes: int
    step: int
    residual: float
    tolerance: float
    steps_per_second: float
    seconds: float


@dataclass
class State:
    """All that a relaxation carries from block to block.

    r, v : (components, ni, nj) float64, scaled positions and velocities. mass, inverse_mass : see `mass`; the
    inverse is 0 at fixed nodes.
    """

    r: np.ndarray
    v: np.ndarray
    mass: np.ndarray
    inverse_mass: np.ndarray
    safe: np.ndarray
    step: int = 0
    evaluations: int = 0
    viscosity: float = 0.0
    since_restart: int = 0
    rising: bool = False  # whether the last step added kinetic energy
    mass_factor: float = 1.0
    total_energy: float = np.inf
    recoveries: int = 0
    best_residual: float = np.inf
    best_step: int = 0
    stalls: int = 0
    kicks: int = 0
    growths: int = 0
    finish_at: int = 200  # step at which relaxation pauses for an attempt to finish
    residual: float = np.inf
    wanted: float = 0.0  # residual below which it is at rest
    seconds: float = 0.0
    history: list[tuple[float, ...]] = field(default_factory=list)  # step, energy, kinetic, residual, restart

    def as_arrays(self) -> dict[str, np.ndarray]:
        """The state as plain arrays, for a checkpoint."""
        return {f.name: np.asarray(getattr(self, f.name)) for f in dataclasses.fields(self)}

    @classmethod
    def from_arrays(cls, arrays: dict[str, np.ndarray]) -> State:
        """The state that `as_arrays` gave."""
        values: dict = {}
        for f in dataclasses.fields(cls):
            value = np.asarray(arrays[f.name])
            values[f.name] = value.item() if value.ndim == 0 else value.copy()
        values["history"] = [tuple(row) for row in np.asarray(arrays["history"]).tolist()]
        return cls(**values)


def begin(r: np.ndarray) -> State:
    """The state of rest at the positions r (components, ni, nj), scaled."""
    mass = np.zeros((len(r) * (len(r) + 1) // 2, *r.shape[1:]))
    return State(r=r.copy(), v=np.zeros_like(r), mass=mass, inverse_mass=mass.copy(), safe=r.copy())


def kick(state: State, displacement: np.ndarray, growth: bool = False) -> None:
    """Displace `state` by (3, ni, nj), scaled, and let it start again from rest.

    growth : the displacement takes waves to their height (see `settled`); it is counted as such, not as a kick.
    """
    # In one call: an interrupt must not come between.
    vars(state).update(
        r=state.r + displacement,
        v=np.zeros_like(state.v),
        since_restart=0,
        viscosity=0.0,
        total_energy=np.inf,
        best_residual=np.inf,
        best_step=state.step,
        stalls=0,
        kicks=state.kicks + (not growth),
        growths=state.growths + growth,
        finish_at=max(state.finish_at, state.step + State.finish_at),
    )


def relax(
    force: Force,
    free: np.ndarray,
    weight: np.ndarray,
    state: State,
    settings: Settings,
    on_block: Callable[[State], None] | None = None,
    project: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Status:
    """Relax `state` in place until its residual is below the tolerance or a limit is met.

    free : (ni, nj) bool. weight : (ni, nj) float64, see `residual`.
    on_block : called between blocks with the state as it will be continued (progress, checkpoints).
    project : keeps forces (3, ni, nj) to a symmetry (`axisymmetry`), and with them a start that has it.

    Returns the Status. On KeyboardInterrupt, from `on_block` too, INTERRUPTED is returned and the state is put back to
    where the present block began, so that a run continued from it repeats that block and makes the same bits.
    """
    f, old = np.zeros_like(state.r), np.zeros_like(state.r)
    evaluate = force if project is None else _projected(force, project)
    rule = damping.rule(settings.damping, max(state.r.shape[1:]))
    kept = _keep(state)
    try:
        while True:
            kept, started = _keep(state), time.perf_counter()
            status = _look(evaluate, weight, state, settings, f, force.relaxed)
            masses_due = (len(state.history) - 1) % MASS_EVERY == 0
            if masses_due and status in (None, Status.CONVERGED):
                _set_masses(force, free, state, settings.mass)
            if status is not None:
                return status
            restarts, state.viscosity, state.since_restart, state.rising, quotient = damping.advance(
                evaluate,
                state.r,
                state.v,
                state.mass,
                state.inverse_mass,
                f,
                old,
                rule,
                state.viscosity,
                state.since_restart,
                state.rising,
                BLOCK,
                CAP,
                settings.threads,
            )
            state.history[-1] = (*state.history[-1][:4], float(restarts))
            if quotient > FASTEST:
                status = _recover(evaluate, weight, state, f, finite=True)
                if status is not None:
                    return status
            state.step += BLOCK
            state.evaluations += BLOCK
            state.seconds += time.perf_counter() - started
            if on_block is not None:
                on_block(state)
    except KeyboardInterrupt:
        vars(state).update(kept)
        return Status.INTERRUPTED


def _projected(force: Evaluate, project: Callable[[np.ndarray], np.ndarray]) -> Evaluate:
    """The force without its part that breaks the symmetry."""

    def evaluate(r: np.ndarray, f: np.ndarray) -> np.ndarray:
        energy = force(r, f)
        f[:] = project(f)
        return energy

    return evaluate


def _keep(state: State) -> dict:
    """What `vars(state).update` needs to undo a block: positions and velocities change in place, the rest is replaced.

    The history keeps the row of an undone look; the next look, at the same step, replaces it.
    """
    return {**vars(state), "r": state.r.copy(), "v": state.v.copy()}


def _look(
    force: Evaluate, weight: np.ndarray, state: State, settings: Settings, f: np.ndarray, relaxed: bool
) -> Status | None:
    """Evaluate the force, record the state, and decide: end (a Status), go back with heavier masses, or go on."""
    energy = float(force(state.r, f).sum())
    nodes = weight.size
    v, mass = (field.reshape(len(field), nodes) for field in (state.v, state.mass))
    kinetic = 0.5 * float(damping.twice_kinetic(v, mass))
    state.residual = residual(f, weight)
    if state.history and state.history[-1][0] == state.step:
        state.history.pop()  # the same look again, after a kick or a resume
    state.history.append((float(state.step), energy, kinetic, state.residual, 0.0))
    finite = np.isfinite(energy) and np.isfinite(state.residual) and np.isfinite(kinetic)
    if not finite or energy > GROWTH * state.total_energy + 1e-15:
        return _recover(force, weight, state, f, finite)
    state.total_energy = energy + kinetic
    state.safe[:] = state.r
    state.wanted = wanted(settings.tolerance, energy, weight, relaxed)
    if state.residual < state.wanted:
        return Status.CONVERGED
    if state.residual < 0.9 * state.best_residual:
        state.best_residual, state.best_step = state.residual, state.step
    elif state.step - state.best_step > STALL_STEPS:
        if state.stalls == 2:
            return Status.STALLED
        state.stalls, state.best_step, state.mass_factor = (
            state.stalls + 1,
            state.step,
            state.mass_factor * HEAVIER,
        )
    if state.step >= settings.max_steps:
        return Status.STEP_LIMIT
    return Status.TIME_LIMIT if state.seconds > settings.max_seconds else None


def _recover(force: Evaluate, weight: np.ndarray, state: State, f: np.ndarray, finite: bool) -> Status | None:
    """Go back to the last sound state, at rest and with heavier masses; give up after `RECOVERIES` times."""
    state.r[:], state.v[:] = state.safe, 0.0
    state.recoveries += 1
    if state.recoveries > RECOVERIES:
        return Status.DIVERGED if finite else Status.NOT_FINITE
    state.mass_factor *= HEAVIER
    state.mass, state.inverse_mass = HEAVIER * state.mass, state.inverse_mass / HEAVIER
    state.since_restart, state.viscosity = 0, 0.0
    state.total_energy = float(force(state.r, f).sum())
    if not (np.isfinite(state.total_energy) and np.isfinite(residual(f, weight))):
        return Status.NOT_FINITE  # the state was not sound to begin with: no mass can help
    return None


def _set_masses(force: Force, free: np.ndarray, state: State, kind: str) -> None:
    """Update the inverse masses to the stiffness of the present state; fixed nodes get 0 and never move."""
    ahead = state.r + BLOCK * MASS_EVERY * state.v
    mass = state.mass_factor * nodal_masses(force, state.r, ahead, force.relaxed, kind)
    inverse = np.zeros_like(mass)
    invert(mass.reshape(len(mass), -1), free.reshape(-1), inverse.reshape(len(mass), -1))
    force.hold(inverse)
    state.mass, state.inverse_mass = mass, inverse  # new arrays: `_keep` has the old ones
