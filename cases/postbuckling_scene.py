"""A scene as the finite elements of `postbuckling` see it: mesh, supports and planes of symmetry."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from cases.schema import AnnulusSheet, Edge, HoleSheet, RectangleSheet, Scene

if TYPE_CHECKING:
    from femref.bicubic import Mesh
    from femref.held import Mirrors, Support

DEFAULT_VERTICES = 5329  # 73 x 73: a quarter sheet of 36 x 36 elements
# Sheets with more wrinkles than this side by side are solved when asked for, but not offered.
MOST_HALF_WAVES = 30
_ALONG_PULL = 2.0  # elements are this many times as long along a pull as across it
# Nodes gather a little at the ends, where supports meet free edges: elements there are this part shorter.
_GRADING = 0.2


def unfit(scene: Scene) -> str | None:
    """Why the scene has no mesh of bicubic elements, as a sentence's part; None if it has one."""
    if isinstance(scene.sheet, HoleSheet):
        return "bicubic elements need a rectangle or an annulus, not a sheet with a hole"
    if isinstance(scene.sheet, AnnulusSheet) and any(e.support == "clamped" for e in scene.edges.values()):
        return "the edges of an annulus can be free or pinned here, not clamped"
    if isinstance(scene.sheet, RectangleSheet) and any(e.grow_mm for e in scene.edges.values()):
        return "only a circular edge can grow"
    wanted, found = scene.symmetry.reduce, available(scene)
    needs = {"half-x": "x", "half-y": "y", "quarter": "xy", "none": "", "auto": ""}.get(wanted)
    if needs is None:
        return f'symmetry.reduce can be "auto", "none", "half-x", "half-y" or "quarter" here, not "{wanted}"'
    if missing := [axis for axis in needs if not found[axis]]:
        return f"the supports are no mirror images across {' and '.join(f'{axis} = 0' for axis in missing)}"
    return None


def default_vertices(scene: Scene) -> int:
    """Vertices of the whole sheet for amplitudes good to 0.5 % on the built-in pulled strip."""
    return DEFAULT_VERTICES


def available(scene: Scene) -> dict[str, bool]:
    """Whether the supports, apart from a rigid motion, are mirror images across x = 0 and y = 0."""
    if isinstance(scene.sheet, AnnulusSheet):
        return {"x": False, "y": False}
    edges = {name: _centred(edge, rigid_move_mm(scene)) for name, edge in scene.edges.items()}
    found = {}
    sides = (("left", "right"), ("bottom", "top"))
    for k, axis in enumerate("xy"):
        pair, others = sides[k], sides[1 - k]
        found[axis] = _mirrored(edges[pair[0]], k) == edges[pair[1]] and all(
            _mirrored(edges[name], k) == edges[name] for name in others
        )
    return found


def mirrors_of(scene: Scene) -> Mirrors:
    """The planes of symmetry that bound the solved part: those asked for, or all that there are.

    The scene's parity is that of z across the pull; along it wrinkles are even.
    """
    from femref.held import Mirrors

    wanted = {"half-x": "x", "half-y": "y", "quarter": "xy"}.get(scene.symmetry.reduce)
    used = [axis for axis, found in available(scene).items() if (found if wanted is None else axis in wanted)]
    parity = 1 if scene.symmetry.parity == "even" else -1
    x, y = int("x" in used), int("y" in used)
    return Mirrors(x, parity * y) if _pull_axis(scene) == 0 else Mirrors(parity * x, y)


def rigid_move_mm(scene: Scene) -> np.ndarray:
    """(3,) mean translation of the supported edges; the sheet is solved without it."""
    moves = [edge.move_mm for edge in scene.edges.values() if edge.support != "free"]
    return np.mean(moves, axis=0) if moves else np.zeros(3)


def supports_of(scene: Scene, mirrors: Mirrors) -> dict[str, Support]:
    """Supports of the solved part, without the rigid motion; planes of symmetry take the place of edges."""
    from femref.held import Support

    found = {}
    for name, edge in scene.edges.items():
        if (name == "left" and mirrors.x) or (name == "bottom" and mirrors.y):
            continue
        support, move, turn, grow = _centred(edge, rigid_move_mm(scene))
        found[name] = Support(support, move, turn, grow)
    return found


def mesh_of(scene: Scene, vertices: int, mirrors: Mirrors) -> Mesh:
    """The mesh of the solved part; `vertices` are about those of the whole sheet."""
    from femref.bicubic import Mesh

    sheet = scene.sheet
    if isinstance(sheet, AnnulusSheet):
        width, middle = sheet.smallest_width_mm, 0.5 * (sheet.inner_radius_mm + sheet.outer_radius_mm)
        around, outward = _counts(2.0 * math.pi * middle / width, vertices)
        angle = 2.0 * np.pi * np.arange(around) / around
        radius = sheet.inner_radius_mm + width * 0.5 * (1.0 + _graded(outward))
        return Mesh(angle, radius, polar=True)
    assert isinstance(sheet, RectangleSheet), "unfit refuses the others"
    pull = _pull_axis(scene)
    stretched = 1.0 if pull is None else (1.0 / _ALONG_PULL, _ALONG_PULL)[pull]
    counts = _counts(sheet.width_mm / sheet.height_mm * stretched, vertices)
    axes = []
    for count, length, parity in zip(
        counts, (sheet.width_mm, sheet.height_mm), (mirrors.x, mirrors.y), strict=True
    ):
        axis = 0.5 * length * _graded(count)
        axes.append(axis[count // 2 :] if parity else axis)
    return Mesh(axes[0], axes[1])


def _counts(ratio: float, vertices: int) -> tuple[int, int]:
    """Even numbers of elements along both axes, in this ratio."""
    first = max(4, 2 * round(0.5 * (math.sqrt(vertices * ratio) - 1.0)))
    second = max(4, 2 * round(0.5 * (math.sqrt(vertices / ratio) - 1.0)))
    return first, second


def _graded(elements: int) -> np.ndarray:
    """(elements + 1,) places from -1 to 1, denser at both ends, odd about the middle."""
    s = np.arange(-elements, elements + 1, 2) / elements
    return (1.0 - _GRADING) * s + _GRADING * np.sin(0.5 * np.pi * s)


def _pull_axis(scene: Scene) -> int | None:
    """0 or 1: the axis along which opposite supported edges are pulled apart; None for another load."""
    edges = scene.edges
    for k, (low, high) in enumerate((("left", "right"), ("bottom", "top"))):
        if low in edges and "free" not in (edges[low].support, edges[high].support):
            pull = np.subtract(edges[high].move_mm, edges[low].move_mm)
            if pull[k] > 0.0 and pull[k] >= np.abs(pull).max():
                return k
    return None


Plain = tuple[str, tuple[float, float, float], float, float]


def _centred(edge: Edge, rigid: np.ndarray) -> Plain:
    """Support, movement without the rigid one, angle and growth of an edge; nothing of a free one."""
    if edge.support == "free":
        return "free", (0.0, 0.0, 0.0), 0.0, 0.0
    x, y, z = (float(a) for a in np.array(edge.move_mm) - rigid)
    return edge.support, (x + 0.0, y + 0.0, z + 0.0), edge.rotate_deg, edge.grow_mm


def _mirrored(edge: Plain, axis: int) -> Plain:
    support, move, turn, grow = edge
    image = [-part if k == axis else part for k, part in enumerate(move)]
    return support, (image[0] + 0.0, image[1] + 0.0, image[2] + 0.0), -turn + 0.0, grow
