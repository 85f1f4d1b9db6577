"""The method buckling: result folders, reading back, what each factor says, what is refused."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest

from cases import load_result, load_scene, run
from cases.buckling import pair_numbers
from cases.finite_elements import default_vertices, movements_of, nominal_displacement_mm
from cases.methods import METHODS, MethodError, choose, methods_of, with_numbers
from cases.unstructured import FiniteElementMesh, FiniteElementSolution
from cases.unstructured_files import read_cells, write_cells
from cases.unstructured_probe import locate, sample_section, vertex_means
from fdsolver.result import Status
from tests.femref.rings import isotropic_factors

# a square panel of hinged rails, sheared: 9.325 pi^2 D / (b^2 h) is its classical stress
# so small a shear that turning and sliding the rails agree at the corners
SIDE, THICKNESS, YOUNG, POISSON, SHEAR_MM = 50.0, 0.1, 3500.0, 0.31, 5e-5
PANEL = f"""
[sheet]
width_mm = {SIDE}
height_mm = {SIDE}
thickness_mm = {THICKNESS}
[material]
young_MPa = {YOUNG}
poisson = {POISSON}
[edges.bottom]
support = "pinned"
[edges.top]
support = "pinned"
move_mm = [{SHEAR_MM}, 0.0, 0.0]
[edges.left]
support = "pinned"
rotate_deg = {-np.degrees(SHEAR_MM / SIDE)}
move_mm = [{SHEAR_MM / 2}, {-SHEAR_MM / 2}, 0.0]
[edges.right]
support = "pinned"
rotate_deg = {-np.degrees(SHEAR_MM / SIDE)}
move_mm = [{SHEAR_MM / 2}, {SHEAR_MM / 2}, 0.0]
"""


@pytest.fixture(scope="module", name="panel")
def _panel(tmp_path_factory: pytest.TempPathFactory) -> tuple[FiniteElementSolution, Path]:
    folder = tmp_path_factory.mktemp("buckling")
    (folder / "panel.toml").write_text(PANEL)
    solution = run(load_scene(folder / "panel.toml"), "buckling", nodes=400, out=folder / "out")
    assert isinstance(solution, FiniteElementSolution)
    return solution, folder


def test_the_factor_times_the_load_is_the_classical_shear(panel: tuple) -> None:
    solution, _ = panel
    first = solution.critical[0]
    stress = YOUNG / (2.0 * (1.0 + POISSON)) * SHEAR_MM / SIDE
    stiffness = YOUNG * THICKNESS**3 / (12.0 * (1.0 - POISSON**2))
    critical = 9.3245 * np.pi**2 * stiffness / (SIDE**2 * THICKNESS)
    # the table's last digit; quintics on 400 vertices are far better
    assert first["factor"] * stress == pytest.approx(critical, rel=1e-5)
    assert first["displacement_mm"] == pytest.approx(first["factor"] * nominal(panel), rel=1e-12)
    assert solution.status.value == "converged" and solution.stability["stable"] is (first["factor"] > 1.0)


def nominal(panel: tuple) -> float:
    return nominal_displacement_mm(load_scene(panel[1] / "panel.toml"))


def test_at_least_ten_positive_factors_ascend_with_their_parities(panel: tuple) -> None:
    solution, _ = panel
    factors = np.array([entry["factor"] for entry in solution.critical])
    assert len(factors) >= 10 and factors[0] > 0.0 and (np.diff(factors) >= 0.0).all()
    # a sheared square has no mirror image, only its half turn
    assert {entry["about"] for entry in solution.critical} == {"half_turn"}
    assert {entry["parity"] for entry in solution.critical} == {"symmetric", "antisymmetric"}
    assert solution.modes.shape == (len(factors), solution.grid.nodes)
    assert np.abs(solution.modes).max(axis=1) == pytest.approx(1.0)
    assert [entry["quantity"] for entry in solution.errors][0] == "buckling factor 1"


def test_plane_state_is_pure_shear_and_in_balance(panel: tuple) -> None:
    solution, _ = panel
    gamma = SHEAR_MM / SIDE
    assert solution.zone.stretch_major == pytest.approx(1.0 + gamma / 2.0, abs=1e-12)
    assert solution.zone.stretch_minor == pytest.approx(1.0 - gamma / 2.0, abs=1e-12)
    shear = YOUNG / (2.0 * (1.0 + POISSON)) * gamma
    assert solution.zone.stress_major == pytest.approx(shear, rel=1e-10)
    forces = np.sum([reaction.force_N for reaction in solution.reactions.values()], axis=0)
    moments = np.sum([reaction.moment_N_mm for reaction in solution.reactions.values()], axis=0)
    assert np.abs(forces).max() < 1e-9 * shear * SIDE * THICKNESS
    assert np.abs(moments).max() < 1e-9 * shear * SIDE**2 * THICKNESS
    energy = 0.5 * shear * gamma * SIDE**2 * THICKNESS
    assert solution.energy_N_mm["total"] == pytest.approx(energy, rel=1e-10)


def test_the_folder_reads_back_and_opens_elsewhere(panel: tuple) -> None:
    solution, folder = panel
    again = load_result(folder / "out")
    assert isinstance(again, FiniteElementSolution)
    for name in ("u", "cells"):
        assert np.array_equal(getattr(again.grid, name), getattr(solution.grid, name))
    assert again.r.tobytes() == solution.r.tobytes() and again.modes.tobytes() == solution.modes.tobytes()
    assert [dict(entry) for entry in again.critical] == [dict(entry) for entry in solution.critical]
    assert replace(again, r=solution.r).status is solution.status
    document = json.loads((folder / "out" / "result.json").read_text())
    assert document["buckling"]["critical"][0]["factor"] == solution.critical[0]["factor"]
    assert document["nodes"] == solution.grid.nodes and document["mesh"]["cells"] == "triangles"
    arrays = np.load(folder / "out" / "fields.npz")
    assert arrays["u"].shape == (document["nodes"], 2) and arrays["r"].shape == (document["nodes"], 3)
    vtu = meshio.read(folder / "out" / "sheet.vtu")
    assert vtu.cells[0].type == "triangle" and np.array_equal(vtu.cells[0].data, solution.grid.cells)
    assert np.allclose(vtu.point_data["mode_1"], solution.modes[0], rtol=0.0, atol=0.0)
    assert run(load_scene(folder / "panel.toml"), "buckling", nodes=400, out=folder / "out").seed == 0


def test_factors_beyond_the_tolerance_are_not_converged(panel: tuple) -> None:
    solution, folder = panel
    # what rounding leaves of the panel's factors lies between the usual tolerance and the smallest that may be asked
    assert 1e-14 < solution.residual < 1e-8 and solution.status is Status.CONVERGED
    strict = run(load_scene(folder / "panel.toml", {"solver.tolerance": 1e-14}), "buckling", nodes=400)
    assert strict.status is Status.STALLED and strict.residual == solution.residual


def test_a_resolved_scene_runs_again_on_as_many_vertices(panel: tuple) -> None:
    _, folder = panel
    scene = load_scene(folder / "out" / "scene.toml")
    assert scene.mesh.vertices == 400
    assert with_numbers(scene, METHODS["buckling"], None, None).mesh.vertices == 400


def test_finite_elements_have_a_node_count_of_their_own() -> None:
    scene = load_scene("stretch")
    resolved = with_numbers(scene, METHODS["buckling"], None, None)
    assert resolved.mesh.vertices == default_vertices(scene) and resolved.mesh.nodes == scene.mesh.nodes
    assert with_numbers(scene, METHODS["koiter"], 5000, None).mesh.vertices is None


@pytest.mark.parametrize(
    ("scene", "overrides", "sentence"),
    [
        ("annulus", [], "an edge of the scene annulus moves along z"),
        (
            "stretch",
            ["edges.top.move_mm=[0,0,0]"],
            "no supported edge of the scene stretch moves against another",
        ),
        ("stretch", ["start.from=mode:1"], "start.from"),
    ],
)
def test_what_cannot_buckle_is_refused(scene: str, overrides: list[str], sentence: str) -> None:
    loaded = load_scene(scene, overrides)
    with pytest.raises(MethodError, match=re.escape(sentence)):
        choose(loaded, "buckling")
    assert ("buckling" in methods_of(loaded)) is (sentence == "start.from")


def test_a_clamped_ring_of_ones_own_has_the_factor_of_bessel_functions(tmp_path: Path) -> None:
    """Both circles drawn in by the same strain e: isotropic compression N = Y h e / (1 - nu), in the linear theory."""
    inner, outer, strain = 25.0, 100.0, 1e-4
    scene = tmp_path / "ring.toml"
    scene.write_text(
        f"""
