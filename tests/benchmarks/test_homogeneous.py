"""Homogeneous states, whose answers are written down: every zone, the energy and the pull."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cases import load_scene, run

NODES = 2000
# residuals of one sign on the 63 nodes of a row add up to less than this many times one of them
ADDED_UP = 100.0


ADDING = "homogeneous: no discretisation error; residuals of one sign may add up along the sheet"
ACROSS = "as above, over the strain: across the tension only the tension itself resists"


def judge_uniform(verify, name, field, expected, limit, reason=ADDING):
    error = float(np.max(np.abs(field - expected)))
    verify.below(f"largest error of the {name}", error, limit=limit, reason=reason)


@pytest.mark.parametrize("method", ["tension-field", "membrane", "koiter"])
def test_strip_in_tension(verify, method):
    """Strip in homogeneous tension: stretch 1.1 by 1, its energy and its pull"""
    solution = run(
        load_scene("strip-tension"), method=method, nodes=NODES, out=verify.folder(f"strip-tension-{method}")
    )
    sheet, strain = solution.sheet, (1.1**2 - 1.0) / 2.0
    stiffness = sheet.young_MPa * sheet.thickness_mm
    limit = ADDED_UP * (1e-6 if method == "koiter" else 1e-8)
    verify.equal("status", solution.status.value, "converged", "the answer is known")
    judge_uniform(verify, "larger stretch", solution.zone.stretch_major, 1.1, limit)
    judge_uniform(verify, "smaller stretch", solution.zone.stretch_minor, 1.0, limit)
    energy = stiffness * 100.0 * 50.0 * strain**2 / 2.0
    verify.below(
        "relative error of the energy",
        abs(solution.energy_N_mm["total"] / energy - 1.0),
        limit=limit,
        reason="of second order in the error of the stretch, so far below the same limit",
    )
    pull = stiffness * 50.0 * 1.1 * strain
    verify.below(
        "relative error of the pull",
        abs(solution.reactions["right"].force_N[0] / pull - 1.0),
        limit=limit / strain,
        reason="the error of the strain over the strain",
    )


@pytest.mark.parametrize("method", ["tension-field", "membrane"])
def test_shear_between_rails(verify, method):
    """Hinged rails turned by 1 degree: pure shear, wrinkled everywhere where the membrane is relaxed"""
    solution = run(
        load_scene("shear-rails"), method=method, nodes=NODES, out=verify.folder(f"shear-rails-{method}")
    )
    sheet, angle = solution.sheet, math.radians(1.0)
    strain, limit = math.sin(angle) / 2.0, ADDED_UP * 1e-8
    relaxed = method == "tension-field"
    major = sheet.young_MPa * strain if relaxed else 2.0 * sheet.mu_MPa * strain
    verify.equal("status", solution.status.value, "converged", "the answer is known")
    judge_uniform(verify, "larger stretch", solution.zone.stretch_major, math.sqrt(1 + 2 * strain), limit)
    soft, why = (limit / strain, ACROSS) if relaxed else (limit, ADDING)
    judge_uniform(
        verify, "smaller stretch", solution.zone.stretch_minor, math.sqrt(1 - 2 * strain), soft, why
    )
    judge_uniform(
        verify,
        "major stress over Y",
        solution.zone.stress_major / sheet.young_MPa,
        major / sheet.young_MPa,
        limit,
    )
    minor = 0.0 if relaxed else -major
    judge_uniform(
        verify,
        "minor stress over Y",
        solution.zone.stress_minor / sheet.young_MPa,
        minor / sheet.young_MPa,
        limit,
    )
    verify.equal(
        "zones not wrinkled",
        int(np.count_nonzero(solution.zone.state != 1)),
        0,
        "pure shear wrinkles everywhere",
    )
    energy = sheet.young_MPa * sheet.thickness_mm * 100.0 * 50.0 * strain**2 / 2.0
    energy *= 1.0 if relaxed else 2.0 / (1.0 + sheet.poisson)
    verify.below(
        "relative error of the energy",
        abs(solution.energy_N_mm["total"] / energy - 1.0),
        limit=limit,
        reason="of second order in the error of the stretch, so far below the same limit",
    )
    total = sum(reaction.force_N for reaction in solution.reactions.values())
    verify.below(
        "sum of the forces of all rails over Y h width",
        float(np.linalg.norm(total)) / (sheet.young_MPa * sheet.thickness_mm * 100.0),
        limit=limit,
        reason="what the residuals of the free nodes may add up to",
    )
