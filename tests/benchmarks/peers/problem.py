"""The three problems that every peer solves, their meshes and starts, and how a peer answers.

Needs numpy alone: each peer lives in an environment of its own. Lengths in mm, stresses in MPa. A peer's script is
called with a problem and a mesh number and prints one line of JSON (`answer`).
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

ITERATIONS = 200  # of Newton's method, after which a peer is said not to converge


@dataclass(frozen=True)
class Sheet:
    """Material of a sheet: Young's modulus (MPa), Poisson's ratio, thickness (mm)."""

    young: float
    poisson: float
    thickness: float


ANNULUS, INNER, OUTER, LIFT, TURN = Sheet(3500.0, 0.31, 0.025), 62.5, 250.0, 125.0, np.pi / 2.0
HOLE, HOLE_WIDTH, HOLE_HEIGHT, RADIUS, HOLE_PULL = Sheet(3500.0, 0.31, 0.01), 50.0, 125.0, 15.0, 12.5
STRETCH, WIDTH, HEIGHT, PULL = Sheet(1.0, 0.5, 0.1), 101.6, 254.0, 25.4
WAVELENGTH, SEED_HEIGHT = 14.5, 0.3  # mm, of the waves that the plates start with: about those of the answer


@dataclass(frozen=True)
class Lattice:
    """Nodes u (ni, nj, 2) of a logically rectangular mesh, with a node in the middle of every quadratic element.

    closed : the first direction is a ring and does not repeat its first line.
    """

    u: np.ndarray
    closed: bool

    def points(self) -> np.ndarray:
        """Coordinates (n, 2)."""
        return self.u.reshape(-1, 2)

    def quadratic(self) -> np.ndarray:
        """Elements (m, 9): corners counter-clockwise, middles of the edges in that order, the centre (VTK's order)."""
        ni, nj = self.u.shape[:2]
        i, j = np.meshgrid(
            np.arange(0, ni if self.closed else ni - 1, 2), np.arange(0, nj - 1, 2), indexing="ij"
        )
        steps = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1))
        cells = np.stack([((i + a) % ni) * nj + j + b for a, b in steps], axis=-1).reshape(-1, 9)
        corners = self.points()[cells[:, :4]]
        if _area(corners[0]) < 0.0:  # the lattice is left-handed
            cells = cells[:, [0, 3, 2, 1, 7, 6, 5, 4, 8]]
        return cells


def _area(corners: np.ndarray) -> float:
    p, q = corners[2] - corners[0], corners[3] - corners[1]
    return 0.5 * float(p[0] * q[1] - p[1] * q[0])


def annulus_lattice(n: int) -> Lattice:
    """2 n + 1 rings, growing outward, with nodes at about equal distances in both directions."""
    radius = INNER * (OUTER / INNER) ** np.linspace(0.0, 1.0, 2 * n + 1)
    around = 2 * round(2.0 * np.pi * n / np.log(OUTER / INNER))
    angle = np.arange(around) * 2.0 * np.pi / around
    return Lattice(
        np.stack([np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius)], axis=-1), True
    )


def hole_lattice(n: int) -> Lattice:
    """Rays from the hole to the rectangle, 2 n + 1 nodes on each, finer at the hole; corners carry a node."""
    short, long = 2 * n, 4 * n
    x, y = 0.5 * HOLE_WIDTH, 0.5 * HOLE_HEIGHT
    bottom = np.stack([np.linspace(-x, x, short, endpoint=False), np.full(short, -y)], axis=-1)
    right = np.stack([np.full(long, x), np.linspace(-y, y, long, endpoint=False)], axis=-1)
    rim = np.concatenate([bottom, right, -bottom, -right])
    start = RADIUS * rim / np.linalg.norm(rim, axis=1, keepdims=True)
    share = np.expm1(1.5 * np.linspace(0.0, 1.0, 2 * n + 1)) / np.expm1(1.5)
    return Lattice(start[:, None] + share[None, :, None] * (rim - start)[:, None], True)


def strip_lattice(n: int) -> Lattice:
    """2 n + 1 nodes across the strip and as many along it: the waves stand across."""
    x, y = (
        np.linspace(-0.5 * size, 0.5 * size, 2 * count + 1)
        for size, count in ((WIDTH, n), (HEIGHT, max(n // 2, 4)))
    )
    return Lattice(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1), False)


def annulus_start(points: np.ndarray) -> np.ndarray:
    """Lifted and turned in proportion to the distance from the outer circle: displacements (n, 3)."""
    r = np.linalg.norm(points, axis=1)
    share = (OUTER - r) / (OUTER - INNER)
    turned = np.arctan2(points[:, 1], points[:, 0]) + TURN * share
    place = np.stack([r * np.cos(turned), r * np.sin(turned), LIFT * share], axis=-1)
    place[:, :2] -= points
    return place


def hole_start(points: np.ndarray) -> np.ndarray:
    """Pulled evenly: displacements (n, 2)."""
    return np.stack([0.0 * points[:, 0], HOLE_PULL * points[:, 1] / HOLE_HEIGHT], axis=-1)


def waves(points: np.ndarray) -> np.ndarray:
    """Heights (n,) of the waves that a plate starts with, highest in the middle, flat at the supports."""
    x, y = points[:, 0], points[:, 1]
    middle = np.cos(np.pi * x / WIDTH) ** 2 * np.cos(np.pi * y / HEIGHT) ** 2
    return SEED_HEIGHT * middle * np.cos(2.0 * np.pi * x / WAVELENGTH)


def rms_of(x: np.ndarray, z: np.ndarray) -> float:
    """Root mean square of heights z at places x along the centre line, both (n,)."""
    between = 0.5 * (z[1:] ** 2 + z[:-1] ** 2)  # numpy renamed its own rule
    return float(np.sqrt((between * np.diff(x)).sum() / (x[-1] - x[0])))


def asked() -> tuple[str, int]:
    """The problem and the mesh number of the command line."""
    return sys.argv[1], int(sys.argv[2])


class Clock:
    """CPU seconds since it was made, of this process."""

    def __init__(self) -> None:
        self.start = time.process_time()

    def __call__(self) -> float:
        """Seconds so far."""
        return time.process_time() - self.start


def answer(
    values: dict[str, float],
    seconds: float,
    unknowns: int,
    iterations: int,
    versions: dict[str, str],
    limits: dict[str, float | None] | None = None,
) -> None:
    """Print what was found.

    seconds : of CPU, of assembling and solving, without meshing and compiling. limits : extrapolated values, of a
    program that gives them.
    """
    found = {"values": values, "cpu_seconds": seconds, "unknowns": unknowns, "iterations": iterations}
    if limits is not None:
        found["limits"] = limits
    print(json.dumps({"status": "converged", **found, "versions": versions}))


def solve_or_say(solve: Callable[[], None]) -> None:
    """Run a peer; what it raises becomes its answer."""
    try:
        solve()
    except Exception as error:  # any failure of a peer is a result of the comparison
        print(json.dumps({"status": "failed", "message": f"{type(error).__name__}: {error}"[:300]}))
