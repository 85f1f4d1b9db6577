"""Paths and sections on meshes of every shape, against fields that are known everywhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from cases.lattice import Places, node_lattice, zone_centres, zone_lattice
from cases.probe import (
    ProbeError,
    line_columns,
    measure_section,
    nodes_per_wrinkle,
    path_columns,
    ring_columns,
    sample_section,
)
from cases.schema import Line
from fdsolver import meshes
from fdsolver.grid import Grid
from fdsolver.result import ZoneFields
from tests.cases.made import SHEET, made_solution

MAKERS: dict[str, Callable[[int], Grid]] = {
    "rectangle": lambda nodes: meshes.rectangle(30.0, 50.0, nodes, bias=1.0),
    "annulus": lambda nodes: meshes.annulus(62.5, 250.0, nodes),
    "hole": lambda nodes: meshes.rectangle_with_hole(50.0, 125.0, 15.0, nodes),
}


def straight(start: tuple[float, float], end: tuple[float, float]) -> Line:
    return Line.model_validate({"from_mm": start, "to_mm": end})


LINES = {
    # the first two run along mesh lines, the others across; (15, 0) and (0, 15) are on the hole's edge
    "rectangle": [straight((-15.0, 0.0), (15.0, 0.0)), straight((-15.0, -25.0), (12.0, 21.0))],
    "annulus": [straight((62.5, 0.0), (250.0, 0.0)), straight((-200.0, 70.0), (200.0, 110.0))],
    "hole": [
        straight((15.0, 0.0), (25.0, 0.0)),
        straight((0.0, 15.0), (0.0, 62.5)),
        straight((-25.0, 24.0), (25.0, 24.0)),
        straight((10.0, -62.5), (25.0, 62.5)),
    ],
}


def smooth(grid: Grid, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    size = grid.length_mm
    return 1.0 + 0.3 * np.sin(4.0 * x / size) * np.cos(3.0 * y / size)


def uniform_zone(field: np.ndarray) -> ZoneFields:
    ones = np.ones_like(field)
    return ZoneFields(field, 0.5 * field, ones, ones, np.full(field.shape, 2, dtype=np.int8))


def points_on(grid: Grid, seed: int) -> np.ndarray:
    """Random points of the sheet: convex combinations of each zone's corners."""
    random = np.random.default_rng(seed)
    i = random.integers(0, grid.zone_area.shape[0], 400)
    j = random.integers(0, grid.zone_area.shape[1], 400)
    s, t = random.uniform(0.05, 0.95, (2, 400, 1))
    following = (i + 1) % grid.ni
    near = (1 - t) * grid.u[i, j] + t * grid.u[i, j + 1]
    far = (1 - t) * grid.u[following, j] + t * grid.u[following, j + 1]
    return (1 - s) * near + s * far


@pytest.mark.parametrize("shape", MAKERS)
def test_every_point_of_the_sheet_is_found(shape: str) -> None:
    grid = MAKERS[shape](900)
    points = points_on(grid, seed=1)
    for lattice in (node_lattice(grid), zone_lattice(grid)):
        places = lattice.locate(points)
        # Newton ends at rounding: 1e-12 of the size is a few hundred times that.
        assert places.distance_mm.max() < 1e-12 * grid.length_mm
        found = lattice.interpolate(lattice.positions, places)
        assert np.abs(found - points).max() < 1e-12 * grid.length_mm


@pytest.mark.parametrize("shape", MAKERS)
def test_linear_fields_are_exact_on_every_mesh(shape: str) -> None:
    """Kinked mesh lines, curved edges and extrapolation to the edge included."""
    grid = MAKERS[shape](900)
    for line in LINES[shape]:
        columns = line_columns(grid, uniform_zone(2.0 + zone_centres(grid) @ [0.03, -0.05]), line)
        expected = 2.0 + 0.03 * columns["x_mm"] - 0.05 * columns["y_mm"]
        # A hundred roundings of numbers up to 15.
        assert np.abs(columns["stretch_major"] - expected).max() < 1e-12
        assert np.abs(columns["stretch_minor"] - 0.5 * expected).max() < 1e-12


