"""Converged states that are no states of the sheet are named."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver.fields import TENSE, WRINKLED, hourglass_share, zone_fields
from fdsolver.folds import folded_zones, turned_over
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.meshes import annulus, rectangle
from fdsolver.result import Status
from fdsolver.verdict import judge

SHEET = Sheet(1.0, 0.3, 0.1)
STRIP = rectangle(100.0, 60.0, 600)


def flat(grid: Grid, stretch: float = 1.1) -> np.ndarray:
    return np.concatenate([stretch * grid.u, np.zeros((grid.ni, grid.nj, 1))], axis=-1)


def verdict(
    grid: Grid, r: np.ndarray, status: Status = Status.CONVERGED, relaxed: bool = False
) -> tuple[Status, list[str]]:
    return judge(
        status,
        grid,
        SHEET.thickness_mm,
        r,
        zone_fields(grid, SHEET, r, relaxed=relaxed),
        hourglass_share(grid, r),
        relaxed,
    )


@pytest.mark.parametrize("grid", [STRIP, annulus(20.0, 60.0, 600)])
def test_a_stretched_sheet_passes(grid: Grid) -> None:
    assert verdict(grid, flat(grid)) == (Status.CONVERGED, [])


@pytest.mark.parametrize("status", [Status.STALLED, Status.TIME_LIMIT])
def test_an_unfinished_run_keeps_its_own_status(status: Status) -> None:
    r = flat(STRIP)
    r[10, 10, 0] += 15.0
    assert verdict(STRIP, r, status)[0] is status


def test_a_node_drawn_across_its_neighbours_inverts_planar_zones() -> None:
    r = flat(STRIP)
    r[10, 10, 0] += 15.0
    status, warnings = verdict(STRIP, r)
    assert status is Status.ZONE_INVERTED
    assert "90 degrees" in warnings[0]


def crossed(grid: Grid, width: float) -> np.ndarray:
    """The sheet pulled along x and drawn together across; in a few zones its mesh lines have crossed."""
    r = flat(grid)
    r[..., 1] = width * grid.u[..., 1]
    r[10:13, 9:11, 1] = r[10:13, 10:8:-1, 1]
    return r


def test_a_relaxed_membrane_may_lie_either_way_up_across_its_wrinkles() -> None:
    """Its energy does not depend on the minor strain there, nor on the side that is up."""
    grid = rectangle(100.0, 60.0, 6000)
    r = crossed(grid, 0.7)
    wrong = turned_over(grid, r)
    assert 0 < wrong.sum() < 0.01 * wrong.size
    assert (zone_fields(grid, SHEET, r, relaxed=True).state[wrong] == WRINKLED).all()
    status, warnings = verdict(grid, r, relaxed=True)
    assert status is Status.CONVERGED
    assert warnings[0].startswith(f"{wrong.sum()} zones") and "either way up" in warnings[0]
    assert verdict(grid, r, relaxed=False)[0] is Status.ZONE_INVERTED


def test_a_tense_zone_that_lies_upside_down_is_inverted_in_a_relaxed_membrane_too() -> None:
    grid = rectangle(100.0, 60.0, 6000)
    r = crossed(grid, 3.0)
    assert (zone_fields(grid, SHEET, r, relaxed=True).state[turned_over(grid, r)] == TENSE).any()
    assert verdict(grid, r, relaxed=True)[0] is Status.ZONE_INVERTED


def test_a_planar_relaxed_membrane_that_is_turned_over_as_a_whole_has_collapsed() -> None:
    r = flat(STRIP)
    r[..., 1] *= -0.5
    assert verdict(STRIP, r, relaxed=True)[0] is Status.OUTSIDE_VALIDITY


@pytest.mark.parametrize("grid", [STRIP, annulus(20.0, 60.0, 600)])
def test_only_zones_whose_area_has_changed_its_sign_are_turned_over(grid: Grid) -> None:
    assert not turned_over(grid, flat(grid)).any()
    assert turned_over(grid, flat(grid) * (1.0, -1.0, 1.0)).all()


def test_a_checkerboard_is_named() -> None:
    r = flat(STRIP, 1.0 + 1e-6)
    i, j = np.indices((STRIP.ni, STRIP.nj))
    r[..., 2] = 0.5 * (-1.0) ** (i + j)
    assert verdict(STRIP, r)[0] is Status.HOURGLASS


def test_what_is_left_of_the_random_start_is_not_refused() -> None:
    r = flat(STRIP)
    i, j = np.indices((STRIP.ni, STRIP.nj))
    r[..., 2] = 0.005 * SHEET.thickness_mm * (-1.0) ** (i + j)
    assert hourglass_share(STRIP, r)["out_of_plane"] > 1.0
    assert verdict(STRIP, r)[0] is Status.CONVERGED


def pleated(grid: Grid, lines: slice) -> np.ndarray:
    """Every second of the mesh lines raised so far that the zones beside it stand steeper than 45 degrees."""
    r = flat(grid)
    spacing = r[1, 0, 0] - r[0, 0, 0]
    r[lines, :, 2] += 1.5 * spacing * (np.arange(grid.ni) % 2)[lines, None]
    return r


def test_a_pleated_sheet_is_warned_of() -> None:
    r = pleated(STRIP, slice(5, 15))
    _, warnings = verdict(STRIP, r)
    assert folded_zones(STRIP, r).mean() > 0.25
    assert warnings


def test_one_sharp_fold_is_a_warning() -> None:
    """One raised line makes two rows of zones stand against each other, less than 1 % of them."""
    grid = rectangle(1000.0, 60.0, 12000)
    r = pleated(grid, slice(51, 52))
    assert folded_zones(grid, r).sum() == 2 * (grid.nj - 1)
    status, warnings = verdict(grid, r)
    assert status is Status.CONVERGED
    assert str(2 * (grid.nj - 1)) in warnings[0]


def test_a_fold_across_the_seam_of_a_closed_mesh_is_seen() -> None:
    grid = annulus(20.0, 60.0, 1200)
    r = flat(grid)
    spacing = np.linalg.norm(r[1, -1] - r[0, -1])
    r[0, :, 2] += 1.5 * spacing
    folded = folded_zones(grid, r)
    assert folded[0].all() and folded[-1].all() and folded.sum() == 2 * (grid.nj - 1)


def folded_over(grid: Grid) -> np.ndarray:
    """The strip folded at its middle, one half upon the other and a little above it, taut everywhere."""
    r = flat(grid)
    r[..., 0] = np.abs(r[..., 0])
    r[..., 2] = np.where(grid.u[..., 0] > 0.0, 1.0, 0.0)
    return r


def test_a_relaxed_membrane_that_is_folded_over_is_no_sheet_and_a_folded_plate_is_warned_of() -> None:
    r = folded_over(STRIP)
    assert folded_zones(STRIP, r).mean() > 0.01
    status, warnings = verdict(STRIP, r, relaxed=True)
    assert status is Status.OUTSIDE_VALIDITY
    assert "90 degrees" in warnings[0]
    assert verdict(STRIP, r, relaxed=False)[0] is Status.CONVERGED
    assert verdict(STRIP, r, Status.STALLED, relaxed=True)[0] is Status.STALLED
