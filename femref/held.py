"""Which nodal values of a sheet are given: supported edges and planes of symmetry.

Pinned: the edge's positions are given, hence also their derivative along the edge. Clamped: the normal too, here the z
axis (edges turn about it), so that the slope of z across the edge vanishes all along it. In the plane of symmetry x = 0
a component that is even in x has no odd derivative, one that is odd no value.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from femref.bicubic import Mesh, flat

# kinds of nodal values: f, f,y, f,x, f,xy
_ALONG_X, _ALONG_Y = np.array([0, 2]), np.array([0, 1])
_EVEN_ORDER_X, _ODD_ORDER_X = np.array([0, 1]), np.array([2, 3])
_EVEN_ORDER_Y, _ODD_ORDER_Y = np.array([0, 2]), np.array([1, 3])
SUPPORTS = ("free", "pinned", "clamped")


@dataclass(frozen=True)
class Support:
    """Support of an edge, and where it goes: grown radially, turned about the z axis, then moved.

    support : "free", "pinned" or "clamped". move_mm : (x, y, z). turn_deg : angle. grow_mm : of a circular edge.
    """

    support: str = "free"
    move_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn_deg: float = 0.0
    grow_mm: float = 0.0

    def __post_init__(self) -> None:
        if self.support not in SUPPORTS:
            raise ValueError(f"a support is free, pinned or clamped, not {self.support!r}")

    @property
    def leaves_plane(self) -> bool:
        """Whether it takes the edge out of the reference plane."""
        return self.support != "free" and self.move_mm[2] != 0.0


@dataclass(frozen=True)
class Mirrors:
    """Planes of symmetry x = 0 and y = 0 that bound the mesh from below.

    x, y : parity of z across the plane, +1 even or -1 odd; 0 for no symmetry. Positions x are odd and y even in x, and
    the other way round in y. turned_x, turned_y : all three parities reversed, as in what breaks the symmetry.
    """

    x: int = 0
    y: int = 0
    turned_x: bool = False
    turned_y: bool = False

    def parities(self, axis: int) -> tuple[int, int, int] | None:
        """Parities of the three components across the plane x = 0 (axis 0) or y = 0 (axis 1)."""
        parity = (self.x, self.y)[axis]
        if parity == 0:
            return None
        sign = -1 if (self.turned_x, self.turned_y)[axis] else 1
        return (-sign, sign, sign * parity) if axis == 0 else (sign, -sign, sign * parity)


def edge_nodes(mesh: Mesh, name: str) -> tuple[slice | int, slice | int]:
    """Index of an edge's nodes: left, right, bottom, top of a rectangle, inner, outer of a polar mesh."""
    every = slice(None)
    places: dict[str, tuple[slice | int, slice | int]] = (
        {"inner": (every, 0), "outer": (every, -1)}
        if mesh.polar
        else {"left": (0, every), "right": (-1, every), "bottom": (every, 0), "top": (every, -1)}
    )
    if name not in places:
        raise ValueError(f"this mesh has the edges {', '.join(places)}, not {name!r}")
    return places[name]


def held_by_supports(mesh: Mesh, supports: Mapping[str, Support]) -> np.ndarray:
    """(ni, nj, 4, 3) bool: nodal values that the supports give."""
    held = np.zeros((*mesh.shape, 4, 3), dtype=bool)
    for name, support in supports.items():
        if support.support == "free":
            continue
        along = _ALONG_Y if name in ("left", "right") else _ALONG_X
        across = np.setdiff1d(np.arange(4), along)
        nodes = held[edge_nodes(mesh, name)]
        nodes[:, along] = True
        if support.support == "clamped":
            nodes[:, across, 2] = True
    return held


def held_by_mirrors(mesh: Mesh, mirrors: Mirrors) -> np.ndarray:
    """(ni, nj, 4, 3) bool: nodal values that vanish in the planes of symmetry."""
    held = np.zeros((*mesh.shape, 4, 3), dtype=bool)
    orders = ((_EVEN_ORDER_X, _ODD_ORDER_X), (_EVEN_ORDER_Y, _ODD_ORDER_Y))
    for axis, (even, odd) in enumerate(orders):
        for component, parity in enumerate(mirrors.parities(axis) or ()):
            nodes = held[0] if axis == 0 else held[:, 0]
            nodes[:, odd if parity > 0 else even, component] = True
    return held


def given_values(mesh: Mesh, supports: Mapping[str, Support], part: float) -> np.ndarray:
    """Nodal values (ni, nj, 4, 3) with those of the supported edges at a part of their way, 0 to 1; others flat."""
    reference = flat(mesh)
    values = reference.copy()
    for name, support in supports.items():
        if support.support == "free":
            continue
        nodes = edge_nodes(mesh, name)
        values[nodes] = _moved(reference[nodes], support, part)
    return values


def _moved(edge: np.ndarray, support: Support, part: float) -> np.ndarray:
    """Nodal values (m, 4, 3) of an edge after its movement; only a circle about the origin can grow."""
    values = edge.copy()
    if support.grow_mm:
        radius = np.linalg.norm(edge[:, 0, :2], axis=-1)
        if np.ptp(radius) > 1e-9 * radius.max():
            raise ValueError("only a circular edge about the origin can grow")
        values[:, [0, 2]] *= 1.0 + part * support.grow_mm / radius.mean()
    angle = np.radians(part * support.turn_deg)
    x, y = values[..., 0].copy(), values[..., 1].copy()
    values[..., 0] = x * np.cos(angle) - y * np.sin(angle)
    values[..., 1] = x * np.sin(angle) + y * np.cos(angle)
    values[:, 0] += part * np.array(support.move_mm)
    return values


def unfold(mesh: Mesh, values: np.ndarray, mirrors: Mirrors) -> tuple[Mesh, np.ndarray]:
    """The whole sheet of a field that is known on one side of its planes of symmetry."""
    axes = [mesh.x, mesh.y]
    for axis, odd in ((0, _ODD_ORDER_X), (1, _ODD_ORDER_Y)):
        parities = mirrors.parities(axis)
        if parities is None:
            continue
        image = np.flip(values, axis=axis) * np.array(parities)
        image[:, :, odd] *= -1.0
        last = image[:-1] if axis == 0 else image[:, :-1]
        values = np.concatenate([last, values], axis=axis)
        axes[axis] = np.concatenate([-axes[axis][:0:-1], axes[axis]])
    return Mesh(axes[0], axes[1], mesh.polar), values
