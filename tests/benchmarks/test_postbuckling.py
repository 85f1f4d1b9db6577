"""The wrinkled strip by finite elements: its own convergence, and agreement with the finite differences."""

from __future__ import annotations

import pytest

from cases import compare, load_scene, run
from cases.bicubic import sample_bicubic_section
from cases.energy_gained import energy_gained, flat_state
from cases.envelope import envelope
from cases.mesh_sequence import MeshLimit, mesh_limit
from cases.probe import Section, measure_section, sample_section

PULLS = {5: 12.7, 10: 25.4, 20: 50.8}  # per cent: mm
ELEMENTS = (4000, 7000, 12000)
DIFFERENCES = (7500, 15000, 30000, 60000)
UNITS = {
    "bending energy": "N mm",
    "energy gained by wrinkling": "N mm",
    "reaction": "N",
    "envelope": "mm",
    "rms": "mm",
    "wavelength": "mm",
}


def strip(percent: int):
    return load_scene(
        "stretch", {"edges.top.move_mm": [0.0, PULLS[percent], 0.0], "solver.max_seconds": 3600.0}
    )


def profile(section: Section, thickness_mm: float) -> dict[str, float]:
    measures = measure_section(section, thickness_mm)
    return {
        "envelope": float(envelope(section.z).max()),
        "rms": measures.rms_mm,
        "wavelength": measures.wavelength_mm or 0.0,
    }


def by_elements(verify, percent: int, vertices: int) -> tuple[int, dict[str, float]]:
    scene = strip(percent)
    folder = verify.folder(f"stretch-{percent}-postbuckling-{vertices}")
    solution = run(scene, "postbuckling", nodes=vertices, out=folder)
    verify.equal(
        f"status on {vertices} vertices", solution.status.value, "converged", "else nothing to judge"
    )
    verify.equal(
        f"stable on {vertices} vertices", solution.stability["stable"], True, "wrinkles, not a saddle"
    )
    verify.note(f"CPU seconds on {vertices} vertices", solution.cpu_seconds, "s")
    section = sample_bicubic_section(solution, scene.sections["midsection"])
    return solution.grid.zones, {
        "bending energy": solution.energy_N_mm["bending"],
        "energy gained by wrinkling": solution.energy_N_mm["gained"],
        "reaction": float(solution.reactions["top"].force_N[1]),
        **profile(section, scene.sheet.thickness_mm),
    }


def by_differences(verify, percent: int, nodes: int) -> tuple[int, dict[str, float]]:
    scene = strip(percent)
    solution = run(scene, "koiter", nodes=nodes, out=verify.folder(f"stretch-{percent}-koiter-{nodes}"))
    verify.equal(f"status on {nodes} nodes", solution.status.value, "converged", "else nothing to judge")
    section = sample_section(solution.grid, solution.r, scene.sections["midsection"])
    return solution.grid.zones, {
        "bending energy": solution.energy_N_mm["bending"],
        "energy gained by wrinkling": energy_gained(solution, flat_state(scene, nodes)),
        "reaction": float(solution.reactions["top"].force_N[1]),
        **profile(section, scene.sheet.thickness_mm),
    }


def limits(found: list[tuple[int, dict[str, float]]]) -> dict[str, MeshLimit]:
    zones = [count for count, _ in found]
    return {name: mesh_limit(zones, [values[name] for _, values in found]) for name in UNITS}


