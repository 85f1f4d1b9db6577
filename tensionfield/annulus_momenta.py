"""Line derivatives of the annulus from its momenta: the local inverse that shooting integrates.

The radial stress vector P = (p, G / r, Q) / R and the hoop stretch b = r / R are known at a radius; the
radial line derivative a = (r', r phi', z') follows from one scalar equation in each state. In units of
Young's modulus:

- tense: with s = S11, a = (P_r / s, P_phi / (s + mu b^2), P_z / s), where s is the root of
  2 (1 - nu^2) s = |a|^2 - 1 + nu (b^2 - 1);
- wrinkled: P = f(l) cos(alpha) m and b m_phi = l sin(alpha), so with C = R |P|, t = r m_phi and e = l^2 - 1
  the law R^2 = C^2 / f(l)^2 + t^2 / l^2 of Steigmann 1990 is the cubic R^2 e^3 + (R^2 - t^2) e^2 - 4 C^2 =
  0.

Both equations are convex and monotone on one side of their only root with positive tension; Newton's method
started on that side cannot miss it. Plain floats: an integrator calls this for one radius at a time.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf, sqrt
from typing import NamedTuple

MAX_NEWTON = 100
ROUNDING = 4e-16


class Slope(NamedTuple):
    """The line derivative at a radius, and what follows from it.

    radial, turn, axial : r', r phi', z'.
    hoop_force : dW/d(r / R).
    energy : energy density.
    switch : E2 + nu E1, positive where tense.
    """

    radial: float
    turn: float
    axial: float
    hoop_force: float
    energy: float
    switch: float


@dataclass(frozen=True)
class Momenta:
    """Torque G = R r P_phi and axial force Q = R P_z, constant over the sheet, and its Poisson ratio."""

    poisson: float
    torque: float
    axial: float

    def tense(self, radius: float, r: float, p: float) -> Slope:
        """Return the line derivative at `radius` of the tense branch."""
        nu, modulus, mu = self.poisson, 1.0 / (1.0 - self.poisson**2), 0.5 / (1.0 + self.poisson)
        hoop = r / radius
        e22 = 0.5 * (hoop - 1.0) * (hoop + 1.0)
        radial, turn, axial = p / radius, self.torque / (r * radius), self.axial / radius
        straight, across, shear = radial**2 + axial**2, turn**2, mu * hoop**2
        # below the root the left side is the larger one, and it stays so along Newton's steps from this bound
        offset = max(0.5 * modulus * (1.0 - 2.0 * nu * e22), 0.0)
        stress = min(
            (0.25 * modulus * straight) ** (1 / 3),
            sqrt(0.25 * modulus * straight / offset) if offset else inf,
        )
        for _ in range(MAX_NEWTON):
            sheared = stress + shear
            first, second = straight / stress**2, across / sheared**2
            value = modulus * (0.5 * (first + second - 1.0) + nu * e22) - stress
            change = value / (modulus * (first / stress + second / sheared) + 1.0)
            stress += change
            if change <= ROUNDING * stress:
                break
        radial, turn, axial = radial / stress, turn / (stress + shear), axial / stress
        e11 = 0.5 * (radial**2 + axial**2 + turn**2 - 1.0)
        e12 = 0.5 * turn * hoop
        mean, spread = 0.5 * (e11 + e22), hypot(0.5 * (e11 - e22), e12)
        major, minor = mean + spread, mean - spread
        switch = minor + nu * major
        hoop_force = 2.0 * mu * e12 * turn + modulus * (e22 + nu * e11) * hoop
        return Slope(radial, turn, axial, hoop_force, 0.5 * major**2 + 0.5 * modulus * switch**2, switch)

    def wrinkled(self, radius: float, r: float, p: float) -> Slope:
        """Return the line derivative at `radius` of the wrinkled branch."""
        turning = self.torque / r
        constant = sqrt(p**2 + turning**2 + self.axial**2)  # C
        m_r, m_phi, m_z = p / constant, turning / constant, self.axial / constant
        lever = r * m_phi  # t
        gap = (radius - lever) * (radius + lever)
        strain = excess(radius, gap, constant)
        stretch = sqrt(1.0 + strain)
        cosine = 2.0 * constant / (radius * stretch * strain)
        sine = lever / (radius * stretch)
        tangent, hoop = sine / cosine, r / radius
        # a = l cos(alpha) m - tan(alpha) (b - (b . m) m)
        along = stretch * cosine + tangent * hoop * m_phi
        radial, turn, axial = along * m_r, along * m_phi - tangent * hoop, along * m_z
        width = hoop * hypot(m_r, m_z) / cosine
        hoop_force = 0.5 * stretch * strain * sine * m_phi
        switch = 0.5 * (width - 1.0) * (width + 1.0) + 0.5 * self.poisson * strain
        return Slope(radial, turn, axial, hoop_force, 0.125 * strain**2, switch)


def excess(radius: float, gap: float, constant: float) -> float:
    """Return the root e = l^2 - 1 > 0 of R^2 e^3 + (R^2 - t^2) e^2 - 4 C^2 = 0, with `gap` = R^2 - t^2."""
    square, load = radius**2, 4.0 * constant**2
    bound = (
        (load / square) ** (1 / 3)
        if gap >= 0.0
        else max(-2.0 * gap / square, (2.0 * load / square) ** (1 / 3))
    )
    root = min(bound, sqrt(load / gap)) if gap > 0.0 else bound
    for _ in range(MAX_NEWTON):
        change = ((square * root + gap) * root**2 - load) / ((3.0 * square * root + 2.0 * gap) * root)
        root -= change
        if abs(change) <= ROUNDING * root:
            break
    return root
