"""The annulus turned in its plane until its mean surface folds over: the closed form, and what relaxation finds."""

from __future__ import annotations

import numpy as np
import pytest

from cases.runner import run
from cases.scene import load_scene
from fdsolver.fields import hourglass_share, zone_fields
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.meshes import annulus as mesh
from fdsolver.result import Status
from fdsolver.verdict import judge
from tensionfield.annulus import solve_annulus
from tests.tensionfield.annulus_scenes import annulus

SHEET = Sheet(3500.0, 0.31, 0.025)
TURNS = (45.0, 60.0, 75.0, 90.0)


def closed_form(grid: Grid, twist: float, lift: float) -> np.ndarray:
    """Positions (ni, nj, 3), mm, of the closed form on a mesh."""
    radius = np.clip(np.linalg.norm(grid.u, axis=-1), 62.5, 250.0)
    carried, turn, height = solve_annulus(annulus(lift=lift, twist=twist)).position(radius)
    angle = turn + np.arctan2(grid.u[..., 1], grid.u[..., 0])
    return np.stack([carried * np.cos(angle), carried * np.sin(angle), height], axis=-1)


def verdict(grid: Grid, r: np.ndarray) -> tuple[Status, list[str]]:
    zone = zone_fields(grid, SHEET, r, relaxed=True)
    return judge(Status.CONVERGED, grid, SHEET.thickness_mm, r, zone, hourglass_share(grid, r), relaxed=True)


@pytest.mark.parametrize("nodes", [1000, 5000])
@pytest.mark.parametrize("lift", [0.0, 1.0])
@pytest.mark.parametrize("twist", TURNS)
def test_the_closed_form_is_a_state_of_the_sheet(twist: float, lift: float, nodes: int) -> None:
    """However little it is lifted: at 45 to 90 degrees in the plane its rings first run inwards from the hub."""
    grid = mesh(62.5, 250.0, nodes)
    r = closed_form(grid, twist, lift)
    inwards = int((np.diff(np.hypot(r[0, :, 0], r[0, :, 1])) < 0.0).sum()) * grid.ni
    status, warnings = verdict(grid, r)
    assert status is Status.CONVERGED
    assert len(warnings) == 1 and "either way up" in warnings[0]
    if lift == 0.0:
        assert inwards and warnings[0].startswith(f"{inwards} zones")


def test_a_neck_narrower_than_a_zone_is_refused_until_the_mesh_is_fine_enough() -> None:
    """At 170 degrees the lines pass the axis at 6.7 mm, where zones are 7.5 mm long on 5 000 nodes, 3.7 on 20 000."""
    for nodes, converged in ((5000, False), (20000, True)):
        grid = mesh(62.5, 250.0, nodes)
        assert (verdict(grid, closed_form(grid, 170.0, 0.0))[0] is Status.CONVERGED) is converged


@pytest.mark.parametrize("twist", TURNS)
def test_relaxation_finds_the_closed_form_of_the_flat_turn(twist: float) -> None:
    scene = load_scene("annulus-twist", {"edges.inner.rotate_deg": twist})
    found, exact = (run(scene, method, nodes=5000) for method in ("tension-field", "exact"))
    # the scheme is of second order, and a zone is 2 pi / 148 of its radius wide
    limit = (2.0 * np.pi / found.grid.ni) ** 2
    assert found.status is Status.CONVERGED
    assert found.energy_N_mm["total"] == pytest.approx(exact.energy_N_mm["total"], rel=limit)
    torque = exact.reactions["inner"].moment_N_mm[2]
    assert found.reactions["inner"].moment_N_mm[2] == pytest.approx(torque, rel=limit)
    assert found.reactions["outer"].moment_N_mm[2] == pytest.approx(-torque, rel=limit)
    for name in ("stretch_major", "stretch_minor"):
        there, here = getattr(exact.zone, name), getattr(found.zone, name)
        np.testing.assert_allclose(here, there, rtol=0, atol=limit, err_msg=name)
    np.testing.assert_array_equal(found.zone.state, exact.zone.state)
    np.testing.assert_allclose(found.r, exact.r, rtol=0, atol=limit * 62.5)
