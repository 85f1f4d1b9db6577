"""The wrinkled equilibrium of a sheet: the flat state, its lowest mode of buckling, and Newton's method from there.

The flat sheet is solved in its plane and its out-of-plane Hessian examined. If that has negative eigenvalues, the
lowest mode starts the wrinkles, at the height of least energy, on a coarse mesh; the wrinkled state is then carried to
finer meshes. A sheet whose supports leave the plane is followed along its load instead.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from femref.assembly import SheetEnergy
from femref.bicubic import Mesh, transfer
from femref.held import Mirrors, Support, given_values, held_by_mirrors, held_by_supports
from femref.inertia import factorise
from femref.loads import follow
from femref.newton import Equilibrium, NewtonSettings, Outcome, free_hessian, free_part, minimise

# Three meshes tell the order of convergence; on fewer lines than these the corners of a sheet buckle by themselves.
MOST_LEVELS, _FEWEST_LINES = 3, 14
COARSENING = 2.0 / 3.0
# Heights of the starting mode, parts of the thickness: this factor apart, until the energy rises.
_HEIGHT_STEP, _MOST_HEIGHTS = 1.5, 30
# In-plane equilibrium while heights are compared: far finer than their differences in energy.
_ROUGH_TOLERANCE = 1e-5


@dataclass(frozen=True)
class SheetProblem:
    """A sheet, its mesh, supports and symmetries.

    mirrors : planes of symmetry through the mesh's first lines. supports : edge name -> Support, edges left out free.
    mode : which mode of the flat state starts the wrinkles, 1 the lowest.
    """

    mesh: Mesh
    young_MPa: float
    poisson: float
    thickness_mm: float
    supports: Mapping[str, Support]
    mirrors: Mirrors = field(default_factory=Mirrors)
    mode: int = 1

    @property
    def planar(self) -> bool:
        """Whether a flat state exists."""
        return not any(support.leaves_plane for support in self.supports.values())

    def energy(self) -> SheetEnergy:
        """The energy on the problem's mesh."""
        return SheetEnergy(self.mesh, self.young_MPa, self.poisson, self.thickness_mm)

    def held(self, mirrors: Mirrors | None = None) -> np.ndarray:
        """(ni, nj, 4, 3) bool: unknowns given by supports or by symmetry."""
        return held_by_supports(self.mesh, self.supports) | held_by_mirrors(
            self.mesh, self.mirrors if mirrors is None else mirrors
        )


@dataclass(frozen=True)
class Flat:
    """The flat equilibrium: its nodal values, energy (N mm, of the problem's part of the sheet) and instabilities.

    negative : eigenvalues below zero of the out-of-plane Hessian. lowest : the lowest of them all, N/mm^3.
    """

    q: np.ndarray
    energy_N_mm: float
    negative: int
    lowest: float
    mode: np.ndarray


@dataclass(frozen=True)
class Postbuckled:
    """A wrinkled (or flat, where that is stable) equilibrium.

    problem : on this mesh. state : its equilibrium. flat : of the same mesh; None for a load out of the plane.
    reached : part of the load. seconds : wall time of this mesh alone.
    """

    problem: SheetProblem
    state: Equilibrium
    flat: Flat | None
    reached: float
    seconds: float = 0.0

    @property
    def converged(self) -> bool:
        """Whether the full load was reached and the residual is below the tolerance."""
        return self.reached >= 1.0 and self.state.outcome is Outcome.CONVERGED


def solve(problem: SheetProblem, settings: NewtonSettings, levels: int | None = None) -> list[Postbuckled]:
    """Solve on a sequence of meshes that ends with the problem's own; coarse to fine, the last may not have converged.

    levels : number of meshes, each with two thirds of the lines of the next; None takes up to three.

    Raises NotCertified if a factorisation cannot count eigenvalues.
    """
    done: list[Postbuckled] = []
    for mesh in coarser_meshes(problem.mesh, levels):
        started = time.perf_counter()
        current, before = replace(problem, mesh=mesh), done[-1] if done else None
        found = _planar(current, settings, before) if problem.planar else _lifted(current, settings, before)
        done.append(replace(found, seconds=time.perf_counter() - started))
        if not found.converged:
            break
    return done


def coarser_meshes(mesh: Mesh, levels: int | None) -> list[Mesh]:
    """Meshes of the same grading, coarse to fine, each with two thirds of the elements per direction of the next."""
    meshes = [mesh]
    for _ in range(MOST_LEVELS - 1 if levels is None else levels - 1):
        counts = [round((len(axis) - 1) * COARSENING) for axis in meshes[0].breaks]
        if min(counts) < (_FEWEST_LINES if levels is None else 1):
            break
        x, y = (_resampled(axis, count) for axis, count in zip(meshes[0].breaks, counts, strict=True))
        meshes.insert(0, Mesh(x[:-1] if mesh.polar else x, y, mesh.polar))
    return meshes


