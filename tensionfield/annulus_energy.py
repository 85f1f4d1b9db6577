"""Relaxed membrane energy of an axisymmetric annulus in its line derivatives (Pipkin 1986).

In the frame that turns with the deformed angle, the deformation gradient of r(R), phi(R), z(R) has the radial
column (r', r phi', z') and the hoop column (0, r / R, 0). `line` below is the array of these four numbers,

    line : (..., 4) = (r', r phi', z', r / R),

and E11, E22, E12 are the Green strains of the radial and hoop directions. Stresses are in units of Young's
modulus. A *branch* is one smooth formula of the relaxed energy, continued beyond the zone in which it is the
energy.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
States = NDArray[np.int64]

SLACK, WRINKLED, TENSE = 0, 1, 2


def strains(line: Array) -> tuple[Array, Array, Array]:
    """Return the Green strains E11, E22, E12, each (...), of `line` (..., 4)."""
    radial, turn, axial, hoop = np.moveaxis(line, -1, 0)
    return (
        0.5 * ((radial - 1.0) * (radial + 1.0) + turn**2 + axial**2),
        0.5 * (hoop - 1.0) * (hoop + 1.0),
        0.5 * turn * hoop,
    )


def principal_strains(line: Array) -> tuple[Array, Array]:
    """Return the principal Green strains E1 >= E2, each (...), of `line` (..., 4)."""
    e11, e22, e12 = strains(line)
    mean, radius = 0.5 * (e11 + e22), np.hypot(0.5 * (e11 - e22), e12)
    return mean + radius, mean - radius


def zone_state(line: Array, poisson: float) -> States:
    """Return the state (...), 0 slack, 1 wrinkled, 2 tense, of `line` (..., 4)."""
    major, minor = principal_strains(line)
    return np.where(major <= 0.0, SLACK, np.where(minor > -poisson * major, TENSE, WRINKLED))


def switch_function(line: Array, poisson: float) -> Array:
    """Return E2 + nu E1 (...), positive where the sheet is tense and negative where it is wrinkled."""
    major, minor = principal_strains(line)
    return minor + poisson * major


def energy(line: Array, poisson: float, branch: States | int) -> Array:
    """Return the energy per reference area over Y h, (...), of `line` (..., 4) on its `branch` (...)."""
    major, minor = principal_strains(line)
    wrinkled = 0.5 * major**2
    tense = wrinkled + 0.5 * (minor + poisson * major) ** 2 / (1.0 - poisson**2)
    return np.where(branch == TENSE, tense, np.where(branch == WRINKLED, wrinkled, 0.0))


def stress_and_modulus(line: Array, poisson: float, branch: States | int) -> tuple[Array, Array]:
    """Return the first and second derivatives of the energy with respect to E11, E22, E12.

    Returns (..., 3) and (..., 3, 3); the third entry of the first belongs to E12 and is twice the shear
    stress.
    """
    e11, e22, e12 = strains(line)
    half, shear = 0.5 * (e11 - e22), e12
    # the floor keeps an isotropic state finite; only the wrinkled branch uses this radius and there it is
    # positive
    radius = np.maximum(np.hypot(half, shear), 1e-300)
    major = 0.5 * (e11 + e22) + radius
    cosine, sine = half / radius, shear / radius  # of twice the angle of the major direction
    direction = np.stack([0.5 * (1.0 + cosine), 0.5 * (1.0 - cosine), sine], axis=-1)
    turn = np.stack([-0.5 * sine, 0.5 * sine, cosine], axis=-1)
    wrinkled_stress = major[..., None] * direction
    wrinkled_modulus = direction[..., :, None] * direction[..., None, :]
    wrinkled_modulus = (
        wrinkled_modulus + (major / radius)[..., None, None] * turn[..., :, None] * turn[..., None, :]
    )
    tense_modulus = np.array([[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, 2.0 * (1.0 - poisson)]])
    tense_modulus /= 1.0 - poisson**2
    tense_stress = np.stack([e11, e22, e12], axis=-1) @ tense_modulus
    branch = np.broadcast_to(branch, e11.shape)
    tense, slack = (branch == TENSE)[..., None], (branch == SLACK)[..., None]
    stress = np.where(slack, 0.0, np.where(tense, tense_stress, wrinkled_stress))
    modulus = np.where(slack[..., None], 0.0, np.where(tense[..., None], tense_modulus, wrinkled_modulus))
    return stress, modulus


def force_and_tangent(line: Array, poisson: float, branch: States | int) -> tuple[Array, Array]:
    """Return the first (..., 4) and second (..., 4, 4) derivatives of the energy with respect to `line`."""
    stress, modulus = stress_and_modulus(line, poisson, branch)
    radial, turn, axial, hoop = np.moveaxis(line, -1, 0)
    jacobian = np.zeros((*line.shape[:-1], 3, 4))
    jacobian[..., 0, 0], jacobian[..., 0, 1], jacobian[..., 0, 2] = radial, turn, axial
    jacobian[..., 1, 3] = hoop
    jacobian[..., 2, 1], jacobian[..., 2, 3] = 0.5 * hoop, 0.5 * turn
    force = np.einsum("...k,...ki->...i", stress, jacobian)
    tangent = np.swapaxes(jacobian, -1, -2) @ modulus @ jacobian
    for i in range(3):
        tangent[..., i, i] += stress[..., 0]
    tangent[..., 3, 3] += stress[..., 1]
    tangent[..., 1, 3] += 0.5 * stress[..., 2]
    tangent[..., 3, 1] += 0.5 * stress[..., 2]
    return force, tangent
