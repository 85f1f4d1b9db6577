"""The published scheme as a method: which scenes it solves, and its variant."""

from __future__ import annotations

from cases.schema import RectangleSheet, Scene
from fdsolver.model import Model


def unfit(scene: Scene) -> str | None:
    """Why the published scheme cannot solve a scene; None if it can."""
    if scene.symmetry.asked:
        return "its ghost layer does not continue across a symmetry line; solve the whole sheet"
    if isinstance(scene.sheet, RectangleSheet):
        return None
    return "it is for rectangles, as the paper gives its ghost layer for straight edges along mesh lines only"


def published_of(scene: Scene) -> Model:
    """The engine's model of the scene's variant, `solver.published`."""
    from fdsolver.published_level import published_model

    return published_model(scene.solver.published)