@pytest.mark.parametrize("shape", MAKERS)
def test_zone_fields_on_lines_are_second_order(shape: str) -> None:
    errors = []
    for nodes in (1000, 16000):
        grid = MAKERS[shape](nodes)
        centres = zone_centres(grid)
        zone = uniform_zone(smooth(grid, centres[..., 0], centres[..., 1]))
        worst = 0.0
        for line in LINES[shape]:
            columns = line_columns(grid, zone, line)
            exact = smooth(grid, columns["x_mm"], columns["y_mm"])
            worst = max(worst, float(np.abs(columns["stretch_major"] - exact).max()))
        errors.append(worst)
    # A quarter of the spacing: second order divides by 16, first order by 4.
    assert errors[1] < errors[0] / 12.0


def test_heights_on_sections_are_fourth_order_on_smooth_meshes() -> None:
    line = straight((-200.0, 70.0), (200.0, 110.0))
    errors = []
    for nodes in (2000, 32000):
        grid = MAKERS["annulus"](nodes)
        z = smooth(grid, grid.u[..., 0], grid.u[..., 1])
        r = np.concatenate([grid.u, z[..., None]], axis=-1)
        section = sample_section(grid, r, line)
        errors.append(float(np.abs(section.z - smooth(grid, section.x, section.y)).max()))
    # A quarter of the spacing: fourth order divides by 256, third by 64.
    assert errors[1] < errors[0] / 128.0


@pytest.mark.parametrize("shape", MAKERS)
def test_lines_are_measured_in_the_reference_plane_from_their_start(shape: str) -> None:
    grid = MAKERS[shape](900)
    solution = made_solution(grid, stretch=1.5)
    for line in LINES[shape]:
        start, end = np.array(line.start_mm), np.array(line.end_mm)
        section = sample_section(grid, solution.r, line)
        columns = line_columns(grid, solution.zone, line)
        for s, x, y in (
            (section.s, section.x, section.y),
            (columns["s_mm"], columns["x_mm"], columns["y_mm"]),
        ):
            along = (end - start) / np.linalg.norm(end - start)
            points = np.stack([x, y], axis=-1)
            # Rounding of positions of this size.
            assert np.abs(points - start - s[:, None] * along).max() < 1e-12 * grid.length_mm
            assert s[0] == 0.0
            assert s[-1] == pytest.approx(np.linalg.norm(end - start), rel=1e-14)


def test_the_samples_follow_the_mesh() -> None:
    """At least six to a mesh line, so that waves of a few nodes are seen whole."""
    grid = meshes.rectangle(100.0, 10.0, 40_000)
    section = sample_section(grid, made_solution(grid).r, straight((-50.0, 0.0), (50.0, 0.0)))
    assert len(section.s) >= 6 * (grid.ni - 1)
    assert section.spacing == pytest.approx(100.0 / (grid.ni - 1), rel=1e-9)


def test_points_off_the_sheet_are_left_out() -> None:
    grid = MAKERS["hole"](2000)
    section = sample_section(grid, made_solution(grid).r, straight((-25.0, 3.0), (25.0, 3.0)))
    half_chord = np.sqrt(15.0**2 - 3.0**2)
    spacing = 50.0 / 200
    assert np.abs(section.x).min() == pytest.approx(half_chord, abs=spacing)
    assert np.abs(section.x).min() >= half_chord - 0.05
    with pytest.raises(ProbeError, match=r"no point of the line from \[-5.0, 1.0\] to \[5.0, 1.0\] mm"):
        sample_section(grid, made_solution(grid).r, straight((-5.0, 1.0), (5.0, 1.0)))


def test_the_state_is_that_of_the_nearest_zone() -> None:
    grid = meshes.rectangle(40.0, 20.0, 3321)
    centres = zone_centres(grid)
    zone = uniform_zone(np.ones(centres.shape[:2]))
    zone = replace(zone, state=np.where(centres[..., 0] < 3.0, 0, 2).astype(np.int8))
    columns = line_columns(grid, zone, straight((-20.0, 0.1), (20.0, 0.1)))
    edge = grid.u[np.searchsorted(grid.u[:, 0, 0], 3.0) - 1 : np.searchsorted(grid.u[:, 0, 0], 3.0) + 1, 0, 0]
    assert set(columns["state"][columns["x_mm"] < edge[0]]) == {0}
    assert set(columns["state"][columns["x_mm"] > edge[1]]) == {2}


