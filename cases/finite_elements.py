"""A scene as input of the finite elements: mesh, material, supports and movements; a plane state as our fields."""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from cases.schema import AnnulusSheet, Edge, HoleSheet, Scene
from fdsolver.result import Reaction, ZoneFields

if TYPE_CHECKING:
    from femref.prestress import Movement, PlaneState
    from femref.sheet_mesh import PlateMaterial, SheetMesh

_SUPPORTED = ("pinned", "clamped")


def unfit(scene: Scene) -> str | None:
    """Why the scene has no buckling load, as a clause; None if it has one."""
    held = {name: edge for name, edge in scene.edges.items() if edge.support in _SUPPORTED}
    if any(edge.move_mm[2] != 0.0 for edge in held.values()):
        return (
            f"an edge of the scene {scene.name} moves along z, and a sheet buckles under a load in its plane"
        )
    if nominal_displacement_mm(scene) == 0.0:
        return f"no supported edge of the scene {scene.name} moves against another, so there is no load to multiply"
    return None


def default_vertices(scene: Scene) -> int:
    """Vertices for factors good to about 0.1 % on the built-in scenes."""
    return 2500 if isinstance(scene.sheet, HoleSheet) else 1500


def sheet_mesh(scene: Scene, vertices: int, rectangles: bool = False) -> SheetMesh:
    """The finite-element mesh of a scene's sheet."""
    from femref import meshes

    sheet = scene.sheet
    if isinstance(sheet, AnnulusSheet):
        return meshes.annulus(sheet.inner_radius_mm, sheet.outer_radius_mm, vertices, grading=0.5)
    if isinstance(sheet, HoleSheet):
        return meshes.rectangle_with_hole(sheet.width_mm, sheet.height_mm, sheet.hole_radius_mm, vertices)
    cells = "rectangles" if rectangles else "triangles"
    # cubics need more lines across the wrinkles than quintics
    aspect = _aspect(scene) ** (2 if rectangles else 1)
    return meshes.rectangle(
        sheet.width_mm, sheet.height_mm, vertices, grading=0.9, aspect=aspect, cells=cells
    )


def _aspect(scene: Scene) -> float:
    """Wrinkles run along a pull: cells twice as long there."""
    held = {name: edge.move_mm for name, edge in scene.edges.items() if edge.support in _SUPPORTED}
    if set(held) == {"bottom", "top"}:
        across, along = (abs(held["top"][k] - held["bottom"][k]) for k in range(2))
        return 2.0 if along > across else 1.0
    if set(held) == {"left", "right"}:
        along, across = (abs(held["right"][k] - held["left"][k]) for k in range(2))
        return 0.5 if along > across else 1.0
    return 1.0


def plate_material(scene: Scene) -> PlateMaterial:
    """Material and thickness of a scene."""
    from femref.sheet_mesh import PlateMaterial

    return PlateMaterial(scene.material.young_MPa, scene.material.poisson, scene.sheet.thickness_mm)


def supports_of(scene: Scene) -> dict[str, str]:
    """Edge name -> support."""
    return {name: edge.support for name, edge in scene.edges.items()}


def movements_of(scene: Scene, finite: bool) -> dict[str, Movement]:
    """How the supported edges move at a multiple of the load: grown, turned, moved; turned by a finite angle or not."""
    return {name: _movement(edge, finite) for name, edge in scene.edges.items() if edge.support in _SUPPORTED}


def _movement(edge: Edge, finite: bool) -> Movement:
    shift, angle = np.array(edge.move_mm[:2])[:, None], math.radians(edge.rotate_deg)

    def movement(position: np.ndarray, load: float) -> np.ndarray:
        radius = np.linalg.norm(position, axis=0)
        grown = load * edge.grow_mm * position / np.where(radius > 0.0, radius, 1.0)
        turned = np.stack([-position[1], position[0]])
        if not finite:
            return grown + load * (angle * turned + shift)
        x, y = position + grown
        c, s = math.cos(load * angle), math.sin(load * angle)
        return np.stack([c * x - s * y, s * x + c * y]) - position + load * shift

    return movement


def nominal_displacement_mm(scene: Scene) -> float:
    """Largest displacement of one supported edge against another, mm."""
    held = [edge for edge in scene.edges.values() if edge.support in _SUPPORTED]
    sheet = scene.sheet
    arm = sheet.inner_radius_mm if isinstance(sheet, AnnulusSheet) else sheet.size_mm / 2.0
    return max(
        (
            math.dist(one.move_mm, other.move_mm)
            + abs(one.grow_mm - other.grow_mm)
            + arm * math.radians(abs(one.rotate_deg - other.rotate_deg))
            for one, other in combinations(held, 2)
        ),
        default=0.0,
    )


def zone_fields(scene: Scene, state: PlaneState) -> ZoneFields:
    """Principal stretches and stresses of each cell, means over it; the linear theory's stretch is 1 + strain."""
    gradient = state.gradient.mean(axis=-1).transpose(2, 0, 1)
    strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
    finite = scene.solver.prestress == "finite"
    if finite:
        strain = strain + 0.5 * gradient.transpose(0, 2, 1) @ gradient
    minor, major = np.linalg.eigvalsh(strain).T
    stress_minor, stress_major = (
        scene.material.young_MPa * np.linalg.eigvalsh(state.stress.mean(axis=-1).transpose(2, 0, 1)).T
    )
    tense = (major > 0.0) & (minor > -scene.material.poisson * major)
    zone_state = np.where(tense, 2, np.where(major > 0.0, 1, 0)).astype(np.int8)
    stretches = [np.sqrt(1.0 + 2.0 * e) if finite else 1.0 + e for e in (major, minor)]
    return ZoneFields(stretches[0], stretches[1], stress_major, stress_minor, zone_state)


def reactions_of(state: PlaneState) -> dict[str, Reaction]:
    """What each supported edge exerts on the plane sheet."""
    return {
        name: Reaction(np.array([fx, fy, 0.0]), np.array([0.0, 0.0, moment]))
        for name, (fx, fy, moment) in state.reaction_N.items()
    }
