"""The sections of the pulled and of the sheared sheet, against what the made-up results were made of."""

from __future__ import annotations

import math
import re

import numpy as np
import pandas as pd
import pytest

from reports.content import Table, Text
from reports.figures_progress import snapshot_steps
from reports.loads import by_pull, by_shear, energy_gained, flat_partners, partner_key, pull_percent, wrinkled
from reports.phases import phase
from reports.plan import report_runs
from reports.plan_sheets import PULLS, SCAN_HALF_WAVELENGTHS_MM, SEEDS, SHEARS_MM
from reports.seed_words import seed_states, seed_words
from reports.shear_measures import measure_all, value_of
from reports.shear_tables import banded_text, series, to_believe
from reports.stored import Stored
from reports.strip_curves import crossings, curves, pull_table
from reports.strip_words import trend
from tests.reports.conftest import DRAWN_PULLS
from tests.reports.synthetic import FLAT_COSTS, SHEAR_AMPLITUDE, SHEAR_HALF_WAVE, WAVE_NUMBER


def part(results, scene, name):
    return [s for s in results.values() if s.run.scene == scene and s.run.part == name]


def section(report, anchor):
    return next(s for s in report.sections if s.anchor == anchor)


def table_of(report, anchor, words) -> Table:
    tables = [
        b for b in section(report, anchor).blocks if isinstance(b, Table) and b.caption.startswith(words)
    ]
    assert len(tables) == 1
    return tables[0]


@pytest.fixture(scope="module")
def found(results):
    return curves(by_pull(part(results, "stretch", "sweep")), flat_partners(part(results, "stretch", "flat")))


def test_every_pull_has_three_meshes_in_both_reports():
    for full in (False, True):
        runs = [run for run in report_runs(full) if run.part == "sweep"]
        for percent in PULLS:
            meshes = {run.nodes(full) for run in runs if run.name.startswith(f"stretch-pull-{percent:g}-")}
            assert len(meshes) >= 3


def test_full_report_has_the_node_counts_of_the_paper():
    runs = report_runs(True)
    nodes = {run.name: run.nodes_full for run in runs}
    finest = {
        p: [r.nodes_full for r in runs if r.name.startswith(f"stretch-pull-{p}-")] for p in (5, 10, 20, 30)
    }
    shown = {p: max(n or 0 for n in counts) for p, counts in finest.items()}
    assert shown == {5: 60_000, 10: 60_000, 20: 120_000, 30: 120_000}
    assert nodes["shear-3-0-12000"] == nodes["shear-0.5-0-12000"] == 80_000
    assert nodes["stretch-progress"] == 60_000


def test_shear_is_run_at_every_load_and_from_three_seeds():
    runs = [run for run in report_runs() if run.scene == "shear" and run.method != "buckling"]
    for move in SHEARS_MM:
        for rise in (0.0, 0.05):
            mine = [run for run in runs if run.overrides["edges.top.move_mm"] == [move, rise, 0.0]]
            assert mine
            if move > 0.1:
                assert {run.seed for run in mine} == {0, 1, 2}


def test_pull_of_a_run_is_that_of_its_scene(results):
    assert pull_percent(results["stretch-koiter"]) == 10.0
    assert pull_percent(results["stretch-pull-2.5-6000"]) == 2.5


def test_measures_of_the_strip_are_those_it_was_made_of(found):
    k = list(found.pulls).index(10.0)
    amplitude = 0.3 * (1.0 - (0.025 / 0.105) ** 2)
    # the envelope exp(-(x/25)^2) and the samples leave the crest a few per mille low
    assert found.curves["amplitude"][k].value == pytest.approx(amplitude, rel=0.01)
    assert found.curves["wavelength"][k].finest == pytest.approx(2.0 * np.pi / WAVE_NUMBER, rel=0.05)
    assert found.curves["gained"][k].finest == pytest.approx(FLAT_COSTS, rel=1e-9)


def test_flat_pull_has_neither_wavelength_nor_half_waves(found):
    for pull in (2.0, 30.0):
        k = list(found.pulls).index(pull)
        assert not wrinkled(found.finest(pull))
        assert math.isnan(found.curves["wavelength"][k].finest)
        assert math.isnan(found.curves["half_waves"][k].finest)


def test_trend_names_peak_and_brackets(found):
    text = trend(found).text
    assert "the crest height is greatest at 10 %" in text
    assert "nothing at 30 %" in text
    # of the pulls that have results, the made-up wrinkles are there from 4 to 20 %
    nodes = [f"{n:,}".replace(",", "\u2009") for n in sorted(s.value("nodes") for s in found.runs[10.0])]
    assert all(f"between 2 and 4 % on {n.removesuffix('.0')} nodes" in text for n in nodes)
    assert all(f"between 20 and 30 % on {n.removesuffix('.0')} nodes" in text for n in nodes)
    assert "At 30 % the flat state is the answer" in text


