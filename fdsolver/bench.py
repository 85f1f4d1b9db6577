"""Throughput of the engine: million node-steps per second of force and time step, by model, mesh and threads."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence

import numba
import numpy as np

from fdsolver import damping, meshes
from fdsolver.edges import EdgeCondition
from fdsolver.grid import Grid
from fdsolver.level import Level
from fdsolver.mass import invert, nodal_masses
from fdsolver.material import Sheet
from fdsolver.model import KOITER, MEMBRANE, Model
from fdsolver.problem import Problem
from fdsolver.relax import BLOCK, CAP

NODES = (10_000, 40_000)  # whose fields fit the inner caches, and do not
SHEET = Sheet(young_MPa=3500.0, poisson=0.31, thickness_mm=0.05)
RATE = "million node-steps/s"

Row = dict[str, str | int | float]


def throughput(models: Sequence[Model] = (MEMBRANE, KOITER), seconds: float = 0.5) -> list[Row]:
    """Measure every model on rectangles and annuli of two sizes with one and (where there are two cores) two threads.

    A node-step is one force evaluation and one step of [68] at one node, in blocks as `relax` runs them, without the
    looks between the blocks. models : also those of other packages, such as the relaxed membrane. seconds : spent on
    each row after compilation; the fastest block counts, because other work of the machine only makes blocks slower.

    Returns one row per model, mesh and number of threads: model, mesh, nodes, threads, million node-steps/s.
    """
    grids = [
        (mesh, grid)
        for nodes in NODES
        for mesh, grid in (
            ("rectangle", meshes.rectangle(250.0, 250.0, nodes)),
            ("curvilinear", meshes.annulus(62.5, 250.0, nodes)),
        )
    ]
    most = min(2, os.cpu_count() or 1, vars(numba.config)["NUMBA_NUM_THREADS"])
    before = numba.get_num_threads()
    try:
        return [
            {
                "model": model.name,
                "mesh": mesh,
                "nodes": grid.nodes,
                "threads": threads,
                RATE: node_steps_per_second(model, grid, threads, seconds) / 1e6,
            }
            for model in models
            for mesh, grid in grids
            for threads in range(1, most + 1)
        ]
    finally:
        numba.set_num_threads(before)


def node_steps_per_second(
    model: Model,
    grid: Grid,
    threads: int,
    seconds: float,
    clock: Callable[[], float] = time.perf_counter,
) -> float:
    """Node-steps per second of the fastest block of `BLOCK` steps within about `seconds` of wall time.

    clock : of the seconds, by default wall time; `time.process_time` counts those of the processor.

    The sheet is stretched by 2 %, held at its last edge, and set off by a random field: nothing in it is zero.
    """
    numba.set_num_threads(threads)
    edge = list(grid.edges)[-1]
    problem = Problem(SHEET, {edge: EdgeCondition("pinned")}, grid, lambda nodes: grid)
    level = Level(problem, model, grid, threads)
    noise = np.random.default_rng(0).standard_normal((model.components, grid.ni, grid.nj))
    start = level.scaled(1.02 * level.flat) + 1e-6 * noise
    mass = nodal_masses(level.force, start, start, level.force.relaxed)
    inverse = np.zeros_like(mass)
    invert(mass.reshape(len(mass), -1), ~level.fixed.reshape(-1), inverse.reshape(len(mass), -1))
    r, v, f, old = start.copy(), np.zeros_like(start), np.zeros_like(start), np.zeros_like(start)
    fastest, until = np.inf, np.inf
    while clock() < until:
        r[:], v[:] = start, 0.0
        began = clock()
        level.force(r, f)
        motion = (r, v, mass, inverse, f, old)
        damping.advance(level.force, *motion, ("adaptive", 0.0), 0.0, 0, False, BLOCK, CAP, threads)
        ended = clock()
        if until == np.inf:
            until = ended + seconds  # the first block compiles
        else:
            fastest = min(fastest, ended - began)
    return BLOCK * grid.nodes / fastest
