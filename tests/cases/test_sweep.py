"""Sweeps of a load: a column that buckles, tables with known windows, critical loads against Euler's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cases.sweep import STRETCH, Sweep, Window, critical_load, sweep, window

LENGTH, THICKNESS = 20.0, 0.2
CRITICAL = (np.pi / LENGTH) ** 2 * THICKNESS**2 / 12.0  # Euler's strain of a column pinned at both ends


@pytest.fixture
def column(tmp_path: Path) -> Sweep:
    """A strip without lateral contraction, shortened by multiples of Euler's strain."""
    path = tmp_path / "column.toml"
    path.write_text(
        f"""
        [sheet]
        shape = "rectangle"
        width_mm = {LENGTH}
        height_mm = 8.0
        thickness_mm = {THICKNESS}
        [material]
        young_MPa = 3500.0
        poisson = 0.0
        [edges.left]
        support = "pinned"
        [edges.right]
        support = "pinned"
        """,
        encoding="utf-8",
    )

    def shorten(multiple: float) -> dict[str, object]:
        return {"edges.right.move_mm": [-multiple * CRITICAL * LENGTH, 0.0, 0.0], "solver.tolerance": 1e-10}

    return Sweep(str(path), "shortening", "times Euler's", (0.8, 0.95, 1.2, 1.5), shorten, 1000)


def test_a_column_buckles_between_two_loads_and_both_answers_agree(column: Sweep, tmp_path: Path) -> None:
    seen: list[float] = []
    table = sweep(column, tmp_path / "runs", seen.append)
    assert seen == list(table["shortening"]) == [0.8, 0.95, 1.2, 1.5]
    assert list(table["status"]) == ["converged"] * 4
    assert list(table["wrinkled"]) == [False, False, True, True]
    assert list(table["flat_stable"]) == [True, True, False, False]
    assert window(table, "shortening") == Window((0.95, 1.2), None)
    wrinkled = table[table["wrinkled"]]
    # an arch: one half-wave over the length of 20 mm, of height 2 L / pi sqrt(e - e_c)
    height = 2.0 * LENGTH / np.pi * np.sqrt((wrinkled["shortening"] - 1.0) * CRITICAL)
    # the discrete column buckles at a load lower by 1e-3, which counts five times at 1.2
    np.testing.assert_allclose(wrinkled["amplitude_mm"], height, rtol=2e-2)
    assert list(wrinkled["half_waves"]) == [1, 1]
    assert (wrinkled["gained_N_mm"] > 0.0).all()
    assert sorted(path.name for path in (tmp_path / "runs").iterdir()) == [
        f"shortening-{value:g}" for value in (0.8, 0.95, 1.2, 1.5)
    ]


def test_the_critical_load_is_eulers(column: Sweep) -> None:
    # second order in about 50 zones: (pi / 50)^2 / 4 = 1e-3; and the accuracy asked for
    assert critical_load(column, 0.5, 2.0, accuracy=1e-3) == pytest.approx(1.0, abs=4e-3)
    with pytest.raises(ValueError, match="keeps its stability from 0.2 to 0.6"):
        critical_load(column, 0.2, 0.6)


@pytest.mark.parametrize(
    ("wrinkled", "expected"),
    [
        ([0, 1, 1, 0, 0], Window((1.0, 2.0), (3.0, 4.0))),
        ([0, 0, 1, 1, 1], Window((2.0, 3.0), None)),
        ([1, 1, 0, 0, 0], Window(None, (2.0, 3.0))),
        ([0, 0, 0, 0, 0], Window(None, None)),
        ([1, 1, 1, 1, 1], Window(None, None)),
    ],
)
def test_windows_of_tables(wrinkled: list[int], expected: Window) -> None:
    table = pd.DataFrame({"pull": [1.0, 2.0, 3.0, 4.0, 5.0], "wrinkled": np.array(wrinkled, dtype=bool)})
    assert window(table, "pull") == expected


@pytest.mark.parametrize("wrinkled", [[0, 1, 0, 1, 0], [1, 0, 0, 1, 1]])
def test_two_ranges_of_wrinkles_are_no_window(wrinkled: list[int]) -> None:
    table = pd.DataFrame({"pull": [1.0, 2.0, 3.0, 4.0, 5.0], "wrinkled": np.array(wrinkled, dtype=bool)})
    with pytest.raises(ValueError, match="more than one range"):
        window(table, "pull")


def test_the_strip_s_sweep_covers_the_papers_pulls() -> None:
    assert {5.0, 10.0, 20.0, 30.0} <= set(STRETCH.values)
    assert (STRETCH.values[0], STRETCH.values[-1]) == (2.0, 30.0)
    assert list(STRETCH.values) == sorted(STRETCH.values)
    scene = STRETCH.at(10.0)
    assert scene.edges["top"].move_mm == (0.0, 25.4, 0.0)
    assert scene.mesh.nodes == STRETCH.nodes


def test_no_remnant_of_waves_passes_for_wrinkles() -> None:
    """At 2.5 % the flat strip is stable on this mesh, unstable on the coarser one that the run comes from."""

    def loose(percent: float) -> dict[str, object]:
        return {**STRETCH.overrides(percent), "solver.tolerance": 1e-7}

    table = sweep(Sweep("stretch", "pull", "%", (2.5,), loose, 7500))
    row = table.iloc[0]
    assert row["amplitude_mm"] < 0.01 * 0.1
    assert row["flat_stable"] and not row["wrinkled"]
    assert row["half_waves"] == 0 and np.isnan(row["mean_wavelength_mm"])
