"""Would it pay to compute bending only where the tension field says that the sheet can wrinkle?"""

from __future__ import annotations

from typing import Any

from cases import load_scene
from cases.boundary import problem_of, settings_of
from fdsolver.fields import TENSE
from fdsolver.model import KOITER, MEMBRANE
from fdsolver.multilevel import solve
from fdsolver.result import Status
from tests.benchmarks.differences import differences, reported
from tests.benchmarks.effects_runs import MOST_DIFFERENT, node_steps, write_rows
from tests.benchmarks.record import Verification
from tests.benchmarks.restricted_bending import RESTRICTED, tense_zones
from tests.generated_code import operations_per_node

# nodes that resolve the wrinkles (6 each and more), and the residual the scenes are taken to
SCENES = {"stretch": (6000, 1e-8), "hole": (20_000, 1e-6)}
PAYS = 1.4  # times less that a run has to take, as where the out-of-plane component is left out


def test_bending_where_the_sheet_is_tense_is_not_left_out(verify: Verification) -> None:
    """Bending left out where the tension field is tense: what it could save, and what it changes

    It would be kept for the scenes on which it pays: the answer is the full one to a thousandth, as for every effect
    that a result calls justified, and the work is so much less that it is worth an effect of its own.
    """
    rows: list[dict[str, Any]] = []
    spared = 1.0 - operations_per_node(MEMBRANE) / operations_per_node(KOITER)
    for name, (nodes, tolerance) in SCENES.items():
        scene = load_scene(name, {"mesh.nodes": nodes})
        settings = settings_of(scene, tolerance)
        full = [solve(problem_of(scene, KOITER, seed), KOITER, settings) for seed in (0, 1)]
        part = solve(problem_of(scene, RESTRICTED, 0), RESTRICTED, settings)
        for each in (*full, part):
            verify.equal(f"{name}: status", each.status.value, Status.CONVERGED.value, "to be compared")
        problem = problem_of(scene, KOITER, 0)
        tense = float(tense_zones(problem, problem.grid).mean())
        found = differences(reported(part, scene), [reported(each, scene) for each in full], scene)
        quantity, difference = max(found.items(), key=lambda item: item[1])
        row = {
            "what": name,
            "nodes": part.grid.nodes,
            "tense": tense,
            "tense_plate": float((full[0].zone.state == TENSE).mean()),
            "most_saved": spared * tense,
            "steps": node_steps(part) / node_steps(full[0]),
            "cpu": part.cpu_seconds / full[0].cpu_seconds,
            "bending": part.energy_N_mm["bending"] / full[0].energy_N_mm["bending"] - 1.0,
            "largest": {"quantity": quantity, "difference": difference},
        }
        rows.append(row)
        less = 1.0 / ((1.0 - row["most_saved"]) * row["steps"])
        verify.note(f"{name}: share of the zones that is tense", tense)
        verify.note(f"{name}: operations of a step that it could save", row["most_saved"])
        verify.note(f"{name}: node-steps over those of the whole plate", row["steps"])
        if name == "hole":
            verify.note(f"{name}: difference, of {quantity}", difference)
            reason = "the ground on which it was dropped: the answer is kept, but the work is hardly less"
            verify.below(f"{name}: times less work at most", less, PAYS, reason)
        else:
            verify.note(f"{name}: times less work at most", less)
            verify.above(
                f"{name}: difference, of {quantity}",
                difference,
                MOST_DIFFERENT,
                "the ground on which it was dropped: wrinkles reach into what the tension field calls tense",
            )
    write_rows(verify.root, "restricted", rows)
