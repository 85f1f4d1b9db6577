"""Where the flat, finitely strained sheet of a scene is unstable: along its load, over thickness and aspect ratio."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from cases.finite_elements import (
    movements_of,
    plate_material,
    sheet_mesh,
    supports_of,
)
from cases.methods import nominal_strain
from cases.schema import RectangleSheet, Scene

if TYPE_CHECKING:
    import pandas as pd

    from femref.flat_stability import FlatSheet, Window


def flat_sheet(scene: Scene, vertices: int) -> FlatSheet:
    """The sheet of a scene for `femref.flat_stability`; loads are multiples of the scene's own."""
    from femref.flat_stability import FlatSheet

    return FlatSheet(
        sheet_mesh(scene, vertices),
        plate_material(scene),
        supports_of(scene),
        movements_of(scene, finite=True),
    )


def along_the_load(scene: Scene, strains: Sequence[float], vertices: int) -> pd.DataFrame:
    """Stability of the flat state at nominal strains.

    Columns: strain; factor, of the membrane stress at which the flat state buckles; unstable, number of unstable modes;
    neutral_thickness_mm, the least at which it is stable (0 where nothing is compressed), for any thickness at once.
    """
    import pandas as pd

    flat, unit = flat_sheet(scene, vertices), nominal_strain(scene)
    found = [flat.verdict(strain / unit) for strain in strains]
    return pd.DataFrame(
        {
            "strain": list(strains),
            "factor": [verdict.factor for verdict in found],
            "unstable": [verdict.unstable for verdict in found],
            "neutral_thickness_mm": [verdict.thickness_mm for verdict in found],
        }
    )


def over_aspect_ratios(
    scene: Scene, aspects: Sequence[float], strains: Sequence[float], vertices: int
) -> pd.DataFrame:
    """`along_the_load` of rectangles of the scene's width, `aspect` times as high, with the column `aspect` first.

    A sheet of thickness h is wrinkled at those strains where neutral_thickness_mm exceeds h. The strains are those of
    the pull along the height. Raises ValueError for a scene whose sheet is no rectangle.
    """
    import pandas as pd

    sheet = scene.sheet
    if not isinstance(sheet, RectangleSheet):
        raise ValueError(f"the map is of rectangles; the scene {scene.name} has another shape")
    parts = []
    for aspect in aspects:
        part = along_the_load(
            pulled_rectangle(scene, sheet.width_mm, aspect * sheet.width_mm), strains, vertices
        )
        part.insert(0, "aspect", aspect)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)


def pulled_rectangle(scene: Scene, width_mm: float, height_mm: float) -> Scene:
    """The scene with a rectangle of this size, its top edge moved up by a tenth of the height, its bottom edge held."""
    moves = {"top": (0.0, 0.1 * height_mm, 0.0), "bottom": (0.0, 0.0, 0.0)}
    moved = {name: scene.edges[name].model_copy(update={"move_mm": move}) for name, move in moves.items()}
    sheet = scene.sheet.model_copy(update={"width_mm": width_mm, "height_mm": height_mm})
    return replace(scene, sheet=sheet, edges={**scene.edges, **moved})


def window_of(scene: Scene, vertices: Sequence[int], brackets: Sequence[tuple[float, float]]) -> Window:
    """`femref.flat_stability.window` of a scene, its brackets and its ends in nominal strain."""
    from femref.flat_stability import window

    unit = nominal_strain(scene)
    loads = [(low / unit, high / unit) for low, high in brackets]
    found = window(lambda count: flat_sheet(scene, count), vertices, loads)
    return replace(
        found,
        appearance=unit * found.appearance,
        appearance_error=unit * found.appearance_error,
        disappearance=unit * found.disappearance,
        disappearance_error=unit * found.disappearance_error,
    )