[sheet]
shape = "annulus"
inner_radius_mm = {inner}
outer_radius_mm = {outer}
thickness_mm = {THICKNESS}
[material]
young_MPa = {YOUNG}
poisson = {POISSON}
[edges.inner]
support = "clamped"
grow_mm = {-strain * inner}
[edges.outer]
support = "clamped"
grow_mm = {-strain * outer}
"""
    )
    solution = run(load_scene(scene), "buckling", nodes=600)
    stiffness = THICKNESS**2 / (12.0 * (1.0 - POISSON**2))
    exact = isotropic_factors(inner, outer, ("clamped", "clamped"), POISSON) * stiffness * (1.0 - POISSON)
    found = [entry["factor"] * strain for entry in solution.critical[:3]]
    assert found == pytest.approx(exact[:3], rel=7.5e-3)  # 50 straight facets to a circle
    assert [entry["pair"] for entry in solution.critical[:2]] == [1, 1]  # cosine and sine of the same waves
    error = solution.errors[0]["discretisation"] * strain
    assert error > abs(found[0] - exact[0])  # what the result says of its own error
    assert any("circles are polygons" in warning for warning in solution.warnings)


def test_a_sheet_that_is_only_pulled_is_refused_with_a_sentence() -> None:
    with pytest.raises(MethodError, match="nowhere compressed"):
        run(load_scene("strip-tension"), "buckling", nodes=400)


def test_movements_grow_then_turn_then_shift() -> None:
    changes = ["edges.inner.grow_mm=-2.5", "edges.inner.rotate_deg=30", "edges.inner.move_mm=[1,2,0]"]
    scene = load_scene("annulus-shrink", changes)
    point = np.array([[62.5], [0.0]])
    finite = movements_of(scene, finite=True)["inner"](point, 1.0)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    assert finite[:, 0] == pytest.approx([60.0 * c - 62.5 + 1.0, 60.0 * s + 2.0])
    small = movements_of(scene, finite=False)["inner"]
    # the linear movement is the derivative of the finite one at no load
    step = 1e-6
    slope = movements_of(scene, finite=True)["inner"](point, step) / step
    assert small(point, 1.0) == pytest.approx(slope, abs=1e-4)  # the second derivative times the step
    assert small(point, 3.0) == pytest.approx(3.0 * small(point, 1.0))


@pytest.mark.parametrize(
    ("factor", "wanted"),
    [
        ([1.0, 1.002, 2.0, 2.001, 2.002], [1, 1, 2, 2, None]),
        ([1.0, 1.5, 1.51, 3.0], [None, 1, 1, None]),
        ([1.0], [None]),
    ],
)
def test_near_degenerate_factors_are_pairs(factor: list[float], wanted: list[int | None]) -> None:
    assert pair_numbers(factor) == wanted


def square_mesh(cells: list[list[int]]) -> FiniteElementMesh:
    u = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    return FiniteElementMesh("rectangle", u, np.array(cells, dtype=np.int64))


@pytest.mark.parametrize(
    "cells", [[[0, 1, 2], [0, 2, 3]], [[0, 1, 2, 3]]], ids=["triangles", "quadrilaterals"]
)
def test_meshes_know_their_areas_and_interpolate_linear_fields(cells: list[list[int]]) -> None:
    mesh = square_mesh(cells)
    assert mesh.zone_area.sum() == pytest.approx(2.0) and mesh.node_area.sum() == pytest.approx(2.0)
    points = np.array([[0.5, 0.3], [1.9, 0.8], [3.0, 3.0], [0.2, 0.9]])
    found = locate(mesh, points)
    assert found.index.tolist() == [0, 1, 3]
    field = 3.0 + 2.0 * mesh.u[:, 0] - mesh.u[:, 1]
    assert found.interpolate(field) == pytest.approx(3.0 + 2.0 * points[[0, 1, 3], 0] - points[[0, 1, 3], 1])
    assert vertex_means(mesh, np.full(mesh.zones, 7.0)) == pytest.approx(7.0)


def test_sections_of_a_sloping_sheet() -> None:
    mesh = square_mesh([[0, 1, 2, 3]])
    r = np.column_stack([mesh.u, 0.1 * mesh.u[:, 0]])
    line = load_scene("stretch", ["sections.midsection.from_mm=[0,0.5]", "sections.midsection.to_mm=[2,0.5]"])
    section = sample_section(mesh, r, line.sections["midsection"])
    assert section.z == pytest.approx(0.1 * section.x, abs=1e-12) and section.s[-1] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("u", "cells", "sentence"),
    [
        (np.zeros((3, 3)), np.array([[0, 1, 2]]), "shape (n, 2)"),
        (np.full((3, 2), np.nan), np.array([[0, 1, 2]]), "finite"),
        (np.zeros((3, 2)), np.array([[0, 1]]), "(m, 3) or (m, 4)"),
        (np.zeros((3, 2)), np.array([[0, 1, 3]]), "outside 0 to 2"),
    ],
)
def test_wrong_meshes_are_refused(u: np.ndarray, cells: np.ndarray, sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)):
        FiniteElementMesh("rectangle", u, cells)


def test_damaged_fields_are_refused(panel: tuple, tmp_path: Path) -> None:
    solution, _ = panel
    write_cells(tmp_path / "fields.npz", replace(solution, r=solution.r[:-1]))
    with pytest.raises(ValueError, match="r has the shape"):
        read_cells(tmp_path / "fields.npz")
    write_cells(tmp_path / "fields.npz", replace(solution, modes=solution.modes[:, :-1]))
    with pytest.raises(ValueError, match="modes have the shape"):
        read_cells(tmp_path / "fields.npz")
