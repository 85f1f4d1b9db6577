"""Moderate rotations (Foeppl and von Karman): strains linear in the displacement in the plane, quadratic in the slope.

    E_ab = (u_a,b + u_b,a + w,a w,b) / 2,      u_a = r_a - x_a,  w = r_3,

instead of Green's strain: the squares of the displacement gradients in the plane are dropped, so that a sheet pulled
far does not stiffen. It goes with the curvature b_ab = w,ab (`plate_linear`). The stress P = dW/dF of any membrane law
is then P_ab = S_ab in the plane and P_3a = S_ab w,b out of it.
"""

from __future__ import annotations

from typing import NamedTuple

from numba.extending import overload

from fdsolver.membrane import OWN_KINEMATICS, StVenantKirchhoff, first_piola, strain, stress


class ModerateStVenantKirchhoff(NamedTuple):
    """`membrane.StVenantKirchhoff` under moderate rotations. poisson : nu."""

    poisson: float


_LAW_OF: dict[type, type] = {}  # a law under moderate rotations -> the law of its stress
_MODERATE: dict[type, type] = {}  # the other way round


def register(moderate: type, law: type) -> None:
    """Make `moderate`, a named tuple with the fields of `law`, that law under moderate rotations."""
    OWN_KINEMATICS.add(moderate)
    _LAW_OF[moderate], _MODERATE[law] = law, moderate


def under_moderate_rotation(law: tuple) -> tuple:
    """The law of the same stress and parameters under moderate rotations."""
    return _MODERATE[type(law)](*law)


register(ModerateStVenantKirchhoff, StVenantKirchhoff)


@overload(stress)
def _of_the_law(law, e11, e22, e12):
    moderate = getattr(law, "instance_class", None)
    if moderate not in _LAW_OF:
        return None
    stress_law = _LAW_OF[moderate]

    def evaluate(law, e11, e22, e12):
        return stress(stress_law(*law), e11, e22, e12)

    return evaluate


@overload(first_piola)
def _of_moderate_rotation(law, fx1, fx2, fy1, fy2, fz1, fz2):
    if getattr(law, "instance_class", None) not in _LAW_OF:
        return None

    def evaluate(law, fx1, fx2, fy1, fy2, fz1, fz2):
        e11 = fx1 - 1.0 + 0.5 * fz1 * fz1
        e22 = fy2 - 1.0 + 0.5 * fz2 * fz2
        e12 = 0.5 * (fx2 + fy1 + fz1 * fz2)
        s11, s22, s12, density = stress(law, e11, e22, e12)
        return s11, s12, s12, s22, fz1 * s11 + fz2 * s12, fz1 * s12 + fz2 * s22, density

    return evaluate


@overload(strain)
def _moderate_strain(law, f):
    if getattr(law, "instance_class", None) not in _LAW_OF:
        return None

    def evaluate(law, f):
        e11 = f[0, 0] - 1.0 + 0.5 * f[2, 0] ** 2
        e22 = f[1, 1] - 1.0 + 0.5 * f[2, 1] ** 2
        e12 = 0.5 * (f[0, 1] + f[1, 0] + f[2, 0] * f[2, 1])
        f[0, 0], f[0, 1], f[1, 0], f[1, 1] = 1.0, 0.0, 0.0, 1.0
        return e11, e22, e12

    return evaluate
