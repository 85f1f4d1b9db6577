"""Work and precision: what accuracy costs, for the four scenes of the paper and six verification problems."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cases.cost import cost
from cases.cost_plan import Extent

RINGS = (1000, 2000, 4000, 8000, 16_000)
WAVES = (4000, 8000, 16_000, 32_000)  # below, the meshes do not hold the wrinkles
EVEN = (500, 1000, 2000, 4000)  # homogeneous: every mesh has the answer
SECONDS = 60.0  # of one run: what takes longer is drawn as such
# scene -> meshes, and whether other dampings, masses and so on are measured too
PLANS = {
    "strip-tension": (EVEN, False),
    "shear-rails": (EVEN, False),
    "annulus": (RINGS, True),
    "annulus-lift": (RINGS, False),
    "annulus-twist": (RINGS, False),
    "annulus-shrink": (RINGS, False),
    str(Path(__file__).parent / "scenes" / "small-hub.toml"): (RINGS, False),
    "stretch": (WAVES, True),
    "hole": (RINGS, False),
    "shear": (WAVES, False),
}


@pytest.mark.parametrize("source", PLANS, ids=lambda source: Path(source).stem)
def test_what_accuracy_costs(verify, source):
    """Error against time, by every method and mesh, with the cheapest way to 1 %"""
    meshes, options = PLANS[source]
    out = verify.root.parent / f"{Path(source).stem}-cost"  # where the report looks for it
    found = cost(source, out, extent=Extent(meshes, options, repeats=2, max_seconds=SECONDS), say=print)
    verify.note("runs", len(found.rows))
    verify.note("runs that converged", sum(one.converged for one in found.rows))
    verify.equal(
        "runs without a named end",
        sum(one.status in ("failed", "missing") for one in found.rows),
        0,
        "a run that ends without an answer has to say why",
    )
    known = {reference.quantity for reference in found.references}
    verify.above("quantities with a reference", len(known), 3, "energy and the loads, at least")
    for sentence in found.sentences:
        verify.note("cheapest", sentence)
    ways = [s for s in found.sentences if "in energy_N_mm.total" in s and float(s.split(" %")[0]) <= 1.0]
    verify.above("ways to 1 % in the energy", len(ways), 1, "else no mesh was fine enough")
    stored = json.loads((out / "cost.json").read_text(encoding="utf-8"))
    verify.equal(
        "sentences in the report's file",
        len(stored["sentences"]),
        len(found.sentences),
        "it is read from there",
    )
