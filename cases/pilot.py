"""A pilot run: the planned model on two coarse meshes, whose steps foretell those on the fine ones.

On a mesh that starts from the next coarser one's state the steps grow with the nodes along the sheet, that is with the
square root of the nodes, and somewhat less where the coarse state is already good. How many they are at all depends on
the wrinkles, on slack and on the tolerance, and is not known without a run. The pilot's coarse mesh is the coarsest of
the run itself: there a sheet that folds over can need many times the steps that it needs on a mesh a little coarser.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from cases.boundary import grid_of, problem_of, settings_of, symmetry_of
from cases.schema import Scene
from cases.survey import loads_in_plane
from fdsolver.finish import MOST_RELAXED
from fdsolver.model import Model
from fdsolver.multilevel import level_nodes, solve
from fdsolver.problem import Problem
from fdsolver.result import Status

NODES = 5000  # of the pilot's fine mesh, at least
OVER_COARSE = 2  # nodes of its fine mesh over those of its coarse one, at least
MOST_STEPS = 100_000
MOST_SECONDS = 20.0
# Steps per node along the sheet, over those on a mesh with a quarter of the nodes: plates 0.6 to 1.1, relaxed
# membranes 0.7 to 1.2 on meshes from 5 000 to 80 000 nodes.
FINER = 0.8
# CPU seconds per node that the tangent of a flat state and its lowest eigenvalue take (1 000 to 20 000 nodes)
EXAMINED = 2e-5


@dataclass(frozen=True)
class Pilot:
    """What a pilot run took. levels : (nodes, steps, other force evaluations) of its meshes, coarsest first.

    finished : whether it converged. node_seconds, examined : CPU seconds that one step of one node and the examination
    of one node should have taken; cpu_seconds : those of the whole run, which say how fast the machine is just now.
    dimensions : 2, or 1 of a ray of nodes.
    """

    levels: tuple[tuple[int, int, int], ...]
    finished: bool
    node_seconds: float
    examined: float
    cpu_seconds: float
    dimensions: int = 2

    def steps(self, counts: Sequence[int]) -> list[float]:
        """Steps to expect on nested meshes of these node counts, coarsest first."""
        found = []
        for k, count in enumerate(counts):
            nodes, steps, _ = self._like(k)
            along = (count / nodes) ** (1.0 / self.dimensions)
            found.append(steps * along * FINER ** math.log2(max(along, 1.0)))
        return found

    def seconds(self, counts: Sequence[int]) -> float:
        """CPU seconds to expect: the pilot's own, in proportion to the work."""
        others = [self._like(k)[2] for k in range(len(counts))]
        work = self._work(counts, self.steps(counts), others)
        nodes, steps, other = zip(*self.levels, strict=True)
        tried = self._work(nodes, steps, other)
        return self.cpu_seconds * (work / tried if tried > 0.0 else sum(counts) / sum(nodes))

    def _like(self, k: int) -> tuple[int, int, int]:
        """The pilot's mesh that is like mesh k of a run: cold or started from a coarser one."""
        return self.levels[0] if k == 0 else self.levels[-1]

    def _work(self, counts: Sequence[int], steps: Sequence[float], others: Sequence[float]) -> float:
        evaluations = sum(n * (a + b) for n, a, b in zip(counts, steps, others, strict=True))
        return self.node_seconds * evaluations + self.examined * sum(counts)


def pilot(scene: Scene, model: Model, tolerance: float, node_seconds: float) -> Pilot:
    """Run a scene's model on coarse meshes. node_seconds : CPU seconds of one step of one node.

    The finisher is used if the run on the scene's own mesh would use it.
    """
    counts = level_nodes(grid_of(scene)(scene.mesh.nodes).nodes, scene.solver.levels)
    nodes = min(max(NODES, OVER_COARSE * counts[0]) if len(counts) > 1 else NODES, scene.mesh.nodes)
    solver = scene.solver
    finishes = solver.finish != "off" and (not model.relaxed or scene.mesh.nodes <= MOST_RELAXED)
    settings = replace(
        settings_of(scene, tolerance),
        levels=min(len(counts), 2),
        finish=solver.finish if finishes else "off",
        max_steps=MOST_STEPS,
        max_seconds=MOST_SECONDS,
        snapshots=0,
    )
    smaller = replace(scene, mesh=scene.mesh.model_copy(update={"nodes": nodes}))
    solution = solve(_like_a_coarse_level(problem_of(smaller, model, seed=0), counts, scene), model, settings)
    levels = tuple(
        (int(level["nodes"]), int(level["steps"]), int(level["force_evaluations"] - level["steps"]))
        for level in solution.levels
    )
    examined = 0.0 if model.relaxed or not loads_in_plane(scene) else EXAMINED
    finished = solution.status is Status.CONVERGED
    symmetry = symmetry_of(scene, model)
    dimensions = 1 if symmetry is not None and symmetry.axisymmetric else 2
    return Pilot(levels, finished, node_seconds, examined, solution.cpu_seconds, dimensions)


def _like_a_coarse_level(problem: Problem, counts: Sequence[int], scene: Scene) -> Problem:
    """The problem with the run's coarsest mesh as its own, and as thick as the run has it on a mesh of these nodes."""
    thicker = counts[-1] / problem.grid.nodes if scene.solver.thicken else 1.0
    sheet = replace(problem.sheet, thickness_mm=thicker * problem.sheet.thickness_mm)
    return replace(problem, sheet=sheet, grid_of=lambda _: problem.grid_of(counts[0]))