def test_the_nearest_of_a_closed_mesh_goes_round() -> None:
    lattice = zone_lattice(MAKERS["annulus"](900))
    rows = len(lattice.positions)
    number = np.arange(rows)[:, None] + np.zeros(lattice.positions.shape[1])
    index = np.array([[-0.4, 0.0], [rows - 0.6, 0.0], [rows - 0.4, 0.0], [-0.6, 0.0]])
    places = Places(index, np.zeros((4, 2, 2)), np.zeros(4))
    assert lattice.nearest(number, places).tolist() == [0, rows - 1, 0, rows - 1]


def test_the_radius_of_an_annulus_has_one_row_per_ring() -> None:
    grid = MAKERS["annulus"](2000)
    centres = zone_centres(grid)
    radius, angle = np.linalg.norm(centres, axis=-1), np.arctan2(centres[..., 1], centres[..., 0])
    zone = uniform_zone(1.0 + radius / 1000.0 + 0.01 * np.cos(2.0 * angle))
    zone = replace(zone, state=np.where(radius < 100.0, 1, 2).astype(np.int8))
    zone.state[0, -1] = 0
    zone.state[0, 0] = 2
    columns = ring_columns(grid, zone)
    assert list(columns) == ["R_mm", "stretch_major", "stretch_minor", "stretch_major_spread", "state"]
    assert len(columns["R_mm"]) == grid.nj - 1
    # The mean of four nodes at an angle of 2 pi / ni lies on the mean of their radii times cos(pi / ni).
    rings = np.linalg.norm(grid.u[0], axis=-1)
    expected = 0.5 * (rings[1:] + rings[:-1]) * np.cos(np.pi / grid.ni)
    assert columns["R_mm"] == pytest.approx(expected, rel=1e-13)
    # cos(2 angle) has no mean round the ring, and reaches nearly 1 and -1.
    assert columns["stretch_major"] == pytest.approx(1.0 + expected / 1000.0, rel=1e-12)
    assert columns["stretch_minor"] == pytest.approx(0.5 + expected / 2000.0, rel=1e-12)
    assert columns["stretch_major_spread"] == pytest.approx(0.02 * np.cos(2.0 * np.pi / grid.ni), rel=1e-9)
    assert np.array_equal(columns["state"], np.where(expected < 100.0, 1, 2))


def test_only_the_path_named_radius_goes_by_rings() -> None:
    solution = made_solution(MAKERS["annulus"](900))
    line = straight((62.5, 0.0), (250.0, 0.0))
    assert "R_mm" in path_columns(solution, "radius", line)
    assert "s_mm" in path_columns(solution, "another", line)
    plate = made_solution(MAKERS["rectangle"](900))
    assert "s_mm" in path_columns(plate, "radius", LINES["rectangle"][0])


def test_rings_of_an_annulus_are_measured_from_their_mean() -> None:
    """A cone of slope 0.5 with 12 wrinkles: the cone's own height is no amplitude."""
    grid = MAKERS["annulus"](16000)
    solution = made_solution(
        grid, lambda x, y: 125.0 - 0.5 * np.hypot(x, y) + 0.8 * np.cos(12.0 * np.arctan2(y, x) + 0.4)
    )
    section = sample_section(grid, solution.r, Line(radius_mm=150.0))
    assert section.closed
    assert section.s[-1] == pytest.approx(2.0 * np.pi * 150.0, rel=1e-14)
    # Cubic interpolation of waves of 22 nodes errs by 3/128 (2 pi / 22)^4 of the amplitude, 1.6e-4 of it.
    assert grid.ni / 12.0 > 22.0
    assert section.z == pytest.approx(0.8 * np.cos(12.0 * section.s / 150.0 + 0.4), abs=0.8 * 1.6e-4)
    measures = measure_section(section, SHEET.thickness_mm)
    assert measures.amplitude_mm == pytest.approx(0.8, rel=1e-3)
    assert measures.rms_mm == pytest.approx(0.8 / np.sqrt(2.0), rel=1e-3)
    assert measures.half_waves == 24
    assert measures.wavelength_mm == pytest.approx(2.0 * np.pi * 150.0 / 12.0, rel=1e-3)
    assert measures.symmetry is None
    assert nodes_per_wrinkle([section], SHEET.thickness_mm) == pytest.approx(grid.ni / 12.0, rel=2e-3)