def test_trend_without_results_says_so(results):
    groups = by_pull(s for s in part(results, "stretch", "sweep") if pull_percent(s) not in DRAWN_PULLS)
    assert "nothing can be said" in trend(curves(groups, {})).text


def test_pull_table_has_a_row_for_every_pull_and_marks_missing_runs(found):
    rows = {row[0]: row for row in pull_table(found).rows}
    assert list(rows) == [f"{p:g}" for p in PULLS]
    assert "0 of 3" in rows["7"]
    assert set(rows["7"][1:7]) == {"–"}
    assert "3 of 3" in rows["10"]
    assert "±" in rows["10"][1]


def test_energy_gained_needs_the_flat_state_of_the_same_mesh(results):
    coarse, fine = results["stretch-pull-10-3000"], results["stretch-pull-10-6000"]
    flat = flat_partners(part(results, "stretch", "flat"))
    assert energy_gained(coarse, flat[partner_key(coarse)]) == pytest.approx(FLAT_COSTS, rel=1e-9)
    assert math.isnan(energy_gained(coarse, flat[partner_key(fine)]))
    assert math.isnan(energy_gained(coarse, None))


def test_snapshots_stand_at_their_steps_over_all_meshes(results):
    # the second mesh's steps follow the last of the first, 580
    np.testing.assert_array_equal(snapshot_steps(results["stretch-progress"]), [0, 100, 400, 600, 880, 1160])


@pytest.mark.parametrize("angle", [0.0, 37.0, 90.0, 145.0, 213.0, 300.0])
def test_phase_of_a_profile_is_found(angle):
    x = np.linspace(-50.8, 50.8, 2001)
    found = phase(x, 0.3 * np.cos(0.6 * x + np.radians(angle)) * np.exp(-((x / 25.0) ** 2)))
    away = (found.angle_deg - angle + 180.0) % 360.0 - 180.0
    # the two parts of a finite train of waves are equally large to a few per mille only
    assert abs(away) < 0.2
    assert found.rms_mm == pytest.approx(
        0.3 / np.sqrt(2.0) * np.sqrt(np.sqrt(np.pi / 2.0) * 25.0 / 101.6), rel=0.01
    )


def test_phases_all_round_are_one_orbit(results):
    states = seed_states(part(results, "stretch", "seeds"))
    assert len(states) == len(SEEDS) == 10
    text = seed_words(states).text
    assert "there are not two families" in text


def test_two_phases_alone_are_no_orbit(results):
    states = seed_states(part(results, "stretch", "seeds"))
    states["phase_deg"] = [0.0, 90.0] * 5
    assert "do not tell" in seed_words(states).text


def test_no_converged_seed_is_said():
    assert "nothing can be said" in seed_words(pd.DataFrame()).text


def test_seed_table_keeps_the_place_of_a_missing_result(results):
    from reports.seed_words import seed_table

    seeds = [*part(results, "stretch", "seeds"), results["stretch-membrane"]]
    rows = seed_table(seeds, seed_states(seeds)).rows
    assert rows[-1][1] == "not run"
    assert set(rows[-1][2:]) == {"–"}


def test_measures_of_the_sheared_sheet_are_those_it_was_made_of(results):
    found = measure_all([results["shear-0.5-0-12000"]])["shear-0.5-0-12000"]
    assert found.crest_deg == pytest.approx(
        45.0, abs=0.5
    )  # zones see slopes by differences over a tenth of a wave
    assert found.half_wavelength_mm == pytest.approx(SHEAR_HALF_WAVE, rel=0.03)  # four waves in the window
    assert found.middle_amplitude_mm == pytest.approx(SHEAR_AMPLITUDE, rel=0.01)
    assert found.fan_maximum_mm == pytest.approx(2.0 * SHEAR_AMPLITUDE, rel=0.01)
    waves = 380.0 / (SHEAR_HALF_WAVE * np.sqrt(2.0))
    assert abs(found.zero_crossings - waves) <= 1.0


def test_run_without_result_has_no_measures(results):
    missing = results["stretch-membrane"]
    assert measure_all([missing]) == {}
    assert math.isnan(value_of({}, missing, "fan_maximum_mm", 0.025))


def test_flat_sheared_sheet_is_called_flat(report, results):
    words = next(
        b for b in section(report, "shear").blocks if isinstance(b, Text) and b.items and "caption" in b.text
    )
    assert "stays flat" in next(item for item in words.items if "pre-stretch of 0.05 mm" in item)
    assert "wrinkles" in next(item for item in words.items if "no pre-stretch" in item)
    run = results["shear-0.05-0.05-6000"]
    assert math.isnan(value_of(measure_all([run]), run, "crest_deg", 0.025))


