"""Symmetries of a sheet and its loads: what a state may be assumed to keep.

A symmetry Q (a mirror image or a rotation of space) maps states of the sheet onto themselves: r(q u) = Q r(u), q its
part in the plane.

    mirror, even   u_n = 0 and no slope across the line        (z the same on both sides)
    mirror, odd    u_n = 0, z = 0 and no moment across it      (z of opposite sign)
    sector         the neighbours are the sector itself, turned about the axis
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fdsolver.edges import EdgeCondition

ROUND = 1e-9  # over L: movements and positions closer than this are the same
OPPOSITE = {"x": {"left": "right", "right": "left"}, "y": {"bottom": "top", "top": "bottom"}}


@dataclass(frozen=True)
class Symmetry:
    """What a sheet is assumed to keep. reduce : "half-x" (x >= 0 is solved), "half-y", "quarter", "sector".

    parity : z on the other side of a mirror line is "even" (the same) or "odd" (opposite). sectors : number of them;
    0 takes as many as the mesh has rows, which is an axisymmetric state.
    """

    reduce: str
    parity: str = "even"
    sectors: int = 0

    @property
    def axisymmetric(self) -> bool:
        """Whether one ray of nodes is left."""
        return self.reduce == "sector" and self.sectors == 0

    @property
    def axes(self) -> tuple[str, ...]:
        """The mirrored coordinates."""
        return {"half-x": ("x",), "half-y": ("y",), "quarter": ("x", "y")}.get(self.reduce, ())


def refuse_unsymmetric(
    symmetry: Symmetry, edges: Mapping[str, EdgeCondition], shape: str, length_mm: float
) -> None:
    """Raise ValueError for supports or movements that the symmetry does not map onto each other."""
    if symmetry.reduce == "sector":
        if shape != "annulus":
            raise ValueError("sectors and axisymmetric runs are for an annulus")
        for name, edge in edges.items():
            if edge.support != "free" and max(abs(move) for move in edge.move_mm[:2]) > ROUND * length_mm:
                raise ValueError(f"the edge {name} moves sideways, which no sector of an annulus does")
        return
    shift = rigid_shift(symmetry, edges)
    for axis in symmetry.axes:
        for name, edge in edges.items():
            other = OPPOSITE[axis].get(name, name)
            if not _mirrored(edge, edges[other], shift, axis, symmetry.parity, ROUND * length_mm):
                pair = f"the edge {name} is" if other == name else f"the edges {name} and {other} are"
                raise ValueError(f"{pair} not loaded symmetrically about {axis} = 0 ({symmetry.parity})")


def rigid_shift(symmetry: Symmetry, edges: Mapping[str, EdgeCondition]) -> np.ndarray:
    """The translation (3,), mm, of the sheet as a whole, without which its loads have the symmetry if they have it.

    A sheet that is pulled at one edge only moves by half of that pull.
    """
    shift = np.zeros(3)
    for axis in symmetry.axes:
        for name, edge in edges.items():
            if edge.support != "free":
                other = edges[OPPOSITE[axis].get(name, name)]
                mean = 0.5 * (np.array(edge.move_mm) + np.array(other.move_mm))
                odd = np.diag(mirror(axis, symmetry.parity)) < 0.0
                shift[odd] = mean[odd]
                break
    return shift


def _mirrored(
    edge: EdgeCondition, other: EdgeCondition, shift: np.ndarray, axis: str, parity: str, tiny: float
) -> bool:
    if edge.support == other.support == "free":
        return True
    image = mirror(axis, parity) @ (np.array(edge.move_mm) - shift)
    same = np.abs(image - np.array(other.move_mm) + shift).max() <= tiny
    turned = edge.rotate_deg == -other.rotate_deg and edge.grow_mm == other.grow_mm
    return edge.support == other.support and bool(same) and turned


def mirror(axis: str, parity: str) -> np.ndarray:
    """The (3, 3) map that mirrors x or y, and z where the parity is odd."""
    signs = {"x": [-1.0, 1.0], "y": [1.0, -1.0]}[axis]
    return np.diag([*signs, 1.0 if parity == "even" else -1.0])


def rotation(angle: float) -> np.ndarray:
    """The (3, 3) rotation about the z axis by an angle in radians."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
