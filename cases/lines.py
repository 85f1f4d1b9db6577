"""Sections and paths that a shape has when its scene names none."""

from __future__ import annotations

import math

from cases.schema import AnnulusSheet, AnySheet, HoleSheet, Line, RectangleSheet


def _straight(start: tuple[float, float], end: tuple[float, float]) -> Line:
    return Line.model_validate({"from_mm": start, "to_mm": end})


def default_sections(sheet: AnySheet) -> dict[str, Line]:
    """Lines along which z is measured.

    rectangle: `midsection`, the horizontal centre line. rectangle-with-hole: `above_hole`, across the sheet
    at 1.6 hole radii (or halfway to the edge, if that is nearer), where a vertical pull compresses it.
    annulus: `ring_1` to `ring_3`, circles at a quarter, a half and three quarters of the width.
    """
    if isinstance(sheet, RectangleSheet):
        return {"midsection": _straight((-sheet.width_mm / 2, 0.0), (sheet.width_mm / 2, 0.0))}
    if isinstance(sheet, HoleSheet):
        height = min(1.6 * sheet.hole_radius_mm, (sheet.hole_radius_mm + sheet.height_mm / 2) / 2)
        return {"above_hole": _straight((-sheet.width_mm / 2, height), (sheet.width_mm / 2, height))}
    radii = [sheet.inner_radius_mm + part * sheet.smallest_width_mm for part in (0.25, 0.5, 0.75)]
    return {f"ring_{number}": Line(radius_mm=radius) for number, radius in enumerate(radii, start=1)}


def default_paths(sheet: AnySheet) -> dict[str, Line]:
    """Lines along which stretches are reported.

    rectangle: `midsection`. rectangle-with-hole: `along_x` and `along_y`, from the hole's edge outward.
    annulus: `radius`, from the inner to the outer circle.
    """
    if isinstance(sheet, RectangleSheet):
        return default_sections(sheet)
    if isinstance(sheet, HoleSheet):
        hole = sheet.hole_radius_mm
        return {
            "along_x": _straight((hole, 0.0), (sheet.width_mm / 2, 0.0)),
            "along_y": _straight((0.0, hole), (0.0, sheet.height_mm / 2)),
        }
    return {"radius": _straight((sheet.inner_radius_mm, 0.0), (sheet.outer_radius_mm, 0.0))}


def off_the_sheet(line: Line, sheet: AnySheet) -> str | None:
    """Why a line is not on the sheet, None if it is; rounding of 1e-9 of the size is allowed."""
    slack = 1e-9 * sheet.size_mm
    inner = _inner_radius(sheet)
    if line.radius_mm is not None:
        largest = _largest_circle(sheet)
        on_sheet = inner - slack <= line.radius_mm <= largest + slack
        return (
            None
            if on_sheet
            else f"the circle leaves the sheet; allowed are radii from {inner:g} to {largest:g} mm"
        )
    if line.start_mm is None or line.end_mm is None:
        return None
    if math.dist(line.start_mm, line.end_mm) <= slack:
        return "the line has no length"
    for point in (line.start_mm, line.end_mm):
        if not _inside_outline(point, sheet, slack):
            return f"the point [{point[0]:g}, {point[1]:g}] is off the sheet, {_outline(sheet)}"
    if _distance_from_origin(line.start_mm, line.end_mm) < inner - slack:
        return f"the line crosses the hole of radius {inner:g} mm about the origin"
    return None


def _inner_radius(sheet: AnySheet) -> float:
    if isinstance(sheet, AnnulusSheet):
        return sheet.inner_radius_mm
    return sheet.hole_radius_mm if isinstance(sheet, HoleSheet) else 0.0


def _largest_circle(sheet: AnySheet) -> float:
    if isinstance(sheet, AnnulusSheet):
        return sheet.outer_radius_mm
    return min(sheet.width_mm, sheet.height_mm) / 2.0


def _inside_outline(point: tuple[float, float], sheet: AnySheet, slack: float) -> bool:
    if isinstance(sheet, AnnulusSheet):
        return math.hypot(*point) <= sheet.outer_radius_mm + slack
    return abs(point[0]) <= sheet.width_mm / 2 + slack and abs(point[1]) <= sheet.height_mm / 2 + slack


def _outline(sheet: AnySheet) -> str:
    if isinstance(sheet, AnnulusSheet):
        return f"a ring of radii {sheet.inner_radius_mm:g} and {sheet.outer_radius_mm:g} mm about the origin"
    return f"which reaches {sheet.width_mm / 2:g} mm along x and {sheet.height_mm / 2:g} mm along y"


def _distance_from_origin(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Smallest distance of a straight line between two points from the origin, mm."""
    along = (end[0] - start[0], end[1] - start[1])
    squared = along[0] ** 2 + along[1] ** 2
    part = -(start[0] * along[0] + start[1] * along[1]) / squared
    part = min(max(part, 0.0), 1.0)
    return math.hypot(start[0] + part * along[0], start[1] + part * along[1])
