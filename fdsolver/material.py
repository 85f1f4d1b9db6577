"""The sheet: an isotropic, uniform plate in plane stress (Taylor et al. 2014, Eqs. 24, 34, 36)."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Sheet:
    """Material and thickness of a uniform sheet.

    young_MPa : Young's modulus Y, MPa, positive.
    poisson : Poisson ratio nu, -1 < nu <= 1/2.
    thickness_mm : thickness h, mm, positive.

    Raises ValueError for values outside these ranges.
    """

    young_MPa: float
    poisson: float
    thickness_mm: float

    def __post_init__(self) -> None:
        if not (self.young_MPa > 0.0 and math.isfinite(self.young_MPa)):
            raise ValueError(f"young_MPa must be positive and finite, not {self.young_MPa}")
        if not -1.0 < self.poisson <= 0.5:
            raise ValueError(f"poisson must be above -1 and at most 0.5, not {self.poisson}")
        if not (self.thickness_mm > 0.0 and math.isfinite(self.thickness_mm)):
            raise ValueError(f"thickness_mm must be positive and finite, not {self.thickness_mm}")

    @property
    def c_MPa(self) -> float:
        """Plane-stress modulus c = Y nu / (1 - nu^2), MPa; finite at nu = 1/2, where lambda is not."""
        return self.young_MPa * self.poisson / (1.0 - self.poisson**2)

    @property
    def mu_MPa(self) -> float:
        """Shear modulus mu = Y / (2 (1 + nu)), MPa."""
        return self.young_MPa / (2.0 * (1.0 + self.poisson))

    @property
    def bending_stiffness_N_mm(self) -> float:
        """Bending stiffness D = Y h^3 / (12 (1 - nu^2)), N mm."""
        return self.young_MPa * self.thickness_mm**3 / (12.0 * (1.0 - self.poisson**2))

    @property
    def natural_width_limit(self) -> float:
        """Largest stretch with a natural width, sqrt(1 + 1/nu) (Pipkin 1986); infinite for nu <= 0."""
        return math.sqrt(1.0 + 1.0 / self.poisson) if self.poisson > 0.0 else math.inf
