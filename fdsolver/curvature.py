"""Constants of the conservative bending scheme on curvilinear meshes (energy of Eq. 24).

Curvatures are measured in index coordinates, with unit spacing in both mesh directions:

    node   t1 = c1 (r[i+1] - r[i-1]),   t2 = c2 (r[j+1] - r[j-1]),   n = unit(t1 x t2)
           b1 = n . (r[i+1] - 2 r + r[i-1]),   b2 = n . (r[j+1] - 2 r + r[j-1])
    zone   f1 = (r_b - r_a + r_c - r_d)/2,   f2 = (r_d - r_a + r_c - r_b)/2,   n_z = unit(f1 x f2)
           b12 = n_z . (r_c - r_b - r_d + r_a);   <b12> at a node is the mean over its m zones

At an open end a neighbour index is clamped to the mesh, so the tangent is one-sided (c = 1 there, 1/2
inside). On a clamped edge n = n0 is given and the mirror node is eliminated: the curvature across the edge is
2 n0 . (r_inside - r_edge). On a free or pinned edge the curvature across the edge is not measured at all.

R is the response of the measured (b1, b2, <b12>) at a node to the fields q11 x^2/2, q22 y^2/2 and q12 x y on
the flat mesh, by these very formulas. Of all curvatures q with R q = b the sheet takes the one of least
energy q . D q / 2, which has the stiffness K = A_n (R D^-1 R^T)^-1. Where a row of R is missing this is the
condensation of the unknown curvature: no moment across the edge. The bending energy of a sheet is

    sum over nodes  K11 b1^2/2 + K12 b1 b2 + K22 b2^2/2 + (K13 b1 + K23 b2) <b12> + (K33 - Ks) <b12>^2/2
  + sum over zones  C33 b12^2/2,     Ks = A_n / (R D^-1 R^T)_33,   C33 = sum over the corners of Ks / m.

The zone term keeps the twist of every zone: the mean <b12> alone is blind to the checkerboard. Where the
twists of the m zones answer one curvature differently, their mean square exceeds the square of their mean: by
second order on smooth meshes, but by a finite part where the mesh has a kink. Nodes on a kink (Grid.breaks)
therefore give nothing to the zone term, Ks = 0; their zones are held by the other corners, b1 and b2.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fdsolver.curvature_response import node_responses, twist_responses
from fdsolver.grid import Grid
from fdsolver.material import Sheet

MOMENT_FREE = ("free", "pinned", "moment-free")

# Determinant of the normalised R D^-1 R^T where two mesh lines cross at 2 degrees: it falls with the sixth
# power of the sine. Beyond that three measured curvatures no longer tell the curvature of the sheet.
SMALLEST_DETERMINANT = math.sin(math.radians(2.0)) ** 6


@dataclass(frozen=True)
class CurvatureConstants:
    """Constants of the bending energy, scaled: lengths by grid.length_mm = L, energies by Y h L^2.

    K11, K12, K22, K13, K23, K33_rest : (ni, nj) float64. Node stiffnesses; K33_rest is K33 - Ks. Zero where
        the curvature concerned is not measured (across free and pinned edges).
    C33 : (zone rows, nj - 1) float64. Zone stiffness of the twist b12.
    twist_weight : (ni, nj) float64. 1 / number of zones at the node, the weight of each in <b12>.
    c1, c2 : (ni,), (nj,) float64. Tangent factors, 1/2 inside and 1 at an open end.
    clamped1, clamped2 : (ni, nj) bool. Nodes where b1 (b2) is 2 n0 . (r_inside - r_edge); at both kinds n =
        n0.
    orthogonal : K13, K23 and K33_rest are exactly zero everywhere, so that <b12> is not needed.
    """

    K11: np.ndarray
    K12: np.ndarray
    K22: np.ndarray
    K13: np.ndarray
    K23: np.ndarray
    K33_rest: np.ndarray
    C33: np.ndarray
    twist_weight: np.ndarray
    c1: np.ndarray
    c2: np.ndarray
    clamped1: np.ndarray
    clamped2: np.ndarray
    orthogonal: bool


def curvature_constants(grid: Grid, sheet: Sheet, supports: Mapping[str, str]) -> CurvatureConstants:
    """Return the bending constants of a mesh.

    grid : the reference mesh, lengths in mm.
    sheet : material and thickness.
    supports : edge name (of grid.edges) -> "clamped", or "free", "pinned", "moment-free", which bend alike
        here. Edges that are not named are moment-free.

    Raises ValueError for an unknown edge or support, and where the measured curvatures at a node cannot tell
    the curvature of the sheet (mesh lines that nearly coincide), naming the node.
    """
    u = np.ascontiguousarray(np.moveaxis(grid.u, 2, 0)) / grid.length_mm
    closed = grid.closed
    ni, nj = u.shape[1:]
    clamped1, clamped2 = _clamped_nodes(grid, supports)
    c1 = np.full(ni, 0.5)
    c2 = np.full(nj, 0.5)
    c2[[0, -1]] = 1.0
    if not closed:
        c1[[0, -1]] = 1.0

    response = node_responses(u, closed, c1, c2, clamped1, clamped2)
    zone_response = twist_responses(u, closed)
    zones_at_node = _gather(np.ones(zone_response.shape[1:]), closed, nj)
    weight = 1.0 / zones_at_node
    response[2] = np.stack([_gather(component, closed, nj) for component in zone_response]) * weight

    measured = np.ones((3, ni, nj), dtype=bool)
    measured[1, :, [0, -1]] = False
    measured[1] |= clamped2
    if not closed:
        measured[0, [0, -1]] = False
        measured[0] |= clamped1
    stiffness, twist_stiffness = _condensed(response, measured, sheet, grid.length_mm)
    area = grid.node_area / grid.length_mm**2
    stiffness *= area
    twist_stiffness *= area

    K11, K12, K22, K13, K23, K33_rest = stiffness
    kink = _kink_rows(grid)
    K33_rest[kink] += twist_stiffness[kink]
    twist_stiffness[kink] = 0.0
    return CurvatureConstants(
        K11=K11,
        K12=K12,
        K22=K22,
        K13=K13,
        K23=K23,
        K33_rest=K33_rest,
        C33=_corner_sum(twist_stiffness * weight, closed),
        twist_weight=weight,
        c1=c1,
        c2=c2,
        clamped1=clamped1,
        clamped2=clamped2,
        orthogonal=not (K13.any() or K23.any() or K33_rest.any()),
    )


def _clamped_nodes(grid: Grid, supports: Mapping[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes whose curvature across the edge follows from a given normal, along i and along j."""
    ni, nj = grid.u.shape[:2]
    clamped1 = np.zeros((ni, nj), dtype=bool)
    clamped2 = np.zeros((ni, nj), dtype=bool)
    for name, support in supports.items():
        if name not in grid.edges:
            raise ValueError(f"there is no edge {name!r}; the edges are {', '.join(grid.edges)}")
        if support not in (*MOMENT_FREE, "clamped"):
            raise ValueError(f"support of {name!r} must be clamped or one of {MOMENT_FREE}, not {support!r}")
    # Where two edges of one mesh line meet, the normal is given only if both are clamped: free ones go last.
    for name in sorted(grid.edges, key=lambda edge: supports.get(edge) != "clamped"):
        i, j = np.asarray(grid.edges[name]).T
        along_i = np.all(j == j[0]) and j[0] in (0, nj - 1)
        (clamped2 if along_i else clamped1)[i, j] = supports.get(name) == "clamped"
    return clamped1, clamped2