def test_nodes_per_wrinkle_is_the_worst_of_all_sections() -> None:
    grid = meshes.rectangle(100.0, 40.0, 16000)
    coarse = made_solution(grid, lambda x, y: np.sin(2.0 * np.pi * x / 20.0))
    fine = made_solution(grid, lambda x, y: np.sin(2.0 * np.pi * x / 8.0))
    line = straight((-50.0, 0.0), (50.0, 0.0))
    spacing = 100.0 / (grid.ni - 1)
    sections = [sample_section(grid, solution.r, line) for solution in (coarse, fine)]
    assert nodes_per_wrinkle(sections, SHEET.thickness_mm) == pytest.approx(8.0 / spacing, rel=1e-3)
    assert nodes_per_wrinkle(sections[:1], SHEET.thickness_mm) == pytest.approx(20.0 / spacing, rel=1e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_small_and_fine_ripples_do_not_count_for_nodes_per_wrinkle(side: float) -> None:
    """Waves of 4 mm at 10 % of the amplitude of those of 20 mm: below the envelope's 20 %."""
    grid = meshes.rectangle(100.0, 40.0, 16000)
    solution = made_solution(
        grid,
        lambda x, y: np.where(
            side * x < 0.0, np.sin(2.0 * np.pi * x / 20.0), 0.1 * np.sin(2.0 * np.pi * x / 4.0)
        ),
    )
    section = sample_section(grid, solution.r, straight((-50.0, 0.0), (50.0, 0.0)))
    spacing = 100.0 / (grid.ni - 1)
    assert nodes_per_wrinkle([section], SHEET.thickness_mm) == pytest.approx(20.0 / spacing, rel=1e-2)


def test_a_flat_sheet_has_no_wrinkles() -> None:
    """Height noise of a thousandth of the thickness, such as a random start leaves, makes no wavelength."""
    grid = meshes.rectangle(100.0, 40.0, 4000)
    noise = np.random.default_rng(0).uniform(-1.0, 1.0, grid.u.shape[:2])
    solution = made_solution(grid, lambda x, y: 0.9e-3 * SHEET.thickness_mm * noise)
    # along a row of nodes: between them cubic interpolation may overshoot the noise
    section = sample_section(grid, solution.r, straight((-50.0, 0.0), (50.0, 0.0)))
    section = replace(
        section, z=np.clip(section.z, -0.9e-3 * SHEET.thickness_mm, 0.9e-3 * SHEET.thickness_mm)
    )
    measures = measure_section(section, SHEET.thickness_mm)
    assert (measures.wavelength_mm, measures.half_waves, measures.symmetry) == (None, 0, None)
    assert nodes_per_wrinkle([section], SHEET.thickness_mm) is None


def test_a_cone_on_a_coarse_mesh_has_no_wrinkles() -> None:
    """Between nodes cubic interpolation errs with the period of the mesh, which no nodal field can have."""
    thickness = 0.025
    grid = meshes.annulus(62.5, 250.0, 1250)
    solution = made_solution(grid, lambda x, y: 60.0 * np.log(np.hypot(x, y)))
    section = sample_section(grid, solution.r, Line(radius_mm=109.0))
    assert np.ptp(section.z) > 1e-3 * thickness
    assert nodes_per_wrinkle([section], thickness) is None
    waves = made_solution(
        grid, lambda x, y: np.cos(grid.ni // 3 * np.arctan2(y, x))
    )  # three nodes each are still seen
    section = sample_section(grid, waves.r, Line(radius_mm=109.0))
    assert nodes_per_wrinkle([section], thickness) == pytest.approx(3.0, rel=0.2)
