"""Taylor, Bertoldi and Steigmann (2014), Eqs. (52) to (65) and (77), as plain array formulas with their own indices.

Written from the paper, independent of the kernel; real or complex. Nodes are (ni + 2, nj + 2, ...), ghosts included,
zones (ni + 1, nj + 1, ...), all scaled: lengths by L, stresses by Y, forces by Y h L.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


def perpendicular(du: np.ndarray) -> np.ndarray:
    """e_ab du_b."""
    return np.stack([du[..., 1], -du[..., 0]], axis=-1)


def zone_gradient(f: np.ndarray, u: np.ndarray) -> np.ndarray:
    """f,a of a nodal field (..., m) in every zone, (..., m, 2) [57, 58]."""
    along, across = u[1:, 1:] - u[:-1, :-1], u[:-1, 1:] - u[1:, :-1]
    area = 0.5 * (across[..., 1] * along[..., 0] - across[..., 0] * along[..., 1])
    first, second = f[1:, 1:] - f[:-1, :-1], f[:-1, 1:] - f[1:, :-1]
    terms = (
        first[..., None] * perpendicular(across)[..., None, :]
        - second[..., None] * perpendicular(along)[..., None, :]
    )
    return terms / (2.0 * area)[..., None, None]


def contour(zone: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, ...]:
    """The four terms of the contour sums (52, 61) at the inner nodes; zone (..., m, 2) gives e_ab f_a du_b (..., m)."""
    north, east, south, west = u[1:-1, 2:], u[2:, 1:-1], u[1:-1, :-2], u[:-2, 1:-1]
    steps = (north - east, west - north, south - west, east - south)
    zones = (zone[1:, 1:], zone[:-1, 1:], zone[:-1, :-1], zone[1:, :-1])
    return tuple(
        np.sum(z * perpendicular(du)[..., None, :], axis=-1) for z, du in zip(zones, steps, strict=True)
    )


def node_area(u: np.ndarray) -> np.ndarray:
    """A [53] at the inner nodes."""
    west_east, north_south = u[:-2, 1:-1] - u[2:, 1:-1], u[1:-1, 2:] - u[1:-1, :-2]
    return 0.25 * (west_east[..., 1] * north_south[..., 0] - west_east[..., 0] * north_south[..., 1])


def mean_of_corners(node: np.ndarray) -> np.ndarray:
    """Average of a nodal field over the corners of every zone."""
    return 0.25 * (node[1:, 1:] + node[:-1, 1:] + node[1:, :-1] + node[:-1, :-1])


@dataclass(frozen=True)
class Bent:
    """Nodes of the sheet: normal (..., 3), curvature (..., 2, 2), F_ka,b (..., 3, 2, 2), M_kab (..., 3, 2, 2)."""

    normal: np.ndarray
    curvature: np.ndarray
    second: np.ndarray
    moment: np.ndarray


def bent(r: np.ndarray, u: np.ndarray, poisson: float, bending: float) -> Bent:
    """Eqs. (60) to (64), the latter with the four zones around the node, and (34)."""
    gradient = zone_gradient(r, u)
    area = node_area(u)[..., None, None]
    # F_ka,b: the contour sum of (F_ka, nothing) along b; e_bc du_c of the b-th component only
    second = np.stack(
        [sum(contour(np.stack([gradient[..., a], 0.0 * gradient[..., a]], axis=-1), u)) for a in (0, 1)]
        + [sum(contour(np.stack([0.0 * gradient[..., a], gradient[..., a]], axis=-1), u)) for a in (0, 1)],
        axis=-1,
    ).reshape(*area.shape[:2], 3, 2, 2)  # [..., k, b, a]
    second = np.swapaxes(second, -1, -2) / (2.0 * area[..., None])
    second = 0.5 * (second + np.swapaxes(second, -1, -2))
    areal = np.cross(gradient[..., 0], gradient[..., 1])
    total = areal[1:, 1:] + areal[:-1, 1:] + areal[:-1, :-1] + areal[1:, :-1]
    normal = total / np.sqrt(np.sum(total * total, axis=-1))[..., None]
    curvature = np.einsum("...k,...kab->...ab", normal, second)
    c, two_mu = poisson / (1.0 - poisson**2), 1.0 / (1.0 + poisson)
    trace = curvature[..., 0, 0] + curvature[..., 1, 1]
    couple = bending * (c * trace[..., None, None] * np.eye(2) + two_mu * curvature)
    return Bent(normal, curvature, second, normal[..., None, None] * couple[..., None, :, :])


def forces(r: np.ndarray, u: np.ndarray, poisson: float, bending: float) -> np.ndarray:
    """Sigma / 2 at the nodes of a free sheet, (ni, nj, 3) [31, 35, 36, 52, 55, 59, 65, 77]."""
    state = bent(r, u, poisson, bending)
    gradient = zone_gradient(r, u)[1:-1, 1:-1]
    strain = 0.5 * (np.einsum("...ka,...kb->...ab", gradient, gradient) - np.eye(2))
    c, two_mu = poisson / (1.0 - poisson**2), 1.0 / (1.0 + poisson)
    stress = c * (strain[..., 0, 0] + strain[..., 1, 1])[..., None, None] * np.eye(2) + two_mu * strain
    christoffel = np.einsum("...ka,...klm->...alm", gradient, mean_of_corners(state.second))
    n = np.einsum("...kb,...ba->...ka", gradient, stress)
    n -= np.einsum("...klm,...alm->...ka", mean_of_corners(state.moment), christoffel)
    sheet = u[1:-1, 1:-1]
    flat_moment = state.moment.reshape(*state.moment.shape[:2], 12)
    slopes = zone_gradient(flat_moment, sheet).reshape(*gradient.shape[:2], 3, 2, 2, 2)
    traction = n - np.einsum("...kabb->...ka", slopes)
    outside = np.zeros((u.shape[0] - 1, u.shape[1] - 1, 3, 2), dtype=traction.dtype)
    outside[1:-1, 1:-1] = traction
    sigma = sum(contour(outside, u))
    return 0.5 * (sigma + edge_differences(state.moment[..., 0, 1]))


def edge_differences(twist: np.ndarray) -> np.ndarray:
    """The differences of M_kab nu_a tau_b along the edges (77), odd beyond the corners. twist : M_k12 (ni, nj, 3)."""
    result = np.zeros_like(twist)
    for line, sign in (
        ((0, slice(None)), -1),
        ((-1, slice(None)), 1),
        ((slice(None), 0), -1),
        ((slice(None), -1), 1),
    ):
        m = twist[line]
        m = np.concatenate([-m[:1], m, -m[-1:]])
        result[line] += sign * (m[2:] - m[:-2])
    return result


def bending_energy(
    r: np.ndarray, u: np.ndarray, poisson: float, bending: float, share: np.ndarray
) -> np.ndarray:
    """Sum over the nodes of A W_b(b); share : (ni, nj) area of the sheet at the node."""
    state = bent(r, u, poisson, bending)
    couple = np.einsum("...k,...kab->...ab", state.normal, state.moment)
    return 0.5 * np.sum(share * np.sum(couple * state.curvature, axis=(-1, -2)))
