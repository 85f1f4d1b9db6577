"""An effect that is off costs nothing: it has left no operation, no branch and no array behind. Counted, not timed."""

from __future__ import annotations

import dataclasses
import re

import numba
import numpy as np
import pytest

from fdsolver import membrane, membrane_plane, meshes, plate_linear, plate_plane, plate_rows
from fdsolver.effects import build_force
from fdsolver.mass import nodal_masses
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.moderate import ModerateStVenantKirchhoff
from tests.generated_code import COLUMNS, LAW, SCRATCH, operations, operations_per_node, unrolled

MODERATE = numba.typeof(ModerateStVenantKirchhoff(0.3))
ROWS = {
    "membrane": (membrane.zone_row, (SCRATCH, LAW, COLUMNS)),
    "moderate": (membrane.zone_row, (SCRATCH, MODERATE, COLUMNS)),
    "plane": (membrane_plane.zone_row, (SCRATCH, LAW, COLUMNS)),
    "full": (plate_rows.node_moment_row, (SCRATCH, numba.float64, COLUMNS)),
    "linear": (plate_linear.node_moment_row, (SCRATCH, COLUMNS, SCRATCH)),
    "linear, orthogonal": (plate_linear.node_moment_row, (SCRATCH, COLUMNS, numba.none)),
    "hourglass, plane": (plate_plane.hourglass_row, (SCRATCH, COLUMNS)),
    "zone moments, full": (plate_rows.zone_moment_row, (SCRATCH, COLUMNS)),
}


@pytest.fixture(scope="module")
def code() -> dict[str, str]:
    return {name: unrolled(row, signature) for name, (row, signature) in ROWS.items()}


def memory(code: str) -> int:
    """Loads and stores of numbers."""
    return len(re.findall(r"= load double|store double", code))


def branches(code: str) -> int:
    return len(re.findall(r"\bbr i1\b", code))


@pytest.mark.parametrize(
    ("less", "more", "share"),
    [
        # by hand: 24 of 36 products of the gradient and its adjoint, 5 of 9 of the strain, 8 of 12 of the stress
        ("plane", "membrane", 0.75),
        ("moderate", "membrane", 0.95),
        # no normal, no cross products, one component instead of three
        ("linear", "full", 0.5),
        ("linear, orthogonal", "linear", 0.75),
        # two components of three, and no moment, normal or cross product
        ("hourglass, plane", "zone moments, full", 0.4),
    ],
)
def test_leaving_an_effect_out_leaves_its_operations_out(
    code: dict[str, str], less: str, more: str, share: float
) -> None:
    assert operations(code[more]) > 30  # the code is there to be counted
    assert operations(code[less]) < share * operations(code[more])
    assert memory(code[less]) <= memory(code[more])
    assert branches(code[less]) <= branches(code[more])


def test_every_effect_left_out_of_the_plate_saves_operations() -> None:
    linear, flat = dataclasses.replace(KOITER, moderate=True), dataclasses.replace(KOITER, out_of_plane=False)
    planar = dataclasses.replace(MEMBRANE, out_of_plane=False)
    counts = [operations_per_node(model) for model in (KOITER, linear, flat, planar)]
    assert counts[0] > 1.8 * counts[1] and counts[1] > 1.2 * counts[2] and counts[2] > 1.2 * counts[3]


def test_no_array_of_an_effect_that_is_off() -> None:
    grid = meshes.rectangle(20.0, 12.0, 500)
    sheet = Sheet(3500.0, 0.31, 0.1)

    def parts(model: Model) -> tuple[int, int, int, int, int]:
        force = build_force(grid, sheet, model, {})
        r = np.zeros((model.components, grid.ni, grid.nj))
        r[:2] = np.moveaxis(grid.u, 2, 0) / grid.length_mm
        node, twist = (0 if field is None else len(field) for field in (force.node, force.twist))
        return len(r), len(nodal_masses(force, r, r, force.relaxed)), node, twist, force.kernel.slots

    plane = parts(dataclasses.replace(MEMBRANE, out_of_plane=False))
    flat_plate = parts(dataclasses.replace(KOITER, out_of_plane=False))
    space, linear, full = parts(MEMBRANE), parts(dataclasses.replace(KOITER, moderate=True)), parts(KOITER)
    assert plane[:4] == (2, 3, 0, 0)
    assert flat_plate[:4] == (2, 3, 0, 3)  # of the plate its hourglass stiffness is left
    assert space[:4] == (3, 6, 0, 0)
    assert linear[2:4] == (7, 4)  # on a rectangle: no coupling of the mixed curvature
    assert full[2:4] == (8, 4)
    assert plane[4] < flat_plate[4] <= space[4] < linear[4] < full[4]