def test_sizes_stand_beside_their_estimate(report):
    table = table_of(report, "shear", "Wrinkles of the sheared sheet")
    row = next(r for r in table.rows if r[0] == "0.5 + 0")
    # by hand: sqrt(pi 128 0.025 / sqrt(3 (1 - 0.31^2) 0.5 / 128)) = 9.88 mm
    # and 9.88 / pi sqrt(2 0.69 0.5 / 128) = 0.231 mm
    assert (row[2], row[4]) == ("9.88", "0.231")
    assert re.fullmatch(r"1[56]\.\d; 1[56]\.\d (±|to) .+", row[1])


def test_a_measure_without_a_limit_has_its_range_over_meshes_and_starts(results):
    meshes = by_shear(part(results, "shear", "mesh"))[(3.0, 0.0)]
    seeds = by_shear(part(results, "shear", "seeds"))[(3.0, 0.0)]
    assert len(meshes) == 3 and len(seeds) == 2 and all(s.converged for s in (*meshes, *seeds))
    values = dict(zip([s.run.name for s in (*meshes, *seeds)], (5.0, 7.0, 6.0, 4.0, 6.5), strict=True))

    def wandering(run: Stored) -> float:
        return values[run.run.name]

    found = to_believe(meshes, seeds, wandering)
    assert found is not None and (found.finest, found.low, found.high, found.has_limit) == (
        6.0,
        4.0,
        7.0,
        False,
    )
    assert banded_text(meshes, seeds, wandering) == "6.00; 4.00 to 7.00"
    assert banded_text(meshes, seeds, wandering, 0) == "6; 4 to 7"
    drawn = series((3.0, 0.0), meshes, seeds, wandering)
    assert drawn is not None and (drawn.low, drawn.high) == (4.0, 7.0)
    assert list(drawn.meshes[:, 1]) == [5.0, 7.0, 6.0] and list(drawn.starts[:, 1]) == [4.0, 6.5]

    def second_order(run: Stored) -> float:
        return 2.0 + 300.0 / run.value("nodes") + (0.1 if run.run.part == "seeds" else 0.0)

    limit = to_believe(meshes, seeds, second_order)
    assert limit is not None and limit.has_limit
    # Roache's 1.25 times the distance of the finest mesh, and half of the starts' range
    half = 1.25 * (limit.finest - 2.0) + 0.05
    assert (limit.low, limit.high) == pytest.approx((2.0 - half, 2.0 + half), rel=1e-6)
    assert re.fullmatch(r"2\.\d+; 2\.00 ± 0\.\d+", banded_text(meshes, seeds, second_order))
    assert to_believe(meshes, seeds, lambda _: math.nan) is None and banded_text([], [], wandering) == "–"


def test_all_runs_of_the_sheared_sheet_are_listed(report, results):
    rows = table_of(report, "shear", "Runs of the sheared sheet").rows
    shown = [s for s in results.values() if not (s.run.kept_flat or s.finite_elements)]
    assert len(rows) == sum(s.run.scene == "shear" for s in shown)


def test_loads_are_grouped_from_coarse_to_fine(results):
    groups = by_shear(part(results, "shear", "mesh"))
    assert list(groups) == [(0.05, 0.0), (0.05, 0.05), (0.5, 0.0), (0.5, 0.05), (3.0, 0.0), (3.0, 0.05)]
    nodes = [s.value("nodes") for s in groups[(0.5, 0.0)]]
    assert nodes == sorted(nodes)


def test_eigenvalue_passes_zero_where_a_line_does():
    pulls, lowest = np.array([1.0, 2.0, 4.0, 8.0]), np.array([0.1, -0.3, -0.2, 0.2])
    assert crossings(pulls, lowest) == [(pytest.approx(1.25), True), (pytest.approx(6.0), False)]
    assert crossings(pulls, np.abs(lowest)) == []


def test_imposed_waves_stand_beside_random_starts_of_their_mesh(report):
    drawing = next(b for b in section(report, "shear").blocks if getattr(b, "name", "") == "shear-scan")
    shown = drawing.draw.keywords
    assert list(shown["imposed"]) == list(SCAN_HALF_WAVELENGTHS_MM)
    assert len(shown["seeds"]) == 3
    assert min(shown["energy"].min(), shown["seeds"][:, 1].min()) == 0.0


def test_plates_of_both_scenes_keep_their_whole_energy():
    runs = [r for r in report_runs(True, ["stretch", "shear"]) if r.method == "koiter"]
    assert runs
    assert all(run.overrides["effects.out_of_plane"] == "on" for run in runs)
