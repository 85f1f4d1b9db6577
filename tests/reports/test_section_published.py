"""The section of the published scheme, against what the made-up results were made of."""

from __future__ import annotations

import json

from reports.section_published import healthy, mesh_key
from reports.stored import Stored
from tests.reports.test_wrinkle_sections import table_of


def test_published_scheme_is_compared_on_the_same_mesh(report, results):
    rows = table_of(report, "published", "The published scheme").rows
    assert len(rows) == sum(s.method == "koiter-published" for s in results.values())
    row = next(r for r in rows if r[:3] == ("filtered", "10", rows[0][2]))
    # made of the same formula on the same mesh
    assert row[8] == row[9]
    assert row[10] == "0"


def test_long_cells_are_compared_with_long_cells(results):
    run = results["published-filtered-long-cells"]
    assert mesh_key(run) == mesh_key(results["published-partner-long-cells"])
    assert mesh_key(run) != mesh_key(results["published-filtered-10-6000"])
    high = results["published-filtered-square-cells"]
    assert mesh_key(high) == mesh_key(results["published-partner-square-cells"])
    assert mesh_key(high) != mesh_key(results["published-filtered-20-6000"])


def test_checkerboard_is_not_healthy_even_if_converged(results, tmp_path):
    run = results["published-filtered-10-6000"]
    assert healthy(run)
    document = dict(run.result) | {"hourglass": {"out_of_plane": 0.9, "in_plane": None}}
    (tmp_path / "result.json").write_text(json.dumps(document), encoding="utf-8")
    assert not healthy(Stored(run.run, tmp_path))
