"""Scratch rows of the streaming kernels.

The kernels visit the mesh row by row (first index i) and keep what they need of the neighbouring rows in one flat
scratch array. Each quantity has a slot: a run of `PITCH` numbers of which the columns `FIRST`, `FIRST + 1`, ... hold
j = 0, 1, ...; the columns before and after are the ghosts of the row. Slot offsets are compile-time constants and
all index arithmetic is unsigned: only then does the compiler see that the rows of one array never overlap, and emits
packed instructions.
"""

from __future__ import annotations

import numba
import numpy as np

from fdsolver.checked_cache import checked

PITCH = (
    16392  # of one slot; 64 bytes off a multiple of 4096, so that slots do not fall on the same cache lines
)
FIRST = 8  # column of j = 0
MOST_COLUMNS = PITCH - 2 * FIRST
ONE = np.uint64(1)

FAST = {"contract", "reassoc", "nsz", "arcp"}  # never nnan or ninf: NaN must stay visible


def compiled(function):
    """Compile a kernel: cached on disk, IEEE special values kept, no Python exceptions for a division by zero."""
    return checked(numba.njit(cache=True, fastmath=FAST, error_model="numpy", nogil=True)(function))


def threaded(function):
    """Compile a loop over bands of rows that `numba.prange` spreads over threads."""
    return checked(numba.njit(cache=True, parallel=True, error_model="numpy", nogil=True)(function))


def slots(count: int, start: int = 0) -> tuple[np.uint64, ...]:
    """Offsets of column j = 0 of `count` consecutive slots, the first being number `start`."""
    return tuple(np.uint64((start + k) * PITCH + FIRST) for k in range(count))


@compiled
def load(scratch, slot, source, start, count):
    """Copy `count` numbers of the flat array `source` from `start` on into a slot."""
    for j in range(count):
        scratch[slot + j] = source[start + j]


@compiled
def move(scratch, target, slot, count):
    """Copy a slot with one ghost column on each side onto another."""
    target -= ONE
    slot -= ONE
    for j in range(count + ONE + ONE):
        scratch[target + j] = scratch[slot + j]


@compiled
def clear(scratch, slot, count):
    """Set a slot and its ghost columns to zero."""
    slot -= ONE
    for j in range(count + ONE + ONE):
        scratch[slot + j] = 0.0
