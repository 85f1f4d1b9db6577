"""Edge conditions: free, pinned or clamped; where supported edges go (Eq. 33 of the paper)."""

from __future__ import annotations

from dataclasses import dataclass

SUPPORTS = ("free", "pinned", "clamped")


@dataclass(frozen=True)
class EdgeCondition:
    """Support of one edge and its rigid movement.

    support : "free", "pinned" (position given) or "clamped" (position and normal given).
    move_mm : translation of the edge, mm.
    rotate_deg : rotation about the z axis through the origin, degrees, applied before the translation.
    grow_mm : radial displacement of a circular edge, mm, applied first.

    Raises ValueError for an unknown support.
    """

    support: str = "free"
    move_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotate_deg: float = 0.0
    grow_mm: float = 0.0

    def __post_init__(self) -> None:
        if self.support not in SUPPORTS:
            raise ValueError(f"support must be one of {', '.join(SUPPORTS)}, not {self.support!r}")
