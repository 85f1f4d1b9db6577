"""The annulus problem: geometry, material and rim displacements, and the same in the solvers' scaled form."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from fdsolver.material import Sheet


class NoAnnulusSolution(ValueError):
    """The annulus has no unique axisymmetric relaxed equilibrium, or none was found; the message says so."""


@dataclass(frozen=True)
class AnnulusProblem:
    """An annular membrane whose two rims are displaced.

    inner_radius_mm, outer_radius_mm : radii of the undeformed sheet, mm.
    young_MPa, poisson, thickness_mm : material, with the ranges of `fdsolver.material.Sheet`.
    lift_mm : displacement of the inner rim along the axis relative to the outer rim, mm.
    twist_deg : turn of the inner rim about the axis relative to the outer rim, degrees.
    inner_grow_mm, outer_grow_mm : radial displacements of the rims, mm; negative values shrink a rim.

    Raises ValueError for values that are not finite or describe no annulus.
    """

    inner_radius_mm: float
    outer_radius_mm: float
    young_MPa: float
    poisson: float
    thickness_mm: float
    lift_mm: float
    twist_deg: float
    inner_grow_mm: float = 0.0
    outer_grow_mm: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            if not math.isfinite(getattr(self, field.name)):
                raise ValueError(f"{field.name} must be finite, not {getattr(self, field.name)}")
        Sheet(self.young_MPa, self.poisson, self.thickness_mm)
        if not 0.0 < self.inner_radius_mm < self.outer_radius_mm:
            raise ValueError(
                f"inner_radius_mm must be positive and below outer_radius_mm = {self.outer_radius_mm}, "
                f"not {self.inner_radius_mm}"
            )
        for rim, radius, grow in (
            ("inner", self.inner_radius_mm, self.inner_grow_mm),
            ("outer", self.outer_radius_mm, self.outer_grow_mm),
        ):
            if radius + grow <= 0.0:
                raise ValueError(f"{rim}_grow_mm must be above -{radius}, not {grow}: the rim would close")


@dataclass(frozen=True)
class ScaledAnnulus:
    """The problem with the outer radius as unit of length and Young's modulus as unit of stress.

    inner : inner radius; the outer one is 1.
    poisson : Poisson ratio.
    r_inner, r_outer : deformed radii of the rims.
    twist : turn of the inner rim, radians.
    lift : height of the inner rim above the outer one.
    """

    inner: float
    poisson: float
    r_inner: float
    r_outer: float
    twist: float
    lift: float

    @property
    def plane_stress(self) -> float:
        """Plane-stress modulus 1 / (1 - nu^2) over Young's modulus."""
        return 1.0 / (1.0 - self.poisson**2)

    @property
    def shear(self) -> float:
        """Shear modulus mu over Young's modulus."""
        return 0.5 / (1.0 + self.poisson)


def scaled(problem: AnnulusProblem) -> ScaledAnnulus:
    """Return `problem` in units of its outer radius and Young's modulus."""
    unit = problem.outer_radius_mm
    return ScaledAnnulus(
        inner=problem.inner_radius_mm / unit,
        poisson=problem.poisson,
        r_inner=(problem.inner_radius_mm + problem.inner_grow_mm) / unit,
        r_outer=(problem.outer_radius_mm + problem.outer_grow_mm) / unit,
        twist=math.radians(problem.twist_deg),
        lift=problem.lift_mm / unit,
    )
