"""Supported edges of a plate: which combinations of its unknowns stay free.

Along a supported edge the deflection vanishes with all its derivatives along the edge, on a clamped one the normal
slope too. On a circle these are the circle's: a polygon with w = 0 along its straight sides would also hold the slope
at every vertex and so clamp the plate as it is refined (the polygon paradox of simply supported plates).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from scipy.sparse import csr_array
from skfem import Basis

from femref.plate_elements import Derivative, PlateElement
from femref.sheet_mesh import SheetMesh

_NULL = 1e-9  # below this part of the largest a singular value is zero: rows are of order one or repeat each other


def free_combinations(sheet: SheetMesh, basis: Basis, supports: Mapping[str, str]) -> csr_array:
    """Z (unknowns, free), orthonormal columns: w = Z q meets every support.

    supports : edge name -> "free", "pinned" or "clamped"; edges left out are free.

    Raises ValueError for another word, or an edge of rectangles that is not parallel to an axis.
    """
    element = basis.elem
    if wrong := sorted(set(supports.values()) - {"free", "pinned", "clamped"}):
        raise ValueError(f"a support is free, pinned or clamped, not {wrong[0]!r}")
    rows: dict[int, list[np.ndarray]] = {}
    slopes: list[np.ndarray] = []
    for edge, support in supports.items():
        if support == "free":
            continue
        clamped = support == "clamped"
        vertices, tangents, curvatures = sheet.tangents(edge)
        for vertex, tangent, curvature in zip(vertices.tolist(), tangents.T, curvatures, strict=True):
            rows.setdefault(vertex, []).extend(_conditions(element, tangent, curvature, clamped))
        if clamped and element.normal_slope:
            slopes.append(basis.dofs.facet_dofs[0, sheet.edges[edge]])
    held = np.concatenate(slopes) if slopes else np.empty(0, dtype=np.int64)
    nodal = basis.dofs.nodal_dofs
    touched = np.concatenate([nodal[:, vertex] for vertex in rows] + [held]).astype(np.int64)
    untouched = np.setdiff1d(np.arange(basis.N), touched)
    place = [(untouched, np.arange(untouched.size), np.ones(untouched.size))]
    columns = untouched.size
    for vertex, conditions in rows.items():
        null = _null_space(np.array(conditions))
        count = null.shape[1]
        i, j = np.meshgrid(nodal[:, vertex], columns + np.arange(count), indexing="ij")
        place.append((i.ravel(), j.ravel(), null.ravel()))
        columns += count
    i, j, value = (np.concatenate(parts) for parts in zip(*place, strict=True))
    return csr_array((value, (i, j)), shape=(basis.N, columns))


def _conditions(
    element: PlateElement, tangent: np.ndarray, curvature: float, clamped: bool
) -> Iterator[np.ndarray]:
    """Rows on a vertex's unknowns: derivatives of w, and of its normal slope, with respect to the edge's length."""
    tx, ty = tangent
    nx, ny = ty, -tx
    along: list[dict[Derivative, float]] = [
        {(0, 0): 1.0},
        {(1, 0): tx, (0, 1): ty},
        {
            (2, 0): tx * tx,
            (1, 1): 2.0 * tx * ty,
            (0, 2): ty * ty,
            (1, 0): -curvature * nx,
            (0, 1): -curvature * ny,
        },
    ]
    if clamped:
        along += [{(1, 0): nx, (0, 1): ny}, {(2, 0): nx * tx, (1, 1): nx * ty + ny * tx, (0, 2): ny * ty}]
    carried = element.vertex_derivatives
    for condition in along:
        terms = {order: value for order, value in condition.items() if abs(value) > 1e-12}
        if set(terms) <= set(carried):
            yield np.array([terms.get(order, 0.0) for order in carried])
        elif (1, 1) in carried and (2, 0) not in carried and abs(tx * ty) > 1e-12:
            raise ValueError("rectangles need edges that are parallel to the axes")


def _null_space(rows: np.ndarray) -> np.ndarray:
    """Orthonormal columns that every row annihilates."""
    _, values, right = np.linalg.svd(rows)
    rank = int((values > _NULL * values[0]).sum())
    return right[rank:].T