def _kink_rows(grid: Grid) -> np.ndarray:
    """Rows at which the mesh has a kink, (ni,) bool."""
    breaks = np.asarray(grid.breaks, dtype=float)
    # xi and the breaks are the same fractions computed in two ways
    return np.any(np.abs(grid.xi[:, None] - breaks) < 1e-9, axis=1)


def _gather(zone: np.ndarray, closed: bool, nj: int) -> np.ndarray:
    """Sum of a zone field over the zones at each node, shape (ni, nj)."""
    rows = zone + np.roll(zone, 1, axis=0) if closed else np.pad(zone, ((0, 1), (0, 0)))
    if not closed:
        rows[1:] += zone
    nodes = np.zeros((rows.shape[0], nj))
    nodes[:, :-1] = rows
    nodes[:, 1:] += rows
    return nodes


def _corner_sum(node: np.ndarray, closed: bool) -> np.ndarray:
    """Sum of a node field over the four corners of each zone."""
    rows = node + np.roll(node, -1, axis=0) if closed else node[:-1] + node[1:]
    return rows[:, :-1] + rows[:, 1:]


def _condensed(
    response: np.ndarray, measured: np.ndarray, sheet: Sheet, length_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """K and Ks per unit area: entries 11, 12, 22, 13, 23 of (R D^-1 R^T)^-1 and K33 - Ks; Ks."""
    nu = sheet.poisson
    scale = 12.0 * (length_mm / sheet.thickness_mm) ** 2
    # D^-1 of the bending moduli of (b11, b22, b12) per Y h L^2; regular for every nu > -1
    flexible = [
        np.stack([row[0] - nu * row[1], row[1] - nu * row[0], 0.5 * (1.0 + nu) * row[2]]) for row in response
    ]
    product = {
        (k, m): scale * np.einsum("qij,qij->ij", response[k], flexible[m])
        for k, m in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
    }
    norm = [np.where(measured[k], np.sqrt(product[k, k]), np.inf) for k in range(3)]
    p, q, s = (product[k, m] / (norm[k] * norm[m]) for k, m in ((0, 1), (0, 2), (1, 2)))
    for correlation in (p, q, s):
        # On orthogonal mesh lines the twist is uncoupled; what is left is rounding.
        correlation[np.abs(correlation) < 1e-11] = 0.0
    determinant = 1.0 + 2.0 * p * q * s - p * p - q * q - s * s
    _refuse_degenerate(determinant)
    twist = 1.0 - p * p - determinant  # of K33 - Ks: exactly zero where the twist is uncoupled
    inverse = np.stack([1.0 - s * s, q * s - p, 1.0 - q * q, p * s - q, p * q - s, twist]) / determinant
    for entry, (k, m) in zip(inverse, ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)), strict=True):
        entry /= norm[k] * norm[m]
    return inverse, 1.0 / product[2, 2]


def _refuse_degenerate(determinant: np.ndarray) -> None:
    bad = np.argwhere(~(determinant > SMALLEST_DETERMINANT))
    if len(bad):
        i, j = bad[0]
        raise ValueError(
            f"the mesh at node ({i}, {j}) is degenerate: its curvatures do not determine the bending "
            f"(determinant {determinant[i, j]:.1e}, at least {SMALLEST_DETERMINANT:.1e} needed)"
        )
