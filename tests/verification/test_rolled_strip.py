"""A strip rolled into a circular arc: energy and moment in closed form.

The arc is isometric, so there is no membrane strain in the continuum. With nu = 0 the strip does not curl across
either, and energy and moment are Y h^3 / 24 kappa^2 per area and Y h^3 / 12 kappa per width. The discrete sheet has
chords: a spacing d on the arc of radius rho gives b1 = 2 rho (1 - cos(d / rho)).
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from fdsolver import meshes
from fdsolver.effects import build_force
from fdsolver.grid import Grid
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE

SHEET = Sheet(young_MPa=3500.0, poisson=0.0, thickness_mm=0.5)
NODES = (500, 2000, 8000)
RADIUS = 0.3  # of the arc, in strip lengths: the strip turns by 190 degrees
BEAM = (SHEET.thickness_mm / 20.0) ** 2 / 12.0  # Y h^3 / 12 per Y h L^2


def rolled(grid: Grid) -> np.ndarray:
    """Positions (3, ni, nj) on the arc, scaled; arc length is kept."""
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    return np.stack([RADIUS * np.sin(x / RADIUS), y, RADIUS * (1 - np.cos(x / RADIUS))])


def evaluate(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Force (3, ni, nj) and energies of the rolled strip, scaled."""
    r = np.ascontiguousarray(rolled(grid))
    force = np.empty_like(r)
    return force, build_force(grid, SHEET, KOITER, {})(r, force)


def test_bending_energy_is_that_of_the_chords() -> None:
    grid = meshes.rectangle(20.0, 12.0, 500)
    spacing = 1.0 / (grid.ni - 1)
    bend = 2 * RADIUS * (1 - np.cos(spacing / RADIUS)) / spacing**2
    inner_area = (grid.ni - 2) * spacing * 0.6  # the two free end rows carry no moment
    assert evaluate(grid)[1][1] == pytest.approx(BEAM * bend**2 / 2 * inner_area, rel=1e-11)


@pytest.mark.parametrize("bias", [0.0, 1.0])
def test_energy_and_moment_are_second_order(bias: float) -> None:
    """Energy per inner area, and the moment of the end rows' forces about the axis of the roll."""
    errors: dict[str, list[float]] = {"energy": [], "moment": [], "membrane": []}
    grids = [meshes.rectangle(20.0, 12.0, nodes, bias=bias) for nodes in NODES]
    for grid in grids:
        force, (membrane, bending, hourglass) = evaluate(grid)
        area = grid.node_area[1:-1].sum() / grid.length_mm**2
        errors["energy"].append(abs(bending / (BEAM / (2 * RADIUS**2) * area) - 1))
        # What bending alone exerts on the end: a couple of the first rows, taken about the second. (The bending
        # energy also grows with the stretch of an arc; those forces lie along it and have no lever here.)
        r = np.ascontiguousarray(rolled(grid))
        bare = np.empty_like(r)
        build_force(grid, SHEET, MEMBRANE, {})(r, bare)
        couple, lever = (force - bare)[:, :2], r[:, :2] - r[:, 1:2]
        torque = (lever[2] * couple[0] - lever[0] * couple[2]).sum()
        errors["moment"].append(abs(abs(torque) / (BEAM / RADIUS * 0.6) - 1))
        errors["membrane"].append((membrane + hourglass) / bending)
    for quantity, error in errors.items():
        observed = np.diff(np.log(error)) / np.diff([-0.5 * np.log(grid.nodes) for grid in grids])
        print(f"bias {bias} {quantity:9s} errors {np.array(error)} orders {observed}")
        # chord strains are of second order, their energy of fourth
        assert observed[-1] > (3.6 if quantity == "membrane" else 1.8), f"{quantity}: errors {error}"


def test_wrong_thickness_would_be_seen() -> None:
    """The comparison is sharp: one per mille of thickness shows in the energy."""
    grid = meshes.rectangle(20.0, 12.0, 500)
    r = np.ascontiguousarray(rolled(grid))
    thicker = dataclasses.replace(SHEET, thickness_mm=1.001 * SHEET.thickness_mm)
    energy = build_force(grid, thicker, KOITER, {})(r, np.empty_like(r))[1]
    assert energy / evaluate(grid)[1][1] == pytest.approx(1.001**2, rel=1e-11)
