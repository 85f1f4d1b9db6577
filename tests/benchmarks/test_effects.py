"""The energy of wrinkles, foretold by the audit and found by the plate; two kinematics of one strip."""

from __future__ import annotations

import pytest

from cases import load_scene, run
from cases.effects import JUSTIFIED
from cases.results import read_document

NODES = 4000
SCENES = ("stretch", "shear", "hole", "shear-rails", "annulus-lift", "strip-tension")
ALL_ON = {"effects.out_of_plane": "on"}
ORDER = (
    "a scaling law of far wrinkles, whose ends and corners it does not know: right to the order of magnitude"
)


def solved(verify, name: str, method: str, folder: str, **changes: object):
    """The solution of a scene and its effects in result.json."""
    out = verify.folder(folder)
    solution = run(load_scene(name, {"mesh.nodes": NODES, **changes}), method=method, out=out, force=True)
    return solution, read_document(out)["effects"]


@pytest.mark.parametrize("name", SCENES)
def test_bending_left_out_is_judged_as_the_plate_judges_it(verify, name: str) -> None:
    """Energy that bending adds: foretold on the tension field, and found by the plate"""
    field, effects = solved(verify, name, "tension-field", f"effects-{name}-tension-field")
    plate, _ = solved(verify, name, "koiter", f"effects-{name}-koiter", **ALL_ON)
    found = plate.energy_N_mm["total"] / field.energy_N_mm["total"] - 1.0
    foretold = effects["bending"]["size"]
    verify.note(f"{name}: share of the energy foretold", foretold)
    verify.note(f"{name}: share of the energy found", found)
    verify.note(
        f"{name}: CPU seconds of the plate over the tension field", plate.cpu_seconds / field.cpu_seconds
    )
    if effects["bending"]["justified"] == JUSTIFIED:
        verify.below(f"{name}: justified", abs(found), limit=1e-3, reason="what justified means")
    else:
        verify.above(f"{name}: share found over foretold", found / foretold, 0.3, reason=ORDER)
        verify.below(f"{name}: share found over foretold", found / foretold, 10.0, reason=ORDER)


@pytest.mark.parametrize("percent", [2, 5, 10, 20, 30, 40])
def test_where_finite_strains_and_moderate_rotations_part(verify, percent: int) -> None:
    """A strip pulled by 2 to 40 %, by Green's strain and by that of Foeppl and von Karman"""
    ends = {}
    for kinematics in ("finite", "moderate"):
        changes = {"edges.top.move_mm": [0.0, 2.54 * percent, 0.0], "effects.kinematics": kinematics}
        solution, _ = solved(verify, "stretch", "koiter", f"effects-{kinematics}-{percent}", **changes)
        height = float(abs(solution.r[..., 2]).max())
        ends[kinematics] = (height, float(solution.reactions["top"].force_N[1]))
        verify.note(f"{kinematics}, {percent} %: largest height", height, "mm")
        verify.note(f"{kinematics}, {percent} %: force", ends[kinematics][1], "N")
    # Green's strain e + e^2/2 on the stretch 1 + e: the force of a bar is (1 + 3 e / 2 + e^2 / 2) times the linear one
    pull = percent / 100.0
    expected = 1.0 + 1.5 * pull + 0.5 * pull**2
    verify.within(
        f"{percent} %: force of finite strains over moderate rotations",
        ends["finite"][1] / ends["moderate"][1],
        0.94 * expected,
        1.06 * expected,
        reason="a bar without clamped ends, which are a tenth of the strip and hold its width",
    )
    if percent >= 30:
        verify.below(
            f"{percent} %: finite height", ends["finite"][0], 0.01, "wrinkles are gone (Zheng 2009)", "mm"
        )
        verify.above(
            f"{percent} %: moderate height", ends["moderate"][0], 0.1, "wrinkles go on growing", "mm"
        )
