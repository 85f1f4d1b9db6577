"""What the compiler makes of the kernels' rows, one node at a time, so that operations can be counted."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from typing import Any

import numba

from fdsolver import membrane, membrane_plane, plate_linear, plate_plane, plate_rows
from fdsolver.membrane import StVenantKirchhoff
from fdsolver.model import Model
from fdsolver.moderate import under_moderate_rotation
from fdsolver.rows import FAST

SCRATCH, COLUMNS = numba.float64[::1], numba.uint64
LAW = numba.typeof(StVenantKirchhoff(0.3))


def unrolled(row: Any, signature: tuple) -> str:
    """Optimised code of a compiled row function; vectorisation is off while it is made."""
    before = numba.config.LOOP_VECTORIZE, numba.config.SLP_VECTORIZE
    numba.config.LOOP_VECTORIZE = numba.config.SLP_VECTORIZE = 0
    try:
        fresh = numba.njit(fastmath=FAST, error_model="numpy", nogil=True)(row.py_func)
        fresh.compile(signature)
        return fresh.inspect_llvm(fresh.signatures[0])
    finally:
        numba.config.LOOP_VECTORIZE, numba.config.SLP_VECTORIZE = before


def operations(code: str) -> int:
    """Floating-point additions, multiplications, divisions and changes of sign."""
    return len(re.findall(r"= f(?:add|sub|mul|div|neg)\b", code))


@cache
def operations_per_node(model: Model) -> int:
    """Of a model's rows that compute stresses, curvatures and moments; on a rectangle, without the sums at nodes."""
    law = model.law(0.3)
    kind = numba.typeof(under_moderate_rotation(law) if model.moderate else law)
    rows = [*_membrane_rows(model, kind), *_plate_rows(model)]
    return sum(operations(unrolled(row, signature)) for row, signature in rows)


def _membrane_rows(model: Model, law: Any) -> Iterable[tuple[Any, tuple]]:
    row = membrane.zone_row if model.out_of_plane else membrane_plane.zone_row
    return [(row, (SCRATCH, law, COLUMNS))]


def _plate_rows(model: Model) -> Iterable[tuple[Any, tuple]]:
    if not model.bending:
        return []
    if not model.out_of_plane:
        return [(plate_plane.hourglass_row, (SCRATCH, COLUMNS))]
    if model.curvature == "linear":
        return [
            (plate_linear.zone_curvature_row, (SCRATCH, COLUMNS)),
            (plate_linear.node_moment_row, (SCRATCH, COLUMNS, numba.none)),
            (plate_linear.zone_moment_row, (SCRATCH, COLUMNS, numba.none)),
        ]
    return [
        (plate_rows.zone_curvature_row, (SCRATCH, COLUMNS)),
        (plate_rows.node_moment_row, (SCRATCH, numba.float64, COLUMNS)),
        (plate_rows.zone_moment_row, (SCRATCH, COLUMNS)),
    ]