@pytest.mark.parametrize("percent", PULLS)
def test_both_methods_converge_to_the_same_wrinkles(verify, percent):
    """Pulled strip: wrinkles on three meshes of finite elements and four of finite differences"""
    elements = [by_elements(verify, percent, vertices) for vertices in ELEMENTS]
    differences = [by_differences(verify, percent, nodes) for nodes in DIFFERENCES]
    before, finest = elements[-2][1], elements[-1][1]
    for name in ("envelope", "rms"):
        verify.below(
            f"relative change of the {name} between the two finest meshes of elements",
            abs(finest[name] / before[name] - 1.0),
            limit=5e-3,
            reason="what the finite elements promise",
        )
    ours, theirs = limits(elements), limits(differences)
    for name, unit in UNITS.items():
        verify.note(f"{name} by finite elements", finest[name], unit)
        verify.note(f"{name} by finite elements, error", ours[name].error_of_finest, unit)
        verify.note(f"{name} by finite differences, limit", theirs[name].value, unit)
        verify.note(f"{name} by finite differences, error", theirs[name].band, unit)
        bars = ours[name].error_of_finest + theirs[name].band
        verify.below(
            f"{name}: difference of the methods over the sum of their error bars",
            abs(finest[name] - theirs[name].value) / bars,
            limit=1.0,
            reason="the same energy has one equilibrium",
        )


def test_lifted_annulus(verify):
    """Annulus lifted without a turn: finite elements against finite differences and the axisymmetric membrane"""
    scene = load_scene("annulus-lift")
    exact = run(scene, "exact", out=verify.folder("annulus-lift-exact"))
    found = run(scene, "postbuckling", nodes=1200, out=verify.folder("annulus-lift-postbuckling"))
    bending = []
    for nodes in (2500, 5000, 10000):
        solution = run(scene, "koiter", nodes=nodes, out=verify.folder(f"annulus-lift-koiter-{nodes}"))
        verify.equal(f"status on {nodes} nodes", solution.status.value, "converged", "else nothing to judge")
        bending.append((solution.grid.zones, solution.energy_N_mm["bending"]))
    verify.equal("status", found.status.value, "converged", "else nothing to judge")
    for name, value, wanted in (
        ("energy", found.energy_N_mm["total"], exact.energy_N_mm["total"]),
        (
            "pull of the inner circle",
            found.reactions["inner"].force_N[2],
            exact.reactions["inner"].force_N[2],
        ),
    ):
        verify.below(
            f"relative difference of the {name} from the axisymmetric membrane",
            abs(value / wanted - 1.0),
            limit=2e-6,
            reason="the strain of the Hermite arcs that stand for the circles; bending is 2e-8 of the energy",
        )
    limit = mesh_limit(*zip(*bending, strict=True))
    verify.note("bending energy by finite elements", found.energy_N_mm["bending"], "N mm")
    verify.note("bending energy by finite differences, limit", limit.value, "N mm")
    verify.below(
        "relative difference of the bending energies",
        abs(found.energy_N_mm["bending"] / limit.value - 1.0),
        limit=2e-3,
        reason="the finest finite-difference mesh is 1.4e-3 from the finite elements",
    )


def test_compare_holds_both_methods_against_each_other(verify):
    """Pulled strip by every method: `wrinkle compare`, its differences beside the error estimates of both methods"""
    found = compare(load_scene("stretch"), nodes=24000, out=verify.folder("stretch-compare"))
    verify.equal("methods that were refused", len(found.refused), 0, "all methods of the scene take part")
    rows = found.differences.dropna(subset=["error", "reference_error"])
    verify.above(
        "quantities with the error estimates of both methods", len(rows), limit=7, reason="the issue's"
    )
    for row in rows.to_dict("records"):
        bars = row["error"] + row["reference_error"]
        verify.note(f"{row['quantity']}: difference over the sum of both bars", abs(row["difference"]) / bars)
        if (
            "linear" not in row["quantity"]
        ):  # linear modes leave the finite strain of their own appearance out
            verify.below(
                f"{row['quantity']}: difference over the sum of both bars, as it must be",
                abs(row["difference"]) / bars,
                limit=1.0,
                reason="the same energy has one equilibrium",
            )
    envelopes = found.differences[found.differences.quantity.str.contains("envelope, relative L2")]
    verify.below(
        "envelope, relative L2 difference",
        float(envelopes.difference.max()),
        limit=0.05,
        reason="the finite differences' crest height is 2 % from its limit on this mesh, and their bar is as wide",
    )
