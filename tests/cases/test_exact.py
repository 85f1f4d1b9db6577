"""The exact method: homogeneous states by hand, the annulus against the discrete operators on its own
positions.
"""

from __future__ import annotations

import numpy as np
import pytest

from cases import load_scene, run
from cases.exact import has_exact, homogeneous_map
from cases.lattice import zone_centres
from cases.methods import MethodError
from cases.schema import Scene
from fdsolver.fields import zone_fields
from fdsolver.result import Solution

Y, H = 3500.0, 0.025


def exact(scene: Scene, nodes: int = 1000) -> Solution:
    return run(scene, method="exact", nodes=nodes)


def test_a_strip_without_lateral_contraction() -> None:
    """poisson = 0: stretch 1.1 by 1, pull Y h 50 l (l^2 - 1) / 2, energy Y h 100 50 E^2 / 2."""
    found = exact(load_scene("strip-tension"))
    strain = (1.1**2 - 1.0) / 2.0
    pull = Y * H * 50.0 * 1.1 * strain
    # Everything here is a few products: a few roundings.
    assert found.reactions["right"].force_N == pytest.approx([pull, 0.0, 0.0], rel=1e-13, abs=1e-11)
    assert found.reactions["left"].force_N == pytest.approx([-pull, 0.0, 0.0], rel=1e-13, abs=1e-11)
    assert set(found.reactions) == {"left", "right"}
    assert found.energy_N_mm["total"] == pytest.approx(Y * H * 5000.0 * strain**2 / 2.0, rel=1e-12)
    assert found.zone.stretch_major == pytest.approx(1.1, rel=1e-13)
    assert found.zone.stretch_minor == pytest.approx(1.0, rel=1e-13)
    assert found.zone.stress_major == pytest.approx(Y * strain, rel=1e-12)
    assert found.r[..., 0] == pytest.approx(1.1 * found.grid.u[..., 0] + 5.0, abs=1e-12)


def test_the_picture_frame_of_four_hinged_rails() -> None:
    """F = [[1, sin a], [0, cos a]]: E1 = sin(a) / 2 = -E2, wrinkled at 45 degrees everywhere."""
    found = exact(load_scene("shear-rails"))
    a = np.radians(1.0)
    strain = np.sin(a) / 2.0
    # The scene gives 16 digits of displacements of 1 mm in 100 mm: 13 digits of a strain of 1e-2.
    assert found.zone.stretch_major == pytest.approx(np.sqrt(1.0 + 2.0 * strain), rel=1e-13)
    assert found.zone.stress_major == pytest.approx(Y * strain, rel=1e-11)
    assert found.zone.stress_minor == pytest.approx(0.0, abs=1e-10)
    assert (found.zone.state == 1).all()
    assert found.energy_N_mm["total"] == pytest.approx(Y * H * 5000.0 * strain**2 / 2.0, rel=1e-11)
    force = Y * H * 100.0 * strain / 2.0 * np.array([1.0 + np.sin(a), np.cos(a), 0.0])
    assert found.reactions["top"].force_N == pytest.approx(force, rel=1e-11, abs=1e-9)
    assert found.reactions["bottom"].force_N == pytest.approx(-force, rel=1e-11, abs=1e-9)
    # the top rail's middle, (0, 25), goes to these places
    x, y = np.array(load_scene("shear-rails").edges["top"].move_mm[:2]) + (0.0, 25.0)
    assert found.reactions["top"].moment_N_mm[2] == pytest.approx(x * force[1] - y * force[0], rel=1e-11)
    total = sum(reaction.force_N for reaction in found.reactions.values())
    moment = sum(reaction.moment_N_mm for reaction in found.reactions.values())
    # Rounding of forces of 50 N and moments of 1000 N mm.
    assert np.abs(total).max() < 1e-11
    assert np.abs(moment).max() < 1e-9


def test_a_rigid_motion_in_space_is_a_homogeneous_state_without_force() -> None:
    edge = {"support": "pinned", "move_mm": [1.0, 2.0, 3.0], "rotate_deg": 30.0}
    scene = load_scene("strip-tension", {"edges.left": edge, "edges.right": edge})
    found = exact(scene)
    # 1e-12 of stresses that a strain of one would cause, over 50 mm.
    assert all(np.abs(reaction.force_N).max() < 1e-11 * Y for reaction in found.reactions.values())
    turn = np.radians(30.0)
    x, y = found.grid.u[..., 0], found.grid.u[..., 1]
    assert found.r[..., 0] == pytest.approx(x * np.cos(turn) - y * np.sin(turn) + 1.0, abs=1e-12)
    assert found.r[..., 2] == pytest.approx(3.0, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "overrides"),
    [
        ("hole", {}),
        ("stretch", {}),
        ("shear", {}),
        # with lateral contraction the free edges draw in
        ("strip-tension", {"material.poisson": 0.3}),
        # one end turned: no affine map
        ("strip-tension", {"edges.right.rotate_deg": 5.0}),
        # a single edge leaves the sheet undetermined
        ("strip-tension", {"edges.right.support": "free", "edges.right.move_mm": [0, 0, 0]}),
        ("annulus", {"edges.outer.support": "free"}),
        ("annulus", {"edges.inner.move_mm": [1.0, 0.0, 125.0]}),
    ],
)
def test_scenes_without_a_closed_form_are_refused(name: str, overrides: dict) -> None:
    scene = load_scene(name, overrides)
    assert not has_exact(scene)
    with pytest.raises(MethodError, match="has no closed form"):
        exact(scene)


