"""Random scenes to hold the audit's verdicts against full runs: shapes, materials, thicknesses and loads by a seed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cases import load_scene
from cases.schema import Scene

NODES = 2500  # a few seconds for a run with everything on
TOLERANCE = 1e-7  # of a sheet strained by a tenth: the models are compared, not how far the iterations went
MOST_STEPS = 150_000  # softly pushed plates take 110 000; some that fold would go on for minutes
THINNEST, THICKEST = 1e-6, 1e-2  # over the size


@dataclass(frozen=True)
class RandomScene:
    """What was drawn. what : in words. base, changes : of `load_scene`."""

    what: str
    base: str
    changes: dict[str, Any]

    def scene(self, **more: object) -> Scene:
        """The scene, with further dotted keys."""
        return load_scene(self.base, {**self.changes, **more})


def random_scenes(count: int, seed: int) -> Iterator[RandomScene]:
    """Scenes drawn with a seed: the shapes in turn, everything else at random."""
    random = np.random.default_rng(seed)
    shapes = (_rectangle, _annulus, _hole)
    for k in range(count):
        size = _between(random, 10.0, 1000.0)
        thickness = size * _between(random, THINNEST, THICKEST)
        base, load, changes = shapes[k % len(shapes)](random, size)
        poisson = float(random.uniform(0.0, 0.5))
        shape = {"stretch": "rectangle", "hole": "rectangle with a hole"}.get(base, base)
        changes |= {
            "sheet.thickness_mm": thickness,
            "material.young_MPa": _between(random, 1.0, 1e4),
            "material.poisson": poisson,
            "mesh.nodes": NODES,
            "paths": {},
            "solver.tolerance": TOLERANCE,
            "solver.max_steps": MOST_STEPS,
        }
        yield RandomScene(f"{shape}, {load}, h/L = {thickness / size:.1e}, ν = {poisson:.2f}", base, changes)


Drawn = tuple[str, str, dict[str, Any]]  # built-in scene, load in words, changes


def _between(random: np.random.Generator, least: float, most: float) -> float:
    """A number whose logarithm is uniform."""
    return float(10.0 ** random.uniform(np.log10(least), np.log10(most)))


def _rectangle(random: np.random.Generator, size: float) -> Drawn:
    """Pulled along y, sheared, or pushed."""
    load = str(random.choice(["pulled", "sheared", "pushed"]))
    held = str(random.choice(["pinned", "clamped"]))
    least, most = {"pulled": (1e-4, 0.3), "sheared": (1e-4, 0.03), "pushed": (1e-5, 3e-3)}[load]
    strain = _between(random, least, most)
    move = {"pulled": (0.0, strain), "sheared": (strain, 0.0), "pushed": (0.0, -strain)}[load]
    changes = {
        "sheet.width_mm": size * float(random.uniform(0.3, 1.5)),
        "sheet.height_mm": size,
        "edges.bottom.support": held,
        "edges.top.support": held,
        "edges.top.move_mm": [move[0] * size, move[1] * size, 0.0],
        "mesh.bias": 0.0,
        "sections": {},
    }
    return "stretch", f"{held}, {load} by {100.0 * strain:.2g} %", changes


def _annulus(random: np.random.Generator, size: float) -> Drawn:
    """Widened at the outer rim, shrunk at the inner one, turned, lifted, or lifted and turned."""
    load = str(random.choice(["widened", "shrunk", "turned", "lifted", "lifted and turned"]))
    outer = size / 2.0
    inner = outer * float(random.uniform(0.2, 0.7))
    strain, lift, turn = (
        _between(random, 1e-4, 0.1),
        _between(random, 0.01, 0.6),
        _between(random, 0.01, 30.0),
    )
    changes = {
        "sheet.inner_radius_mm": inner,
        "sheet.outer_radius_mm": outer,
        "edges.inner.move_mm": [0.0, 0.0, lift * (outer - inner) if "lifted" in load else 0.0],
        "edges.inner.rotate_deg": turn if "turned" in load else 0.0,
        "edges.inner.grow_mm": -strain * inner if load == "shrunk" else 0.0,
        "edges.outer.grow_mm": strain * outer if load == "widened" else 0.0,
        "sections": {},
    }
    amount = [f"{100.0 * strain:.2g} %"] if load in ("widened", "shrunk") else []
    amount += [f"{lift:.2g} of the width"] if "lifted" in load else []
    amount += [f"{turn:.2g} degrees"] if "turned" in load else []
    return "annulus", f"{load} by {' and '.join(amount)}", changes


def _hole(random: np.random.Generator, size: float) -> Drawn:
    """Pulled along y."""
    width = size * float(random.uniform(0.4, 1.0))
    strain = _between(random, 1e-4, 0.1)
    changes = {
        "sheet.width_mm": width,
        "sheet.height_mm": size,
        "sheet.hole_radius_mm": width * float(random.uniform(0.1, 0.35)),
        "edges.bottom.move_mm": [0.0, -0.5 * strain * size, 0.0],
        "edges.top.move_mm": [0.0, 0.5 * strain * size, 0.0],
        "sections": {},
    }
    return "hole", f"pulled by {100.0 * strain:.2g} %", changes
