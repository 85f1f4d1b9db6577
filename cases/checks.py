"""What must hold between the keys of a scene; checks skip tables that are already wrong."""

from __future__ import annotations

import math

from cases.lines import off_the_sheet
from cases.problems import did_you_mean, one_of, shown
from cases.schema import (
    SHAPES,
    AnnulusSheet,
    AnySheet,
    Edge,
    HoleSheet,
    Line,
    Mesh,
    RectangleSheet,
    Sheet,
    Start,
)
from cases.validate import Reading

# Beyond this ratio a mesh of about square cells with a few nodes across has too many nodes along.
LARGEST_ASPECT = 1000.0
# Displacements beyond this many sheet sizes overflow the scaled energies long before they mean anything.
LARGEST_MOVE = 100.0
CIRCLES = {"inner": "inner_radius_mm", "outer": "outer_radius_mm", "hole": "hole_radius_mm"}
EVERY_EDGE = (*HoleSheet.edge_names, *AnnulusSheet.edge_names)


def check(reading: Reading) -> None:
    """Run every check whose tables are present."""
    sheet, edges = reading.tables["sheet"], reading.tables["edges"] or {}
    _check_supports(edges, reading)
    if sheet is not None:
        sound = _check_sheet(sheet, reading)
        _check_sizes(edges, sheet, reading)
        for kind in ("sections", "paths"):
            if sound:
                _check_lines(kind, reading.tables[kind] or {}, sheet, reading)
    _check_mesh(reading.tables["mesh"], reading)
    _check_symmetry(reading)
    _check_start(reading.tables["start"], reading)


def _check_mesh(mesh: Mesh | None, reading: Reading) -> None:
    """The cells of the other shapes are about square by their maps."""
    if mesh is not None and mesh.cell_ratio is not None and reading.shape not in (None, RectangleSheet):
        reading.wrong(("mesh", "cell_ratio"), shown(mesh.cell_ratio), 'is for the shape "rectangle" only')


def _check_sheet(sheet: AnySheet, reading: Reading) -> bool:
    """Radii, aspect and thickness; False if the in-plane shape is impossible."""
    before = len(reading.problems)
    if isinstance(sheet, AnnulusSheet) and sheet.inner_radius_mm >= sheet.outer_radius_mm:
        message = f"must be below sheet.outer_radius_mm, which is {sheet.outer_radius_mm:g}"
        reading.wrong(("sheet", "inner_radius_mm"), shown(sheet.inner_radius_mm), message)
    elif isinstance(sheet, HoleSheet) and sheet.smallest_width_mm <= 0.0:
        half = min(sheet.width_mm, sheet.height_mm) / 2.0
        message = (
            f"the hole is wider than the sheet; the radius must be below {half:g}, half the shorter side"
        )
        reading.wrong(("sheet", "hole_radius_mm"), shown(sheet.hole_radius_mm), message)
    else:
        _check_aspect(sheet, reading)
        if sheet.thickness_mm >= sheet.smallest_width_mm:
            message = f"must be below the narrowest width of the sheet, {sheet.smallest_width_mm:g} mm"
            reading.wrong(("sheet", "thickness_mm"), shown(sheet.thickness_mm), message)
    return len(reading.problems) == before


def _check_aspect(sheet: AnySheet, reading: Reading) -> None:
    aspect = sheet.size_mm / sheet.smallest_width_mm
    if aspect > LARGEST_ASPECT:
        message = f"is {aspect:.3g} times longer than its narrowest width; at most {LARGEST_ASPECT:g} times"
        reading.wrong(("sheet",), None, message)


def _check_supports(edges: dict[str, Edge | None], reading: Reading) -> None:
    """Names, supports and movements of the edges, as far as they do not depend on sizes."""
    names = reading.shape.edge_names if reading.shape else EVERY_EDGE
    for name, edge in edges.items():
        if name not in names:
            what = _article(reading.shape) if reading.shape else "a sheet"
            guess = did_you_mean(name, names)
            message = f"{what} has no such edge; its edges are {one_of(names)}{guess}"
            reading.wrong(("edges", name), None, message)
        elif edge is not None:
            _check_movement(name, edge, reading)
    known = [edge for edge in edges.values() if edge is not None]
    if len(known) == len(edges) and all(edge.support == "free" for edge in known):
        message = f'no edge is supported; give "pinned" or "clamped" to at least one of {one_of(names)}'
        reading.wrong(("edges",), None, message)


