"""The models that the engine can relax: a membrane law, with or without bending."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from fdsolver.membrane import StVenantKirchhoff


@dataclass(frozen=True)
class Model:
    """What the energy consists of.

    name : of the method, as on the command line.
    law : Poisson ratio -> membrane law, a named tuple for which `membrane.stress` is overloaded.
    bending : whether the curvature carries energy. relaxed : whether compression is relaxed away.
    """

    name: str
    law: Callable[[float], NamedTuple]
    bending: bool
    relaxed: bool = False
    buckles: bool = False


KOITER = Model("koiter", StVenantKirchhoff, bending=True, buckles=True)
MEMBRANE = Model("membrane", StVenantKirchhoff, bending=False)
