"""Where wrinkles appear: loads scaled, roots extrapolated over meshes, rows of the comparison, refusals."""

from __future__ import annotations

import importlib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cases import appearance, cross_check, load_scene, run
from cases.appearance import Appearance, by_modes, by_relaxation, loaded, worth_searching

ROOT, FACTOR = 0.277, 0.25  # multiples of the scene's load; of the made-up flat sheet and of its modes


def made_up_modes(factor: float = FACTOR) -> SimpleNamespace:
    return SimpleNamespace(
        method="buckling",
        critical=({"factor": factor, "strain": 0.1 * factor},),
        errors=({"discretisation": 0.004 * factor},),
    )


@pytest.fixture
def gives_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """An eigenvalue that changes its sign at ROOT, with a mesh error of second order."""
    monkeypatch.setattr(
        appearance, "_lowest_of", lambda scene, nodes: lambda load: ROOT * (1.0 - 300.0 / nodes) - load
    )


def test_every_part_of_the_load_is_scaled() -> None:
    scene = load_scene("annulus", {"edges.inner.grow_mm": -2.0})
    half = loaded(scene, 0.5).edges["inner"]
    assert half.move_mm == (0.0, 0.0, 62.5) and half.rotate_deg == 45.0 and half.grow_mm == -1.0
    assert loaded(scene, 1.0).edges == scene.edges


def test_the_modes_say_a_strain_with_the_relative_error_of_their_factor() -> None:
    assert by_modes(made_up_modes()) == Appearance(pytest.approx(0.025), pytest.approx(0.025 * 0.004))


@pytest.mark.parametrize(("factor", "worth"), [(2e-4, False), (0.25, True), (1.3, False)])
def test_only_a_load_somewhat_beyond_the_critical_one_is_searched(factor: float, worth: bool) -> None:
    assert worth_searching(made_up_modes(factor)) is worth


@pytest.mark.usefixtures("gives_way")
def test_relaxation_is_extrapolated_over_its_meshes() -> None:
    found = by_relaxation(load_scene("stretch"), FACTOR)
    # the roots are found to 1e-5, which the extrapolation doubles
    assert found.strain == pytest.approx(0.1 * ROOT, rel=1e-4)
    finest = 0.1 * ROOT * (1.0 - 300.0 / appearance.GRID_MESHES[-1])
    assert found.error == pytest.approx(1.25 * (0.1 * ROOT - finest), rel=0.01)


def test_a_flat_sheet_that_does_not_give_way_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(appearance, "_lowest_of", lambda scene, nodes: lambda load: 1.0 + load)
    with pytest.raises(ValueError, match=r"keeps its stability from 0.175 to 0.375 times the load"):
        by_relaxation(load_scene("stretch"), FACTOR)


@pytest.mark.usefixtures("gives_way")
def test_the_comparison_has_a_row_for_the_modes_and_one_for_the_flat_sheet(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(appearance, "by_elements", lambda scene, factor: Appearance(0.0277, 5e-5))
    scene = load_scene("stretch")
    modes, flat = cross_check.appearance_check(scene, made_up_modes())
    assert "linear modes" in modes["quantity"] and "finite strain" in flat["quantity"]
    for row, value in ((modes, 0.025), (flat, 0.0277)):
        assert row["method"] == "buckling" and row["reference"] == "koiter"
        assert row["value"] == pytest.approx(value)
        assert row["difference"] == pytest.approx(row["value"] - row["reference_value"])
        assert row["error"] > 0.0 and row["reference_error"] > 0.0
    assert cross_check.appearance_check(scene, made_up_modes(2e-4)) == []


def test_the_flat_plate_is_least_stable_where_both_methods_say_so() -> None:
    """On a coarse grid the eigenvalue is positive well before the strain of appearance and negative well after it."""
    lowest = appearance._lowest_of(load_scene("stretch"), 1500)
    assert np.sign([lowest(0.15), lowest(0.35)]).tolist() == [1.0, -1.0]


def test_why_the_appearance_was_not_found_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module("cases.compare")

    def refuse(scene: object, modes: object) -> None:
        raise ValueError("the flat state keeps its stability")

    monkeypatch.setattr(module, "appearance_check", refuse)
    assert module._appearance(load_scene("stretch"), made_up_modes()) == (
        [],
        "the flat state keeps its stability",
    )


def test_a_plate_read_from_its_folder_is_solved_again_for_its_errors() -> None:
    """A folder keeps the finest mesh alone; without coarser ones there is no estimate to set beside the elements'."""
    scene = load_scene("stretch")
    nested = run(scene, "koiter", nodes=5000)
    assert nested.coarser and cross_check._with_coarser(scene, nested) is nested
    again = cross_check._with_coarser(scene, replace(nested, coarser=()))
    assert again.coarser and again.grid.nodes == nested.grid.nodes
    assert again.energy_N_mm["total"] == pytest.approx(nested.energy_N_mm["total"], rel=1e-12)
