"""The energy that buckling gains, against Euler's column; and states that cannot be compared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cases import Scene, load_scene, run
from cases.energy_gained import NotComparable, energy_gained, flat_state
from fdsolver.result import Solution, Status

YOUNG, THICKNESS, LENGTH, WIDTH = 3500.0, 0.2, 20.0, 8.0
CRITICAL = (np.pi / LENGTH) ** 2 * THICKNESS**2 / 12.0  # Euler's strain of a column pinned at both ends


def column(folder: Path, strains: float) -> Scene:
    """A plate strip without lateral contraction, shortened by this many critical strains."""
    path = folder / "column.toml"
    path.write_text(
        f"""
        [sheet]
        shape = "rectangle"
        width_mm = {LENGTH}
        height_mm = {WIDTH}
        thickness_mm = {THICKNESS}
        [material]
        young_MPa = {YOUNG}
        poisson = 0.0
        [edges.left]
        support = "pinned"
        [edges.right]
        support = "pinned"
        move_mm = [{-strains * CRITICAL * LENGTH}, 0.0, 0.0]
        [mesh]
        nodes = 1600
        [solver]
        tolerance = 1e-9
        """,
        encoding="utf-8",
    )
    return load_scene(path)


@pytest.fixture(scope="module")
def shortened(tmp_path_factory: pytest.TempPathFactory) -> tuple[Scene, Solution, Solution]:
    """The scene at twice the critical strain, its arch, and its flat state."""
    scene = column(tmp_path_factory.mktemp("column"), 2.0)
    return scene, run(scene, method="koiter"), flat_state(scene)


def test_the_energy_gained_by_an_euler_column(shortened: tuple[Scene, Solution, Solution]) -> None:
    """Beyond the critical strain e_c the force stays at Y h e_c, so the gain is Y h (e - e_c)^2 / 2 per area."""
    _, arch, flat = shortened
    expected = 0.5 * YOUNG * THICKNESS * CRITICAL**2 * LENGTH * WIDTH
    # second order in 63 zones along the column, (pi / 63)^2 / 4 of the critical load, which counts twice; and the
    # rise of the force beyond it, of the order of the strain, 1e-4
    assert energy_gained(arch, flat) == pytest.approx(expected, rel=5e-3)


def test_the_flat_state_is_flat_planar_and_examined(shortened: tuple[Scene, Solution, Solution]) -> None:
    _, arch, flat = shortened
    assert flat.status is Status.CONVERGED
    assert not flat.r[..., 2].any()
    assert flat.stability["stable"] is False and flat.stability["lowest"] < 0.0
    strain = 2.0 * CRITICAL
    assert flat.energy_N_mm["total"] == pytest.approx(
        0.5 * YOUNG * THICKNESS * strain**2 * LENGTH * WIDTH, rel=1e-3
    )
    assert np.abs(arch.r[..., 2]).max() > THICKNESS / 2.0


def test_below_the_critical_strain_nothing_is_gained(tmp_path: Path) -> None:
    scene = column(tmp_path, 0.5)
    flat = flat_state(scene)
    assert flat.stability["stable"] is True
    gained = energy_gained(run(scene, method="koiter"), flat)
    # both are the flat state, to the square of the residual
    assert abs(gained) < 1e-6 * flat.energy_N_mm["total"]


def test_states_that_cannot_be_compared_are_refused(shortened: tuple[Scene, Solution, Solution]) -> None:
    scene, arch, flat = shortened
    with pytest.raises(NotComparable, match="wrinkled state is not converged but step_limit"):
        energy_gained(replace(arch, status=Status.STEP_LIMIT), flat)
    with pytest.raises(NotComparable, match="flat state is not converged but diverged"):
        energy_gained(arch, replace(flat, status=Status.DIVERGED))
    with pytest.raises(NotComparable, match="different meshes"):
        energy_gained(arch, flat_state(scene, nodes=900))
    with pytest.raises(NotComparable, match="is not flat"):
        energy_gained(arch, arch)
    with pytest.raises(NotComparable, match="different sheets"):
        energy_gained(arch, replace(flat, sheet=replace(flat.sheet, poisson=0.1)))
