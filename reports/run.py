"""One solve of the report, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class ReportRun:
    """One solve of the report.

    name : folder name of the result, unique.
    scene : built-in scene.
    method : method name of the command line.
    nodes_quick, nodes_full : node count, 0 for the scene's default; None leaves the run out.
    overrides : dotted scene key -> value, as `--set` takes them.
    max_seconds : time limit of the quick report, s; the full report has ten times as much.
    part : the figure or table of the scene's section that the run is for; "" for its comparison of methods.
    seed : of the random start.
    imposed_mm : half-wavelength of straight waves at 45 degrees that are put into the start instead of the random one.
    kept_flat : solve for the plate's planar equilibrium, which is examined but not left where it is unstable.
    """

    name: str
    scene: str
    method: str
    nodes_quick: int | None
    nodes_full: int | None
    overrides: Mapping[str, object] = field(default_factory=dict)
    max_seconds: float = 40.0
    part: str = ""
    seed: int = 0
    imposed_mm: float | None = None
    kept_flat: bool = False

    def nodes(self, full: bool) -> int | None:
        """Node count of the quick or full report; None if that report leaves the run out."""
        return self.nodes_full if full else self.nodes_quick
