"""What both exact methods share: the sequence of bands, the solved annulus in scaled form, and its start."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tensionfield.annulus_energy import SLACK, Array
from tensionfield.annulus_problem import NoAnnulusSolution, ScaledAnnulus
from tensionfield.annulus_start import CoarseAnnulus, coarse_annulus

ELEMENTS = (160, 640)  # of the coarse equilibrium; the finer one where the coarser cannot resolve the fields
ELEMENT_TURN = 0.5  # radians over one element; more of it means a waist that the elements do not resolve
NARROWEST = 1e-9  # band, over the outer radius: the zero of a rounded function is not known more closely
SLACK_ENERGY = 1e-26  # strains below 1e-13 are rounding


@dataclass(frozen=True)
class ScaledSolution:
    """An exact solution in units of the outer radius and Young's modulus.

    switches : radii at which the state changes, in ascending order.
    states : state of each band from the inside, one more than `switches`.
    torque, axial : R r P_phi and R P_z of the radial stress vector P, both constant over the sheet.
    energy : integral of the energy density times R, without 2 pi.
    fields : radii (n,) -> (n, 3) deformed radius, turn and height.
    lines : radii (n,) -> (n, 4) line derivatives (`annulus_energy`).
    """

    switches: tuple[float, ...]
    states: tuple[int, ...]
    torque: float
    axial: float
    energy: float
    fields: Callable[[Array], Array]
    lines: Callable[[Array], Array]


def starts(problem: ScaledAnnulus) -> Iterator[CoarseAnnulus]:
    """Yield coarse equilibria from which an exact method can start, the cheaper one first.

    Raises NoAnnulusSolution if a zone is slack, because it can then take any of many shapes, and if the twist
    closes the sheet on its axis.
    """
    refusal = None
    for elements in ELEMENTS:
        coarse = coarse_annulus(problem, elements)
        refusal = _refusal(problem, coarse)
        if refusal is None:
            yield coarse
    if refusal is not None:
        raise NoAnnulusSolution(refusal)


def _refusal(problem: ScaledAnnulus, coarse: CoarseAnnulus) -> str | None:
    """Return why a coarse equilibrium has no exact one near it; None if it has."""
    if coarse.energy <= SLACK_ENERGY:
        return (
            "the whole annulus is slack or unloaded: its rims can meet without stress, "
            "and the shape of a slack sheet is not unique"
        )
    if problem.lift == problem.twist == 0.0 and (not coarse.at_rest or np.any(coarse.line[:, 0] <= 0.0)):
        return (
            "the flat annulus is pressed together in the radial direction until it is slack or folds over "
            "itself, and the shape of a slack sheet is not unique"
        )
    if not coarse.at_rest:
        return "no equilibrium of the annulus was found: the descent of its energy did not come to rest"
    slack = np.flatnonzero(coarse.state == SLACK)
    if slack.size:
        first, last = coarse.radius[slack[0]], coarse.radius[slack[-1] + 1]
        return (
            f"the annulus is slack between {first:.4g} and {last:.4g} outer radii, "
            "and the shape of a slack sheet is not unique"
        )
    if np.max(np.abs(np.diff(coarse.field[:, 1]))) > ELEMENT_TURN:
        return (
            f"the twist of {np.degrees(problem.twist):.6g} degrees closes the sheet on its axis, like a "
            "candy wrapper: a ring of the sheet collapses to a point, which carries no torque"
        )
    return None


def merged(
    states: Sequence[int], limits: Sequence[float], inner: float
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Return the states and limits without the bands that are narrower than rounding can tell."""
    edges = (inner, *limits, 1.0)
    kept = [i for i in range(len(states)) if edges[i + 1] - edges[i] > NARROWEST]
    kept = [i for n, i in enumerate(kept) if n == 0 or states[i] != states[kept[n - 1]]]
    return tuple(states[i] for i in kept), tuple(edges[i] for i in kept[1:])


def runs(states: NDArray[np.int64]) -> tuple[list[int], list[int]]:
    """Return the states of the runs of equal entries in `states` (n,), and where each next run starts."""
    changes = np.flatnonzero(np.diff(states)) + 1
    return [int(states[i]) for i in (0, *changes)], [int(i) for i in changes]
