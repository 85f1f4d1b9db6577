"""At which load wrinkles appear: by the modes of linear buckling, and where the flat sheet of finite strain gives way.

The linear modes know the stress at no load only. The flat state of finite strain is examined twice: by finite elements,
and by the plate of the finite differences, relaxed in its plane, whose lowest eigenvalue changes its sign. These two
must agree; how far the linear modes are away is what finite strain changes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from scipy.optimize import brentq

from cases.energy_gained import flat_state
from cases.flat_stability import flat_sheet, nominal_strain
from cases.mesh_sequence import mesh_limit
from cases.schema import Scene
from cases.unstructured import FiniteElementSolution
from fdsolver.result import Status

ELEMENT_MESHES = (350, 700)  # vertices: quintics are good to 1e-3 there
GRID_MESHES = (3000, 6000, 12000)
# Parts of the scene's load between which the search is worth its while: beyond it the sheet is flat, far below it the
# load is not that of wrinkles about to appear.
LEAST_PART, MOST_PART = 0.02, 1.0
_BRACKET = (0.7, 1.5)  # about the modes' load
_NARROW = 0.05  # half width of the bracket on a finer mesh
_ACCURACY = 1e-5  # of a load, relative


@dataclass(frozen=True)
class Appearance:
    """A nominal strain at which the flat sheet becomes unstable, and the estimated error of its meshes."""

    strain: float
    error: float


def by_modes(buckling: FiniteElementSolution) -> Appearance:
    """That of the smallest buckling factor."""
    first, error = buckling.critical[0], buckling.errors[0]
    strain = float(first["strain"])
    return Appearance(strain, strain * float(error["discretisation"]) / float(first["factor"]))


def worth_searching(buckling: FiniteElementSolution) -> bool:
    """Whether the scene's load is beyond its first critical one, but not by very much."""
    return LEAST_PART < float(buckling.critical[0]["factor"]) < MOST_PART


def by_elements(scene: Scene, factor: float) -> Appearance:
    """Of the finitely strained flat state by finite elements. factor : the modes' multiple of the scene's load.

    Raises ValueError if the flat sheet does not change its stability near that load.
    """
    low, high = (part * factor for part in _BRACKET)
    found = []
    for vertices in ELEMENT_MESHES:
        load = flat_sheet(scene, vertices).crossing(low, high)
        found.append(load)
        low, high = (1.0 - _NARROW) * load, (1.0 + _NARROW) * load
    unit = nominal_strain(scene)
    return Appearance(unit * found[-1], unit * abs(found[-1] - found[-2]))


def by_relaxation(scene: Scene, factor: float, meshes: Sequence[int] = GRID_MESHES) -> Appearance:
    """Of the plate relaxed in its plane, on grids of so many nodes: the limit of the meshes and its band.

    Raises ValueError if the flat sheet does not change its stability near that load.
    """
    low, high = (part * factor for part in _BRACKET)
    found = [_root(_lowest_of(scene, nodes), low, high) for nodes in meshes]
    unit, limit = nominal_strain(scene), mesh_limit(meshes, found)
    return Appearance(unit * limit.value, unit * limit.band)


def _lowest_of(scene: Scene, nodes: int) -> Callable[[float], float]:
    """The lowest eigenvalue of the flat sheet as a function of the multiple of the scene's load."""

    def lowest(load: float) -> float:
        flat = flat_state(loaded(scene, load), nodes)
        value = flat.stability["lowest"]
        if flat.status is not Status.CONVERGED or not isinstance(value, float):
            raise ValueError(f"there is no flat state at {load:g} times the load: {flat.message}")
        return value

    return lowest


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    if function(low) * function(high) > 0.0:
        raise ValueError(f"the flat state keeps its stability from {low:g} to {high:g} times the load")
    return float(brentq(function, low, high, rtol=_ACCURACY))


def loaded(scene: Scene, part: float) -> Scene:
    """The scene with its edges moved, turned and grown by a multiple of what it asks for."""
    edges = {
        name: edge.model_copy(
            update={
                "move_mm": tuple(part * way for way in edge.move_mm),
                "rotate_deg": part * edge.rotate_deg,
                "grow_mm": part * edge.grow_mm,
            }
        )
        for name, edge in scene.edges.items()
    }
    return replace(scene, edges=edges)
