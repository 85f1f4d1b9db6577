"""The nodal masses of the models with effects left out make a unit time step stable; the engine runs on them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from fdsolver.edges import EdgeCondition
from fdsolver.effects import build_force
from fdsolver.level import Level
from fdsolver.mass import FLOOR, SAFETY, invert, nodal_masses
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE
from fdsolver.problem import Problem
from fdsolver.relax import Settings, begin, relax
from fdsolver.result import Status
from tensionfield.relaxed import TENSION_FIELD
from tests.dense import frequencies
from tests.sample_meshes import small_meshes

LIMIT = 4.0  # of central differences with a unit time step
STRICT = 1.0 + 1e-6  # rounding of the differences behind the tangent
MESHES = small_meshes()
THIN, THICK = (Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=h) for h in (0.05, 5.0))
MODELS = {
    "e3, thin": (dataclasses.replace(KOITER, strain_gradient=False), THIN),
    "e3, thick": (dataclasses.replace(KOITER, strain_gradient=False), THICK),
    "moderate, thick": (dataclasses.replace(KOITER, moderate=True), THICK),
    "moderate tension field": (dataclasses.replace(TENSION_FIELD, moderate=True), THIN),
    "membrane in its plane": (dataclasses.replace(MEMBRANE, out_of_plane=False), THIN),
    "tension field in its plane": (dataclasses.replace(TENSION_FIELD, out_of_plane=False), THIN),
    "plate in its plane": (dataclasses.replace(KOITER, out_of_plane=False), THIN),
}


def states(mesh: str, components: int) -> dict[str, np.ndarray]:
    """Scaled positions (components, ni, nj)."""
    grid = MESHES[mesh]
    x, y = np.moveaxis(grid.u / grid.length_mm, 2, 0)
    cell = np.sqrt(grid.node_area) / grid.length_mm
    noise = cell * np.random.default_rng(1).standard_normal((3, grid.ni, grid.nj))
    fields = {
        "flat": np.stack([x, y, 0.0 * x]),
        "stretched": np.stack([1.1 * x, 1.05 * y, 0.0 * x]),
        "compressed": np.stack([1.1 * x, 0.8 * y, 0.0 * x]),
        "wrinkled": np.stack([1.1 * x, 0.9 * y, 0.05 * np.cos(20.0 * y)]) + 0.05 * noise,
        "far": np.stack([2.0 * x, 1.5 * y, 0.3 * x * y]) + 0.1 * noise,
    }
    return {name: np.ascontiguousarray(field[:components]) for name, field in fields.items()}


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("model", MODELS)
def test_no_frequency_exceeds_the_bound(model: str, mesh: str) -> None:
    law, sheet = MODELS[model]
    grid = MESHES[mesh]
    force = build_force(grid, sheet, law, {})
    free = np.ones((grid.ni, grid.nj), dtype=bool)
    for name, r in states(mesh, law.components).items():
        mass = nodal_masses(force, r, r, force.relaxed)
        assert frequencies(force, r, mass, free)[-1] <= LIMIT / SAFETY * STRICT, name


@pytest.mark.parametrize("model", MODELS)
def test_the_bound_is_not_wasteful(model: str) -> None:
    law, sheet = MODELS[model]
    force = build_force(MESHES["uniform"], sheet, law, {})
    r = states("uniform", law.components)["stretched"]
    mass = nodal_masses(force, r, r, force.relaxed)
    free = np.ones(r.shape[1:], dtype=bool)
    # the Gram matrix bound is reached by the checkerboard of a square zone; 0.9 but for the least stiffness FLOOR
    assert frequencies(force, r, mass, free)[-1] > (0.9 - FLOOR) * LIMIT / SAFETY


@pytest.mark.parametrize("mesh", ["uniform", "annulus", "hole"])
def test_planar_masses_are_inverted(mesh: str) -> None:
    law, sheet = MODELS["tension field in its plane"]
    force = build_force(MESHES[mesh], sheet, law, {})
    r = states(mesh, 2)["compressed"]
    xx, yy, xy = mass = nodal_masses(force, r, r, force.relaxed).reshape(3, -1)
    inverse = np.full_like(mass, np.nan)
    free = np.arange(mass.shape[1]) % 7 > 0
    invert(mass, free, inverse)
    # rounding times the condition of the mass, at most about 50
    np.testing.assert_allclose((xx * inverse[0] + xy * inverse[2])[free], 1.0, rtol=1e-13)
    np.testing.assert_allclose((xy * inverse[0] + yy * inverse[2])[free], 0.0, atol=1e-13)
    assert not inverse[:, ~free].any()


@pytest.mark.parametrize("damping", ["adaptive", "kinetic", "kinetic-published"])
@pytest.mark.parametrize(
    "model", ["membrane in its plane", "tension field in its plane", "plate in its plane"]
)
def test_a_planar_run_ends_where_the_run_in_space_ends(model: str, damping: str) -> None:
    """A pull in the plane, where nothing leaves the plane: two components find the same equilibrium as three."""
    law, sheet = MODELS[model]
    grid = MESHES["biased"]
    edges = {"left": EdgeCondition("pinned"), "right": EdgeCondition("pinned", (2.0, 0.0, 0.0))}
    problem = Problem(sheet, edges, grid, lambda nodes: grid, perturbation=0.0)
    ends = []
    for chosen in (law, dataclasses.replace(law, out_of_plane=True)):
        level = Level(problem, chosen, grid, 1)
        run = begin(level.start())
        status = relax(
            level.force, ~level.fixed, level.weight, run, Settings(tolerance=1e-11, damping=damping)
        )
        assert status is Status.CONVERGED
        ends.append(level.unscaled(run.r))
    # a residual of 1e-11 over a stiffness of one per cell, and as many cells as there are
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-8 * grid.length_mm)