def test_a_strip_pushed_together_carries_nothing() -> None:
    """Slack, or on the border to it: its width neither stretches nor shrinks."""
    scene = load_scene("strip-tension", {"edges.right.move_mm": [-1.0, 0.0, 0.0]})
    assert homogeneous_map(scene) is not None
    found = exact(scene)
    # A rounding of the strain, times Young's modulus.
    assert np.abs(found.zone.stress_major).max() < 1e-14 * Y
    assert np.ptp(found.zone.state) == 0
    assert found.zone.stretch_minor == pytest.approx(0.99, rel=1e-13)
    assert found.energy_N_mm["total"] == pytest.approx(0.0, abs=1e-9)


ANNULUS = {
    "paper": ("annulus", {}),
    "shrunk": ("annulus-shrink", {}),
    "all at once": (
        "annulus",
        {
            "edges.inner.move_mm": [3.0, -2.0, 50.0],
            "edges.inner.rotate_deg": 40.0,
            "edges.inner.grow_mm": 1.0,
            "edges.outer.move_mm": [3.0, -2.0, -20.0],
            "edges.outer.rotate_deg": -15.0,
            "edges.outer.grow_mm": 2.0,
        },
    ),
}


@pytest.mark.parametrize("case", ANNULUS)
def test_the_annulus_obeys_its_edges_and_its_own_strains(case: str) -> None:
    """The zone fields agree to second order with the strains of the node positions on two meshes."""
    name, overrides = ANNULUS[case]
    scene = load_scene(name, overrides)
    errors = []
    for nodes in (1000, 16000):
        found = exact(scene, nodes)
        for edge, column in (("inner", 0), ("outer", -1)):
            condition = scene.edges[edge]
            u = found.grid.u[:, column]
            radius, turn = np.linalg.norm(u, axis=-1), np.radians(condition.rotate_deg)
            x, y = np.moveaxis(u * (1.0 + condition.grow_mm / radius)[:, None], -1, 0)
            expected = np.stack(
                [
                    x * np.cos(turn) - y * np.sin(turn),
                    x * np.sin(turn) + y * np.cos(turn),
                    np.zeros_like(x),
                ],
                axis=-1,
            ) + np.array(condition.move_mm)
            # The boundary-value problem is solved to 1e-11 of the outer radius.
            assert np.abs(found.r[:, column] - expected).max() < 1e-8
        discrete = zone_fields(found.grid, found.sheet, found.r, relaxed=True)
        errors.append(
            [
                float(np.median(np.abs(getattr(discrete, field) - getattr(found.zone, field))))
                for field in ("stretch_major", "stretch_minor", "stress_major")
            ]
        )
    # The median, as strains have kinks where the state changes. Second order divides by 16, a wrong place or
    # sign leaves the error as it is.
    assert (np.array(errors[1]) < np.array(errors[0]) / 10.0).all()


def test_the_annulus_is_in_balance_about_any_axis() -> None:
    found = exact(load_scene(*ANNULUS["all at once"]))
    inner, outer = found.reactions["inner"], found.reactions["outer"]
    assert inner.force_N == pytest.approx(-outer.force_N, rel=1e-12)
    assert inner.moment_N_mm == pytest.approx(-outer.moment_N_mm, rel=1e-12)
    axial = inner.force_N[2]
    assert axial > 0.0
    assert inner.moment_N_mm[:2] == pytest.approx([-2.0 * axial, -3.0 * axial], rel=1e-12)


def test_reactions_are_the_slope_of_the_energy() -> None:
    """Lift and turn of the inner circle, by central differences."""
    found = exact(load_scene("annulus"))

    def energy(lift: float, turn: float) -> float:
        overrides = {"edges.inner.move_mm": [0.0, 0.0, lift], "edges.inner.rotate_deg": turn}
        return exact(load_scene("annulus", overrides)).energy_N_mm["total"]

    step_mm, step_deg = 0.1, 0.1
    force = (energy(125.0 + step_mm, 90.0) - energy(125.0 - step_mm, 90.0)) / (2.0 * step_mm)
    torque = (energy(125.0, 90.0 + step_deg) - energy(125.0, 90.0 - step_deg)) / (2.0 * np.radians(step_deg))
    # Third derivatives over steps of a thousandth of the load: 1e-6.
    assert found.reactions["inner"].force_N[2] == pytest.approx(force, rel=2e-6)
    assert found.reactions["inner"].moment_N_mm[2] == pytest.approx(torque, rel=2e-6)


def test_the_zone_fields_are_those_of_the_zone_centres() -> None:
    """Rings of one state and stretch each, at the radius that paths/radius.csv gives."""
    found = exact(load_scene("annulus"), 4000)
    assert np.ptp(found.zone.stretch_major, axis=0).max() == 0.0
    radius = np.linalg.norm(zone_centres(found.grid), axis=-1).mean(axis=0)
    state = found.zone.state[0]
    # The band of the paper's annulus, tense beside both rims.
    assert state[0] == state[-1] == 2
    assert set(state[(radius > 80.0) & (radius < 120.0)]) == {1}
    assert found.stability["stable"] is True
