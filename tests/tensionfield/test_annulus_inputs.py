"""What the exact annulus refuses, and how it says so."""

from __future__ import annotations

import math

import pytest

from tensionfield.annulus import NoAnnulusSolution, solve_annulus
from tensionfield.annulus_problem import AnnulusProblem
from tests.tensionfield.annulus_scenes import PAPER, annulus

METHODS = ("shooting", "collocation")

WRONG = [
    (
        {"inner_radius_mm": 0.0},
        "inner_radius_mm must be positive and below outer_radius_mm = 250.0, not 0.0",
    ),
    (
        {"inner_radius_mm": 300.0},
        "inner_radius_mm must be positive and below outer_radius_mm = 250.0, not 300.0",
    ),
    ({"outer_radius_mm": math.inf}, "outer_radius_mm must be finite, not inf"),
    ({"lift_mm": math.nan}, "lift_mm must be finite, not nan"),
    ({"poisson": 0.6}, "poisson must be above -1 and at most 0.5, not 0.6"),
    ({"young_MPa": -1.0}, "young_MPa must be positive and finite, not -1.0"),
    ({"thickness_mm": 0.0}, "thickness_mm must be positive and finite, not 0.0"),
    ({"inner_grow_mm": -62.5}, "inner_grow_mm must be above -62.5, not -62.5: the rim would close"),
    ({"outer_grow_mm": -260.0}, "outer_grow_mm must be above -250.0, not -260.0: the rim would close"),
]


@pytest.mark.parametrize(("change", "sentence"), WRONG)
def test_wrong_problems_are_named(change: dict[str, float], sentence: str) -> None:
    right = {
        "inner_radius_mm": 62.5,
        "outer_radius_mm": 250.0,
        "young_MPa": 3500.0,
        "poisson": 0.31,
        "thickness_mm": 0.025,
        "lift_mm": 125.0,
        "twist_deg": 90.0,
    }
    with pytest.raises(ValueError) as error:
        AnnulusProblem(**(right | change))
    assert str(error.value) == sentence


def test_wrong_requests_are_named() -> None:
    with pytest.raises(ValueError, match="method must be one of shooting, collocation, not 'guess'"):
        solve_annulus(PAPER, "guess")
    for tolerance in (0.0, 1e-15, 1.0, math.nan):
        with pytest.raises(ValueError, match="tolerance must lie between 1e-12 and 1e-06"):
            solve_annulus(PAPER, tolerance=tolerance)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("problem", "sentence"),
    [
        (annulus(), "slack or unloaded"),
        (annulus(grow=(0.0, -20.0)), "slack or unloaded"),
        (annulus(lift=25.0, twist=10.0, grow=(0.0, -40.0)), "slack"),
        (annulus(grow=(20.0, 0.0)), "pressed together in the radial direction"),
        (annulus(poisson=0.5, lift=125.0, twist=270.0), "closes the sheet on its axis"),
    ],
)
def test_annuli_without_a_unique_equilibrium_are_refused(
    problem: AnnulusProblem, sentence: str, method: str
) -> None:
    with pytest.raises(NoAnnulusSolution, match=sentence):
        solve_annulus(problem, method)


@pytest.mark.parametrize("method", METHODS)
def test_warnings_say_what_needs_care(method: str) -> None:
    (stretched,) = solve_annulus(annulus(lift=-300.0), method).warnings
    assert "passes sqrt(1 + 1/nu) = 2.056" in stretched
    (folded,) = solve_annulus(annulus(twist=90.0), method).warnings
    assert "folds over itself" in folded