def flat_state(problem: SheetProblem, settings: NewtonSettings) -> tuple[Equilibrium, float, Flat | None]:
    """The flat equilibrium, the part of the load reached, and its lowest mode (None if it was not reached)."""
    energy, held = problem.energy(), problem.held()
    in_plane = ~held
    in_plane[..., 2] = False
    found, reached = follow(energy, problem.supports, held, in_plane, settings)
    if reached < 1.0:
        return found, reached, None
    negative, values, modes = lowest_modes(energy, found.q, _out_of_plane(held), problem.mode)
    chosen = modes[problem.mode - 1]
    flat = Flat(found.q, energy.value(found.q), negative, float(values[0]), chosen)
    return found, reached, flat


def lowest_modes(
    energy: SheetEnergy, q: np.ndarray, free: np.ndarray, count: int, guess: float = 0.0
) -> tuple[int, np.ndarray, np.ndarray]:
    """Negative eigenvalues of the Hessian of the free unknowns, its `count` lowest (N/mm^3) and their modes.

    Eigenvalues are relative to the mass matrix: forces per area and displacement. modes : (count, ni, nj, 4, 3).
    guess : size of the lowest, which saves factorisations. Raises NotCertified if the factorisation cannot count.
    """
    hessian, mass = free_hessian(energy, q, free), free_part(energy.mass, free)
    negative = factorise(hessian).negative
    # A shift below the whole spectrum makes the lowest eigenvalues the nearest: found by counting, in steps of ten.
    shift = guess or 1e-9 * float(np.abs(hessian.diagonal() / mass.diagonal()).max())
    while (factors := factorise((hessian + shift * mass).tocsc())).negative:
        shift *= 10.0
    inverse = LinearOperator(hessian.shape, matvec=factors.solve, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(hessian.shape[0])
    values, vectors = eigsh(hessian, k=count, M=mass, sigma=-shift, v0=start, OPinv=inverse)
    order = np.argsort(values)
    modes = np.zeros((count, *q.shape))
    for k, index in enumerate(order):
        modes[k][free] = vectors[:, index]
    return negative, values[order], modes


def _planar(problem: SheetProblem, settings: NewtonSettings, coarse: Postbuckled | None) -> Postbuckled:
    """On one mesh: from the coarser mesh's wrinkles, or from the lowest mode of the flat state."""
    found, reached, flat = flat_state(problem, settings)
    if flat is None or flat.negative == 0:
        return Postbuckled(problem, found, flat, reached)
    energy, held = problem.energy(), problem.held()
    wrinkled = coarse is not None and bool(coarse.state.q[..., 2].any())
    start = (
        _carried(coarse, problem, flat.q, held) if wrinkled and coarse else _mode_start(energy, flat, held)
    )
    return Postbuckled(problem, minimise(energy, start, ~held, settings), flat, 1.0)


def _lifted(problem: SheetProblem, settings: NewtonSettings, coarse: Postbuckled | None) -> Postbuckled:
    energy, held = problem.energy(), problem.held()
    if coarse is None:
        state, reached = follow(energy, problem.supports, held, ~held, settings, first_step=0.25)
        return Postbuckled(problem, state, None, reached)
    start = _carried(coarse, problem, given_values(problem.mesh, problem.supports, 1.0), held)
    return Postbuckled(problem, minimise(energy, start, ~held, settings), None, 1.0)


def _carried(coarse: Postbuckled, problem: SheetProblem, given: np.ndarray, held: np.ndarray) -> np.ndarray:
    carried = transfer(coarse.problem.mesh, coarse.state.q, problem.mesh)
    return np.where(held, given, carried)


def _mode_start(energy: SheetEnergy, flat: Flat, held: np.ndarray) -> np.ndarray:
    """The flat state with its mode at the height of least energy, the plane relaxed for each height."""
    in_plane = ~held
    in_plane[..., 2] = False
    mode = flat.mode / np.abs(flat.mode[:, :, 0, 2]).max()
    height, q, least = energy.thickness_mm, flat.q, flat.energy_N_mm
    best = flat.q + height * mode
    for _ in range(_MOST_HEIGHTS):
        q = q.copy()
        q[..., 2] = height * mode[..., 2]
        q = minimise(energy, q, in_plane, NewtonSettings(tolerance=_ROUGH_TOLERANCE)).q
        value = energy.value(q)
        if value >= least:
            break
        best, least, height = q, value, height * _HEIGHT_STEP
    return best


def _out_of_plane(held: np.ndarray) -> np.ndarray:
    free = ~held
    free[..., :2] = False
    return free


def _resampled(axis: np.ndarray, elements: int) -> np.ndarray:
    return np.interp(np.linspace(0.0, len(axis) - 1.0, elements + 1), np.arange(len(axis)), axis)