def _check_movement(name: str, edge: Edge, reading: Reading) -> None:
    moves = {"move_mm": any(edge.move_mm), "rotate_deg": edge.rotate_deg, "grow_mm": edge.grow_mm}
    if edge.support == "free":
        for key in (key for key, size in moves.items() if size):
            message = f'a free edge cannot be moved; set edges.{name}.support to "pinned" or "clamped"'
            reading.wrong(("edges", name, key), shown(getattr(edge, key)), message)
    elif edge.grow_mm and name not in CIRCLES:
        message = "only a circular edge can grow; move a straight edge by move_mm"
        reading.wrong(("edges", name, "grow_mm"), shown(edge.grow_mm), message)


def _check_sizes(edges: dict[str, Edge | None], sheet: AnySheet, reading: Reading) -> None:
    """Movements against the size of the sheet, and against each other at the corners."""
    largest = LARGEST_MOVE * sheet.size_mm
    for name, edge in edges.items():
        if edge is None or edge.support == "free" or name not in sheet.edge_names:
            continue
        if math.hypot(*edge.move_mm) > largest:
            message = f"must be no longer than {largest:g} mm, {LARGEST_MOVE:g} times the sheet"
            reading.wrong(("edges", name, "move_mm"), shown(edge.move_mm), message)
        if name not in CIRCLES:
            continue
        radius = getattr(sheet, CIRCLES[name])
        if not -radius < edge.grow_mm <= largest:
            message = f"must be above {-radius:g}, where the circle closes, and at most {largest:g}"
            reading.wrong(("edges", name, "grow_mm"), shown(edge.grow_mm), message)
    if isinstance(sheet, (RectangleSheet, HoleSheet)):
        _check_corners(sheet, edges, reading)


def _check_corners(
    sheet: RectangleSheet | HoleSheet, edges: dict[str, Edge | None], reading: Reading
) -> None:
    """Two supported edges that meet must take their common corner to one place."""
    for side, x in (("left", -sheet.width_mm / 2), ("right", sheet.width_mm / 2)):
        for level, y in (("bottom", -sheet.height_mm / 2), ("top", sheet.height_mm / 2)):
            first, second = edges.get(side), edges.get(level)
            if first is None or second is None or "free" in (first.support, second.support):
                continue
            gap = math.dist(moved(first, x, y), moved(second, x, y))
            if gap > 1e-9 * sheet.size_mm:  # rounding of the file's decimals
                message = (
                    f"the edges {side} and {level} take their common corner to places {gap:.3g} mm apart"
                )
                reading.wrong(("edges", side), None, message)


def moved(edge: Edge, x: float, y: float) -> tuple[float, float, float]:
    """Where a supported straight edge takes the reference point (x, y), mm."""
    angle = math.radians(edge.rotate_deg)
    cosine, sine = math.cos(angle), math.sin(angle)
    move = edge.move_mm
    return (cosine * x - sine * y + move[0], sine * x + cosine * y + move[1], move[2])


def _check_lines(kind: str, lines: dict[str, Line | None], sheet: AnySheet, reading: Reading) -> None:
    for name, line in lines.items():
        if line is None:
            continue
        ends = [
            key for key, value in (("from_mm", line.start_mm), ("to_mm", line.end_mm)) if value is not None
        ]
        if (len(ends), line.radius_mm is not None) not in ((2, False), (0, True)):
            message = "a line needs from_mm and to_mm, or radius_mm alone"
            given = ", ".join(ends + (["radius_mm"] if line.radius_mm is not None else [])) or "nothing"
            reading.wrong((kind, name), None, f"{message}; given: {given}")
        elif (why := off_the_sheet(line, sheet)) is not None:
            reading.wrong((kind, name), None, why)


def _check_symmetry(reading: Reading) -> None:
    symmetry = reading.tables["symmetry"]
    if symmetry is None or reading.shape in (None, AnnulusSheet):
        return
    if symmetry.reduce == "axisymmetric" or symmetry.reduce.startswith("sector"):
        words = one_of(("auto", "none", "half-x", "half-y", "quarter"))
        message = f"only an annulus can be reduced so; {_article(reading.shape)} allows {words}"
        reading.wrong(("symmetry", "reduce"), shown(symmetry.reduce), message)


def _check_start(start: Start | None, reading: Reading) -> None:
    if start is None or start.source is None:
        return
    mode = start.source.removeprefix("mode:")
    if mode != start.source and not (
        mode.isascii() and mode.isdigit() and 1 <= int(mode[:4]) <= 1000 and len(mode) < 5
    ):
        message = 'must be a result folder or "mode:N" with N from 1 to 1000; the nearest is "mode:1"'
        reading.wrong(("start", "from"), shown(start.source), message)


def _article(sheet: type[Sheet]) -> str:
    shape = next(shape for shape, model in SHAPES.items() if model is sheet)
    return f"an {shape}" if shape == "annulus" else f"a {shape}"
