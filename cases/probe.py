"""What a result is asked for along lines: stretches on paths, heights on sections, and the measures of the
wrinkles there.

A line is a straight one between two reference points, or a circle about the origin, measured in the reference
plane. Zone fields are interpolated linearly between zone centres, positions cubically between nodes
(`cases.lattice`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from cases.halfwaves import half_waves, smallest_wavelength_ratio
from cases.lattice import Lattice, Places, node_lattice, zone_centres, zone_lattice
from cases.schema import Line
from cases.waves import Measures, measure
from fdsolver.grid import Grid
from fdsolver.result import Solution, ZoneFields

Columns = dict[str, np.ndarray]

# Samples per mesh line crossed: a section must show waves of 5 nodes smoothly, a path is piecewise linear
# anyway.
_PER_ZONE_SECTION, _PER_ZONE_PATH = 6, 2
_FEWEST_SAMPLES, _MOST_SAMPLES = 201, 20_001
# A wave of less than a thousandth of the thickness is no wrinkle: it is below what any residual of ours
# resolves.
_FLAT_PART = 1e-3
_SHORTEST = 1.9  # node spacings in a wave that nodes can carry, which is 2, less what is lost in measuring


class ProbeError(ValueError):
    """A line with no point on the sheet."""


@dataclass(frozen=True)
class Section:
    """Out-of-plane profile along a line; arrays (n,), mm.

    s, x, y : distance along the line and reference position. z : deformed height; on a circle of an annulus,
        relative to the
    circle's mean. spacing : distance along the line between successive mesh lines, of the family crossed more
    often.
    closed : a full circle; the last sample repeats the first.
    """

    s: np.ndarray
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    spacing: np.ndarray
    closed: bool

    def columns(self) -> Columns:
        """The columns of sections/NAME.csv."""
        return {"s_mm": self.s, "x_mm": self.x, "y_mm": self.y, "z_mm": self.z}


def sample_section(grid: Grid, r: np.ndarray, line: Line) -> Section:
    """Heights of the deformed sheet along a line.

    r : (ni, nj, 3) mm. Raises ProbeError if no point of the line is on the sheet; points off the sheet are
        left out.
    """
    lattice = node_lattice(grid)
    s, points, places = _sampled(lattice, grid, line, _PER_ZONE_SECTION)
    z = lattice.interpolate(r[..., 2], places)
    closed = line.radius_mm is not None and len(s) > 1 and bool(np.isclose(s[-1], _length(line), rtol=1e-12))
    if closed and grid.shape == "annulus":
        z = z - z[:-1].mean()
    rate = np.abs((places.rate @ _tangents(line, points)[..., None])[..., 0])
    return Section(s, points[:, 0], points[:, 1], z, 1.0 / rate.max(axis=-1), closed)


def measure_section(section: Section, thickness_mm: float) -> Measures:
    """Amplitude, wavelength, half-waves and symmetry of a section; waves below 1e-3 of the thickness count as
    flat.
    """
    return measure(section.s, section.z, section.closed, _FLAT_PART * thickness_mm)


def nodes_per_wrinkle(sections: Iterable[Section], thickness_mm: float) -> float | None:
    """Smallest local wavelength over node spacing where the envelope exceeds 20 % of its maximum.

    The smallest over all sections that are not flat; None if all are. Nodes carry no waves shorter than two spacings:
    what is shorter comes from the interpolation between the nodes of coarse curved meshes.
    """
    ratios = [
        smallest_wavelength_ratio(half_waves(part.s, part.z, part.closed), part.s, part.spacing)
        for part in sections
        if np.abs(part.z).max() > _FLAT_PART * thickness_mm
    ]
    return min((ratio for ratio in ratios if ratio is not None and ratio > _SHORTEST), default=None)


def path_columns(solution: Solution, name: str, line: Line) -> Columns:
    """The columns of paths/NAME.csv: stretches along a line, or by rings for the `radius` of an annulus."""
    if solution.grid.shape == "annulus" and name == "radius":
        return ring_columns(solution.grid, solution.zone)
    return line_columns(solution.grid, solution.zone, line)


def line_columns(grid: Grid, zone: ZoneFields, line: Line) -> Columns:
    """Stretches along a line, second order in the mesh; `state` is that of the nearest zone.

    s_mm starts at 0 where the line starts. Raises ProbeError if no point of the line is on the sheet.
    """
    s, points, _ = _sampled(node_lattice(grid), grid, line, _PER_ZONE_PATH)
    lattice = zone_lattice(grid)
    places = lattice.locate(points)
    return {
        "s_mm": s,
        "x_mm": points[:, 0],
        "y_mm": points[:, 1],
        "stretch_major": lattice.interpolate(zone.stretch_major, places),
        "stretch_minor": lattice.interpolate(zone.stretch_minor, places),
        "state": lattice.nearest(zone.state, places),
    }


def ring_columns(grid: Grid, zone: ZoneFields) -> Columns:
    """One row per ring of zones of an annulus: means round the ring, from the inner to the outer circle.

    R_mm : mean radius of the ring's zone centres. stretch_major_spread : largest minus smallest major stretch
    in the ring. state : the commonest in the ring.
    """
    counts = np.stack([(zone.state == state).sum(axis=0) for state in range(3)])
    return {
        "R_mm": np.linalg.norm(zone_centres(grid), axis=-1).mean(axis=0),
        "stretch_major": zone.stretch_major.mean(axis=0),
        "stretch_minor": zone.stretch_minor.mean(axis=0),
        "stretch_major_spread": np.ptp(zone.stretch_major, axis=0),
        "state": counts.argmax(axis=0).astype(np.int8),
    }


def _sampled(
    lattice: Lattice, grid: Grid, line: Line, per_zone: int
) -> tuple[np.ndarray, np.ndarray, Places]:
    """Evenly spaced samples of a line, as many as the mesh deserves: s, points and places of those on the
    sheet.
    """
    s, points = line_points(line, _FEWEST_SAMPLES)
    places = lattice.locate(points)
    tangents = _tangents(line, points)
    crossed = float(np.abs((places.rate @ tangents[..., None])[..., 0]).max(axis=-1).mean()) * _length(line)
    count = int(np.clip(np.ceil(crossed) * per_zone + 1, _FEWEST_SAMPLES, _MOST_SAMPLES))
    if count > _FEWEST_SAMPLES:
        s, points = line_points(line, count)
        places = lattice.locate(points)
    # The interpolated edge of a coarse mesh misses a true circle by far less than a hundredth of a zone.
    inside = places.distance_mm <= 1e-2 * np.sqrt(grid.zone_area.mean())
    if not inside.any():
        raise ProbeError(f"no point of the line {_described(line)} is on the sheet")
    return (
        s[inside],
        points[inside],
        Places(places.index[inside], places.rate[inside], places.distance_mm[inside]),
    )


def line_points(line: Line, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Distances (count,) and positions (count, 2) along a line; a circle runs counter-clockwise from the +x
    axis.
    """
    s = np.linspace(0.0, _length(line), count)
    if line.radius_mm is not None:
        angle = s / line.radius_mm
        return s, line.radius_mm * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    start, end = _ends(line)
    return s, start + (end - start) * np.linspace(0.0, 1.0, count)[:, None]


def _tangents(line: Line, points: np.ndarray) -> np.ndarray:
    """Unit tangents (m, 2) of a line at its points."""
    if line.radius_mm is not None:
        return np.stack([-points[:, 1], points[:, 0]], axis=-1) / line.radius_mm
    start, end = _ends(line)
    return np.broadcast_to((end - start) / np.linalg.norm(end - start), points.shape)


def _length(line: Line) -> float:
    if line.radius_mm is not None:
        return 2.0 * np.pi * line.radius_mm
    start, end = _ends(line)
    return float(np.linalg.norm(end - start))


def _ends(line: Line) -> tuple[np.ndarray, np.ndarray]:
    if line.start_mm is None or line.end_mm is None:
        raise ProbeError("a line needs from_mm and to_mm, or radius_mm")
    return np.array(line.start_mm), np.array(line.end_mm)


def _described(line: Line) -> str:
    if line.radius_mm is not None:
        return f"of radius {line.radius_mm:g} mm"
    return f"from {list(line.start_mm or ())} to {list(line.end_mm or ())} mm"
