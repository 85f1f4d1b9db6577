"""Buckling factors of a plate: K w = -factor G w, the smallest positive ones, all of them.

The pencil has tension far stronger than compression, so that the factors of either sign fill the line from zero on. A
shift s with K + s G indefinite sorts them: of the transformed values factor / (factor - s) exactly those of factors
between 0 and s are negative, and the inertia of K + s G says how many there are. Lanczos finds them, the count
certifies that none is missing (Parlett, The Symmetric Eigenvalue Problem, 1998, section 15).
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from femref.inertia import Factorisation, NotCertified, factorise
from femref.plate_matrices import PlateSpace

_STEP = 4.0  # by which the shift grows until it has passed enough factors
_MOST_SHIFTS = 60
# Lanczos may leave out copies of a multiple factor; a wider basis finds them.
_BASES = (2.5, 5.0)
# Mean compression beside the largest stress that is rounding, not a load.
COMPRESSED = 1e-9


class NoBuckling(ValueError):
    """A load under which the plate has no positive factor (or not enough of them); the message is one sentence."""


@dataclass(frozen=True)
class Factors:
    """The smallest positive factors.

    factor : (k,) ascending. shape : (unknowns, k) free unknowns of the modes, w^T K w = 1. shift : s.
    residual : bound on the relative distance of each from a factor of the matrices, see `distance_bounds`; the largest.
    certified : whether the inertia at s says that none is missing.
    seconds : of CPU, "factorise" (all shifts), "lanczos", "bounds". entries : of the last factors.
    factorisations : their number.
    """

    factor: np.ndarray
    shape: np.ndarray
    shift: float
    residual: float
    certified: bool
    seconds: dict[str, float]
    entries: int
    factorisations: int


def smallest_factors(bending: csc_array, geometric: csc_array, count: int, guess: float) -> Factors:
    """At least `count` smallest positive factors, and every other one up to the shift that passed them.

    bending : K (n, n), positive definite. geometric : G (n, n). guess : a shift to try first.

    Raises NoBuckling, and NotCertified if the factors found are not as many as the inertia says.
    """
    scale = diags_array(1.0 / np.sqrt(bending.diagonal()))
    stiff, loaded = csc_array(scale @ bending @ scale), csc_array(scale @ geometric @ scale)
    factorisation, shift, tries, seconds = _shift_past(stiff, loaded, count, guess)
    started = time.process_time()
    for basis in _BASES:
        value, vector = _between_zero_and(shift, stiff, loaded, factorisation, basis)
        if len(value) == factorisation.negative:
            break
    else:
        raise NotCertified(
            f"Lanczos found {len(value)} factors below {shift:.6g}, the inertia says {factorisation.negative}."
        )
    lanczos, entries = time.process_time() - started, factorisation.entries
    del factorisation  # before the next one takes its memory
    started = time.process_time()
    residual = distance_bounds(stiff, loaded, value, vector)
    spent = {"factorise": seconds, "lanczos": lanczos, "bounds": time.process_time() - started}
    return Factors(value, scale @ vector, shift, float(residual.max()), True, spent, entries, tries)


def distance_bounds(
    bending: csc_array, geometric: csc_array, factor: np.ndarray, shape: np.ndarray
) -> np.ndarray:
    """(k,) |f / f_i - 1| at most, f_i the true factor nearest to f = factor[k].

    |r| / |w| with r = K w + f G w in the norm of K^-1 and w in that of K: how far the pair (1 / f, K^1/2 w) is from an
    eigenpair of the symmetric -K^-1/2 G K^-1/2 (Parlett 1998, theorem 4.5.1). In Euclidean norms the ratio of r to K w
    grows with the fourth power of the lines of a mesh by rounding alone.
    """
    stiffness = factorise(bending)
    pushed = bending @ shape
    rest = pushed + geometric @ shape * factor
    squares = [
        abs(r @ stiffness.solve(r)) / (w @ p) for r, w, p in zip(rest.T, shape.T, pushed.T, strict=True)
    ]
    return np.sqrt(squares)


def factors_below(bending: csc_array, geometric: csc_array, load: float) -> int:
    """Number of positive factors below `load`: negative eigenvalues of K + load G. Raises NotCertified."""
    return factorise(csc_array(bending + load * geometric)).negative


def _shift_past(
    stiff: csc_array, loaded: csc_array, count: int, guess: float
) -> tuple[Factorisation, float, int, float]:
    """A shift that has `count` to about 2 count factors below it: factorisation, shift, tries, seconds."""
    low, high, shift, seconds = 0.0, np.inf, guess, 0.0
    most: float = 2 * count + 6
    for tries in range(1, _MOST_SHIFTS + 1):
        factorisation = factorise(csc_array(stiff + shift * loaded))
        seconds += factorisation.seconds
        if count <= factorisation.negative <= most:
            return factorisation, shift, tries, seconds
        if factorisation.negative < count:
            low = shift
        else:
            high = shift
        if np.isinf(high):
            shift *= _STEP
        elif high - low < 1e-9 * high:
            most = np.inf  # a cluster so tight that no shift parts it
        else:
            shift = np.sqrt(low * high) if low > 0.0 else high / _STEP
    raise NoBuckling(f"No load up to {shift:.3g} times the scene's has {count} buckling modes.")


def _between_zero_and(
    shift: float, stiff: csc_array, loaded: csc_array, factorisation: Factorisation, basis: float
) -> tuple[np.ndarray, np.ndarray]:
    """Factors in (0, shift), ascending, and their modes by Lanczos in the inner product of `stiff`."""
    wanted, unknowns = factorisation.negative, stiff.shape[0]
    inverse = LinearOperator(stiff.shape, matvec=factorisation.solve, dtype=np.float64)
    width = int(min(unknowns - 1, max(20, basis * wanted + 10)))
    start = np.random.default_rng(0).standard_normal(unknowns)
    try:
        value, vector = eigsh(
            stiff,
            wanted,
            M=-loaded,
            sigma=shift,
            which="SA",
            mode="buckling",
            OPinv=inverse,
            ncv=width,
            v0=start,
        )
    except ArpackNoConvergence as unfinished:
        value, vector = unfinished.eigenvalues, unfinished.eigenvectors
    inside = (value > 0.0) & (value < shift)
    order = np.argsort(value[inside])
    return value[inside][order], vector[:, inside][:, order]


def guess_of(space: PlateSpace, stress: np.ndarray) -> float:
    """A load that is of the order of the first factors: a strip as narrow as the sheet under the mean compression."""
    least = _least_principal(stress)
    weight = space.basis.dx
    compression = -float((np.minimum(least, 0.0) * weight).sum() / weight.sum())
    if not compression > COMPRESSED * float(np.abs(stress).max()):
        raise NoBuckling("The sheet is nowhere compressed, so it does not buckle.")
    return space.material.bending(space.sheet.length_mm) * np.pi**2 / compression


def shift_after(factor: np.ndarray, count: int) -> float:
    """A load between two factors of a coarser mesh, `count` or a few more below it, in their widest gap there."""
    known = np.append(factor, 1.05 * factor[-1])[count - 1 :]
    gap = np.argmax(known[1:] / known[:-1]) if len(known) > 1 else 0
    return float(np.sqrt(known[gap] * known[min(gap + 1, len(known) - 1)]))


def _least_principal(stress: np.ndarray) -> np.ndarray:
    """The smaller principal value of a field (2, 2, ...)."""
    mean, half = 0.5 * (stress[0, 0] + stress[1, 1]), 0.5 * (stress[0, 0] - stress[1, 1])
    return mean - np.hypot(half, stress[0, 1])
