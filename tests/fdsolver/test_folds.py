"""Folds of a relaxed membrane: which belong to its tension field, and which are faults."""

from __future__ import annotations

import numpy as np
import pytest

from fdsolver.fields import TENSE, WRINKLED, hourglass_share, zone_fields
from fdsolver.folds import folded_against_tension, folded_zones, inverted_zones, turned_over
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.meshes import annulus, rectangle
from fdsolver.result import Status
from fdsolver.verdict import judge

SHEET = Sheet(1.0, 0.3, 0.1)
STRIP = rectangle(100.0, 60.0, 600)


def state(grid: Grid, r: np.ndarray) -> np.ndarray:
    return zone_fields(grid, SHEET, r, relaxed=True).state


def verdict(grid: Grid, r: np.ndarray) -> tuple[Status, list[str]]:
    zone = zone_fields(grid, SHEET, r, relaxed=True)
    return judge(Status.CONVERGED, grid, SHEET.thickness_mm, r, zone, hourglass_share(grid, r), True)


def of_widths(widths: np.ndarray, pull: float = 1.1) -> np.ndarray:
    """The strip stretched along x, every column of zones to a width of its own; a negative one lies upside down."""
    y = np.cumsum(np.concatenate([[0.0], widths * np.diff(STRIP.u[0, :, 1])]))
    x = pull * STRIP.u[..., 0]
    return np.stack([x, np.broadcast_to(y, x.shape), np.zeros_like(x)], axis=-1)


def zigzag(wrinkled: float, inside: float) -> np.ndarray:
    """Widths of a strip whose middle lies upside down: its border so wide as the upright part, `inside` further in."""
    widths = np.full(STRIP.nj - 1, wrinkled)
    widths[5:13] = -wrinkled
    widths[7:11] = -inside
    return widths


def through_a_point(grid: Grid, lift: float) -> np.ndarray:
    """An annulus whose lines run straight through its axis: the double cone of a hub turned by half a circle."""
    radius = np.linalg.norm(grid.u, axis=-1)
    inner, outer = radius.min(), radius.max()
    share = (radius - inner) / (outer - inner)
    beyond = (-inner + share * (inner + outer)) / radius
    return np.concatenate([beyond[..., None] * grid.u, lift * (1.0 - share[..., None])], axis=-1)


def test_a_fold_along_the_tension_is_the_tension_field_s_own() -> None:
    """Its two sides lie upon each other, and nothing pulls them apart."""
    r = of_widths(zigzag(0.4, 0.4))
    assert (state(STRIP, r) == WRINKLED).all()
    assert (
        folded_zones(STRIP, r).any()
        and not inverted_zones(STRIP, r, zone_fields(STRIP, SHEET, r, True)).any()
    )
    status, warnings = verdict(STRIP, r)
    assert status is Status.CONVERGED
    assert len(warnings) == 1 and warnings[0].startswith(f"{turned_over(STRIP, r).sum()} zones")


def test_tense_zones_may_lie_upside_down_behind_such_folds_and_behind_no_others() -> None:
    """Side by side they are right or wrong together: the tense ones touch no fold themselves."""
    for width, expected in ((0.4, Status.CONVERGED), (0.7, Status.ZONE_INVERTED)):
        r = of_widths(zigzag(width, 1.5))
        zone = zone_fields(STRIP, SHEET, r, relaxed=True)
        tense = turned_over(STRIP, r) & (zone.state == TENSE)
        assert tense.any() and not folded_against_tension(STRIP, r, zone)[tense].any()
        assert verdict(STRIP, r)[0] is expected


def test_tense_zones_are_not_folded_along_the_tension() -> None:
    """They are pulled across it too, and nothing at the fold would hold them."""
    r = of_widths(zigzag(0.78, 0.78), pull=1.6)
    assert (state(STRIP, r) == TENSE).all()
    assert verdict(STRIP, r)[0] is Status.ZONE_INVERTED


@pytest.mark.parametrize("lift", [0.0, 1.0])
def test_a_fold_across_the_tension_is_a_fault(lift: float) -> None:
    """No force holds the edge over which a taut sheet is folded back."""
    r = of_widths(np.full(STRIP.nj - 1, 0.4))
    crease = STRIP.ni // 2
    r[..., 0] = np.abs(r[..., 0] - r[crease, :1, 0])
    r[crease:, :, 2] = lift
    assert (state(STRIP, r) == WRINKLED).all()
    status, warnings = verdict(STRIP, r)
    assert status is Status.OUTSIDE_VALIDITY
    assert "against their tension" in warnings[-1]


@pytest.mark.parametrize("nodes", [600, 2400, 9600])
@pytest.mark.parametrize("lift", [0.0, 20.0])
def test_a_sheet_that_runs_together_to_a_point_has_collapsed_on_every_mesh(nodes: int, lift: float) -> None:
    """Its width passes through zero as at a fold, but there the whole ring has no length."""
    grid = annulus(10.0, 60.0, nodes)
    r = through_a_point(grid, lift)
    assert folded_zones(grid, r).any() and (state(grid, r)[folded_zones(grid, r)] == WRINKLED).all()
    status, warnings = verdict(grid, r)
    assert status in (Status.OUTSIDE_VALIDITY, Status.ZONE_INVERTED)
    assert "runs together" in warnings[-1]


def ring_and_lens(grid: Grid) -> np.ndarray:
    """A ring pulled outwards, its pleats turned over all the way round, and further out in one place only."""
    radius, angle = np.linalg.norm(grid.u, axis=-1), np.arctan2(grid.u[..., 1], grid.u[..., 0])
    over = 0.6 * np.exp(-(((radius - 46.0) / 2.5) ** 2))
    over += 0.6 * np.exp(-(((radius - 55.0) / 2.5) ** 2) - ((angle + 1.0) / 0.5) ** 2)
    width = 0.3 - over
    width = 0.5 * (width[:, 1:] + width[:, :-1]) * np.diff(radius, axis=1)
    carried = 65.0 + np.concatenate([np.zeros((grid.ni, 1)), np.cumsum(width, axis=1)], axis=1)
    return np.stack([carried * np.cos(angle), carried * np.sin(angle), 0.0 * angle], axis=-1)


def test_it_does_not_matter_where_a_closed_mesh_begins() -> None:
    grid = annulus(40.0, 60.0, 4800)
    r = ring_and_lens(grid)
    here = inverted_zones(grid, r, zone_fields(grid, SHEET, r, relaxed=True))
    right = turned_over(grid, r) & ~here
    assert here.any() and right[:, : grid.nj // 2].any(axis=1).all() and not right[:, grid.nj // 2 :].any()
    for rows in range(0, grid.ni, grid.ni // 20):
        angle = 2.0 * np.pi * rows / grid.ni
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        there = np.roll(r, rows, axis=0)
        there[..., :2] = there[..., :2] @ turn
        zone = zone_fields(grid, SHEET, there, relaxed=True)
        assert (inverted_zones(grid, there, zone) == np.roll(here, rows, axis=0)).all()
