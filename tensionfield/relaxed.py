"""Pipkin's relaxed membrane energy: tense, wrinkled or slack (Pipkin 1986).

With the principal Green strains E1 >= E2 and <x> = max(x, 0), scaled by Young's modulus,

    W = <E1>^2 / 2 + <E2 + nu E1>^2 / (2 (1 - nu^2)),

which is the St. Venant-Kirchhoff energy where the zone is tense, that of simple tension where it is wrinkled and zero
where it is slack. W is convex and continuously differentiable, so there is nothing to regularise. The sign of
E2 + nu E1 decides, never the natural width, whose square root is NaN beyond the stretch sqrt(1 + 1/nu).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba.extending import overload

from fdsolver.membrane import stress
from fdsolver.model import Model
from fdsolver.moderate import register

TINY = 1e-300  # keeps 0 / 0 out of the direction of an isotropic strain, where it does not matter


class Relaxed(NamedTuple):
    """Pipkin's relaxation of the St. Venant-Kirchhoff membrane, scaled by Y. poisson : nu."""

    poisson: float


class ModerateRelaxed(NamedTuple):
    """`Relaxed` under moderate rotations. poisson : nu."""

    poisson: float


register(ModerateRelaxed, Relaxed)


@overload(stress)
def _relaxed(law, e11, e22, e12):
    if getattr(law, "instance_class", None) is not Relaxed:
        return None

    def evaluate(law, e11, e22, e12):
        nu = law.poisson
        # E2 <= E1 <= 0 gives E2 + nu E1 <= (1 + nu) E1 <= 0: a slack zone has no lateral stress either.
        mean, half = 0.5 * (e11 + e22), 0.5 * (e11 - e22)
        radius = np.sqrt(half * half + e12 * e12)
        major, minor = mean + radius, mean - radius
        tension = max(major, 0.0)
        lateral = minor + nu * major
        minor_stress = max(lateral, 0.0) / (1.0 - nu * nu)
        major_stress = tension + nu * minor_stress
        direction = 0.5 * (major_stress - minor_stress) / (radius + TINY)
        average = 0.5 * (major_stress + minor_stress)
        density = 0.5 * (tension * tension + (1.0 - nu * nu) * minor_stress * minor_stress)
        return average + direction * half, average - direction * half, direction * e12, density

    return evaluate


TENSION_FIELD = Model("tension-field", Relaxed, bending=False, relaxed=True)
