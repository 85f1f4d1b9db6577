"""One mesh of a run of the published scheme: the sheet's nodes and, around them, its ghosts."""

from __future__ import annotations

import functools
from dataclasses import dataclass, fields

import numpy as np

from fdsolver.effects import Force
from fdsolver.fields import hourglass_share
from fdsolver.grid import Grid
from fdsolver.level import Level
from fdsolver.membrane import StVenantKirchhoff
from fdsolver.model import Model
from fdsolver.problem import Problem
from fdsolver.published_force import build_published
from fdsolver.result import Status
from fdsolver.verdict import LEFT_OVER, MOST_HOURGLASS

EDGES = ("left", "right", "bottom", "top")
NAMED = 0.03  # zigzag of the ghost rows, in spacings, named as the cause of a failed run; right wrinkles leave 0.026
GROWING = (
    0.1  # hourglass share; right wrinkles on coarse meshes have 0.06, and what the scheme does not see grows
)
CARRIES = "The result carries a checkerboard of the mesh beside its wrinkles."
BLIND = (
    "Its share is {:.2g}, and the published scheme does not see it: under (-1)^(i+j) neither zone gradients nor"
    " curvatures change."
)
ROUGH = (
    "The ghost rows of the edges {} zigzag from node to node: the update (74) of the published scheme lets their short"
    " waves grow without bound."
)


@dataclass(frozen=True)
class WithoutGhosts(Force):
    """The force of the conservative plate, `plain`, on states that carry ghosts, on which it has none.

    The published force is no gradient, so no eigenvalue of its tangent decides stability; this one's does.
    """

    plain: Force

    def __call__(self, r: np.ndarray, f: np.ndarray) -> np.ndarray:
        """As `effects.Force`, for r, f : (3, ni + 2, nj + 2)."""
        inner = np.zeros_like(r[:, 1:-1, 1:-1])
        energy = self.plain(np.ascontiguousarray(r[:, 1:-1, 1:-1]), inner)
        f[:] = 0.0
        f[:, 1:-1, 1:-1] = inner
        return energy


class PublishedLevel(Level):
    """A `Level` whose states (3, ni + 2, nj + 2) carry the ghost layer.

    force : the published scheme. fixed : (ni + 2, nj + 2) bool, supported nodes and ghosts. weight : 0 there.
    examined : the conservative plate, `WithoutGhosts`. plain : the level of that plate, without ghosts.

    Raises GridError for meshes that are not rectangles, ValueError for an unknown variant.
    """

    def __init__(self, problem: Problem, model: Model, grid: Grid, threads: int, variant: str) -> None:
        super().__init__(problem, model, grid, threads)
        self.plain = Level(problem, model, grid, threads)
        supports = {name: condition.support for name, condition in problem.edges.items()}
        self.published = build_published(grid, problem.sheet, supports, self.plain.force, variant)
        self.force = self.published
        inherited = {field.name: getattr(self.published, field.name) for field in fields(Force)}
        self.examined = WithoutGhosts(
            **(inherited | {"zone": self.published.geometry}), plain=self.plain.force
        )
        self.fixed = np.pad(self.plain.fixed, 1, constant_values=True)
        self.weight = np.pad(self.plain.weight, 1)

    def scaled(self, r: np.ndarray) -> np.ndarray:
        """Positions (ni, nj, 3) in mm as the engine's, with ghosts that continue the sheet straight on."""
        return self.with_ghosts(self.plain.scaled(r))

    def with_ghosts(self, r: np.ndarray) -> np.ndarray:
        """The sheet's nodes (3, ni, nj), scaled, with ghosts that continue it straight on."""
        state = np.pad(r, ((0, 0), (1, 1), (1, 1)))
        self.published.ghosts.place(state)
        return state

    def unscaled(self, r: np.ndarray) -> np.ndarray:
        """The sheet's nodes of an engine's state, (ni, nj, 3) in mm."""
        return self.plain.unscaled(r[:, 1:-1, 1:-1])

    def start(self) -> np.ndarray:
        """As `Level.start`, with ghosts."""
        return self.with_ghosts(self.plain.start())

    def start_from(self, coarse: Level, r: np.ndarray) -> np.ndarray:
        """As `Level.start_from`, with ghosts."""
        return self.with_ghosts(self.plain.start_from(coarse, r))

    def verdict(self, status: Status, r: np.ndarray) -> tuple[Status, str]:
        """The status with the cause where it lies in the scheme: ghost rows, or a checkerboard, even a small one."""
        share = hourglass_share(self.grid, self.unscaled(r))["out_of_plane"] or 0.0
        height = np.ptp(r[2]) * self.grid.length_mm / self.problem.sheet.thickness_mm
        if (
            status is Status.CONVERGED
            and share > GROWING
            and not self.published.stabilised
            and height > LEFT_OVER
        ):
            status = Status.HOURGLASS
        if status is Status.HOURGLASS:
            start = status.sentence if share > MOST_HOURGLASS else CARRIES
            return status, f"{start} {BLIND.format(share)}"
        rough = dict(zip(EDGES, self.published.ghosts.roughness(r), strict=True))
        named = [name for name, zigzag in rough.items() if not zigzag < NAMED]
        if status is Status.CONVERGED or not named:
            return status, status.sentence
        return status, f"{status.sentence} {ROUGH.format(', '.join(named))}"


def published_model(variant: str) -> Model:
    """The published scheme as a model of the engine. variant : a name of `published_force.VARIANTS`."""
    level = functools.partial(PublishedLevel, variant=variant)
    return Model("koiter-published", StVenantKirchhoff, bending=True, buckles=True, level=level)
