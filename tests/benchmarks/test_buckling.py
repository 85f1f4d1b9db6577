"""Buckling of the flat sheets by finite elements: factors on meshes and with elements, and where the flat is stable."""

from __future__ import annotations

import numpy as np
import pytest

from cases import load_scene, run
from cases.buckling import FACTORS
from cases.flat_stability import along_the_load, over_aspect_ratios, window_of
from cases.unstructured import FiniteElementSolution

MESHES = (700, 1400, 2800)
ELEMENTS = {"argyris": MESHES, "bogner-fox-schmit": (2800, 5600)}
STRAINS = (0.02, 0.03, 0.05, 0.07, 0.1, 0.13, 0.16, 0.18, 0.2, 0.22, 0.25)
# of the map, on which a point takes 12 s: five curves, with the strain of the largest compression among their points
ASPECTS = (1.0, 1.5, 2.0, 2.5, 4.0)
MAP_STRAINS = (0.03, 0.05, 0.1, 0.15, 0.2, 0.22)
AGREE = 5e-3  # what the project asks of two elements


def buckle(verify, scene: str, nodes: int, element: str = "argyris") -> FiniteElementSolution:
    folder = verify.folder(f"{scene}-buckling-{element}-{nodes}")
    solution = run(load_scene(scene, {"solver.element": element}), method="buckling", nodes=nodes, out=folder)
    assert isinstance(solution, FiniteElementSolution)
    verify.equal(
        f"status, {element}, {nodes}", solution.status.value, "converged", "else no factors to judge"
    )
    level = solution.levels[-1]
    verify.note(f"unknowns, {element}, {nodes}", level["unknowns"])
    for part, seconds in dict(level["seconds"]).items():
        verify.note(f"{part}, {element}, {nodes}", seconds, "s")
    verify.note(f"entries of the factors, {element}, {nodes}", level["factor_entries"])
    return solution


def factors(solution: FiniteElementSolution, parity: str | None = None) -> np.ndarray:
    """Factors of the modes of one parity, all without one."""
    return np.array([e["factor"] for e in solution.critical if parity in (None, e["parity"])])


def test_first_ten_factors_of_the_pulled_strip(verify):
    """Stretch: the first ten buckling factors, symmetric and antisymmetric, on three meshes and with two elements"""
    found = {
        (element, nodes): buckle(verify, "stretch", nodes, element)
        for element, counts in ELEMENTS.items()
        for nodes in counts
    }
    finest = {element: found[element, counts[-1]] for element, counts in ELEMENTS.items()}
    coarser = {element: found[element, counts[-2]] for element, counts in ELEMENTS.items()}
    for parity in ("symmetric", "antisymmetric"):
        best = {element: factors(solution, parity) for element, solution in finest.items()}
        before = {element: factors(solution, parity) for element, solution in coarser.items()}
        count = min(len(values) for values in (*best.values(), *before.values()))
        verify.equal(
            f"{parity} modes among the first {FACTORS}", len(best["argyris"]), 5, "pairs of either parity"
        )
        for k in range(count):
            value = best["argyris"][k]
            verify.note(f"{parity} factor {k + 1}", value)
            verify.below(
                f"{parity} factor {k + 1}, two elements, relative difference",
                abs(best["bogner-fox-schmit"][k] / value - 1.0),
                limit=AGREE,
                reason="two elements on their finest meshes",
            )
            verify.below(
                f"{parity} factor {k + 1}, two finest meshes, relative difference",
                abs(before["argyris"][k] / value - 1.0),
                limit=AGREE,
                reason="twice the vertices; the conforming quintics change less with every mesh",
            )
    for nodes in MESHES:
        verify.note(f"first factor, argyris, {nodes}", factors(found["argyris", nodes])[0])


@pytest.mark.parametrize(("scene", "meshes"), [("shear", (3000, 6000)), ("hole", (2000, 4000))])
def test_first_factors_of_shear_and_hole(verify, scene, meshes):
    """Shear and hole: the first ten buckling factors on two meshes; the loads are thousands of times critical"""
    coarse, fine = (factors(buckle(verify, scene, nodes)) for nodes in meshes)
    for k in range(FACTORS):
        verify.note(f"factor {k + 1}", fine[k])
        verify.below(
            f"factor {k + 1}, relative change from {meshes[0]} vertices",
            abs(coarse[k] / fine[k] - 1.0),
            limit=1e-2,
            reason="one per cent places the load; what it must settle is its order",
        )
    verify.note("the scene's load over the critical one", 1.0 / fine[0])
    verify.above(
        "the scene's load over the critical one",
        1.0 / fine[0],
        limit=100.0,
        reason="linear modes then say when wrinkles appear, not how they look",
    )


def test_window_of_the_pulled_strip(verify):
    """Stretch: strains at which the flat, finitely strained strip becomes unstable and stable again, on three meshes"""
    found = window_of(load_scene("stretch"), MESHES, [(0.025, 0.03), (0.2, 0.22)])
    verify.note("appearance", found.appearance, "strain")
    verify.note("disappearance", found.disappearance, "strain")
    verify.below(
        "appearance, change from the next coarser mesh",
        found.appearance_error,
        limit=1e-4,
        reason="four digits: half a unit of the third in per cent",
    )
    verify.below(
        "disappearance, change from the next coarser mesh",
        found.disappearance_error,
        limit=1e-3,
        reason="compression dies out there: the same error of the stress moves the strain ten times as far",
    )
    table = along_the_load(load_scene("stretch"), STRAINS, MESHES[0])
    table.to_csv(verify.root / "stretch-flat-stability.csv", index=False)
    unstable = dict(zip(table.strain, table.unstable, strict=True))
    verify.equal("unstable modes at 2 %", unstable[0.02], 0, "below the appearance")
    verify.above("unstable modes at 10 %", unstable[0.1], limit=2, reason="both parities have grown")
    verify.equal("unstable modes at 25 %", unstable[0.25], 0, "beyond the disappearance")


def test_map_over_thickness_and_aspect_ratio(verify):
    """Stretch: the least thickness at which the flat strip is stable, over strain and aspect ratio, on two meshes"""
    scene = load_scene("stretch")
    coarse, fine = (over_aspect_ratios(scene, ASPECTS, MAP_STRAINS, vertices) for vertices in MESHES[:2])
    fine["error_mm"] = (fine.neutral_thickness_mm - coarse.neutral_thickness_mm).abs()
    fine.to_csv(verify.root / "stretch-stability-map.csv", index=False)
    # beyond 20 % the compression dies out and the curve falls steeply: its bars are drawn, up to a tenth of the value
    high = (fine.neutral_thickness_mm > 0.03) & (fine.strain <= 0.2)
    verify.below(
        "neutral thickness above 0.03 mm up to 20 %, largest change from 700 vertices",
        float((fine.error_mm / fine.neutral_thickness_mm)[high].max()),
        limit=0.05,
        reason="a map is read to a few per cent; thinner sheets have shorter waves than these meshes carry",
    )
    square = fine[fine.aspect == 1.0].neutral_thickness_mm.max()
    strip = fine[fine.aspect == 2.5].neutral_thickness_mm.max()
    verify.note("largest neutral thickness, aspect ratio 1", square, "mm")
    verify.note("largest neutral thickness, aspect ratio 2.5", strip, "mm")
    verify.above(
        "that of 2.5 over that of 1",
        strip / max(square, 1e-9),
        limit=1.0,
        reason="Friedl et al. (2000): short sheets hardly wrinkle",
    )
