"""The models that the engine can relax: a membrane law, with or without bending, and the effects that are left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from fdsolver.membrane import StVenantKirchhoff


@dataclass(frozen=True)
class Model:
    """What the energy consists of.

    name : of the method, as on the command line.
    law : Poisson ratio -> membrane law, a named tuple for which `membrane.stress` is overloaded.
    bending : whether the curvature carries energy. relaxed : whether compression is relaxed away.
    buckles : whether the sheet is meant to leave an unstable flat state.
    out_of_plane : whether it can; a sheet that stays in its plane has two components and no curvature.
    strain_gradient : whether the normal of the curvature n . r,ab turns with the sheet; otherwise it stays e3, and no
        couple of the moments acts on the strain. moderate : moderate rotations (Foeppl and von Karman), which go with
        the normal e3.
    level : what makes the `level.Level` of a mesh, where that is not the plain one.
    """

    name: str
    law: Callable[[float], NamedTuple]
    bending: bool
    relaxed: bool = False
    buckles: bool = False
    out_of_plane: bool = True
    strain_gradient: bool = True
    moderate: bool = False
    level: Callable[..., Any] | None = None

    @property
    def components(self) -> int:
        """Number of displacement components."""
        return 3 if self.out_of_plane else 2

    @property
    def curvature(self) -> str:
        """The curvature that carries energy: "none", "linear" (e3 . r,ab) or "full" (n . r,ab)."""
        if not (self.bending and self.out_of_plane):
            return "none"
        return "full" if self.strain_gradient and not self.moderate else "linear"


KOITER = Model("koiter", StVenantKirchhoff, bending=True, buckles=True)
MEMBRANE = Model("membrane", StVenantKirchhoff, bending=False)
