"""Kernel of the relaxed membrane along its central path: stress as a complementary partner of the strain.

Pipkin's tension <E1> and minor stress <E2 + nu E1> / (1 - nu^2) are s with s >= 0, s - x >= 0 and s (s - x) = 0, where
x is E1 or E2 + nu E1. On the central path s (s - x) = m instead, so s = (x + sqrt(x^2 + 4 m)) / 2: a smooth energy with
a small tension in slack zones, which for m -> 0 becomes the relaxed one. A primal-dual step (Kojima, Mizuno and
Yoshise 1989) linearises the product with s as an unknown of its own, eliminated zone by zone: the modulus of a zone is
then s / (2 s - x), which neither jumps from 1 to 0 nor vanishes where a slack zone may become taut.
"""

from __future__ import annotations

import numpy as np

from fdsolver.rows import compiled


@compiled
def _zone(r, zone, i, j, F):
    """Gradient F (components, 2) of a zone; returns E1, E2, cosine and sine of the direction of E1, and E1 - E2."""
    components, rows, _ = r.shape
    after = i + 1 if i + 1 < rows else 0
    c11, c22, c12 = 0.0, 0.0, 0.0
    for c in range(components):
        d1, d2 = r[c, after, j + 1] - r[c, i, j], r[c, i, j + 1] - r[c, after, j]
        F[c, 0] = d1 * zone[0, i, j] + d2 * zone[2, i, j]
        F[c, 1] = d1 * zone[1, i, j] + d2 * zone[3, i, j]
        c11 += F[c, 0] * F[c, 0]
        c22 += F[c, 1] * F[c, 1]
        c12 += F[c, 0] * F[c, 1]
    half, shear = 0.25 * (c11 - c22), 0.5 * c12
    radius, mean = np.sqrt(half * half + shear * shear), 0.25 * (c11 + c22) - 0.5
    angle = 0.5 * np.arctan2(shear, half)
    return mean + radius, mean - radius, np.cos(angle), np.sin(angle), 2.0 * radius


@compiled
def central(x, m):
    """The s > 0 with s (s - x) = m."""
    root = np.sqrt(x * x + 4.0 * m)
    return 0.5 * (x + root) if x > 0.0 else 2.0 * m / (root - x)


@compiled
def _density(x, m):
    """Integral of `central` over x, but for a constant."""
    s = central(x, m)
    return 0.5 * s * s + m * np.log(s)


@compiled
def _pull(f, t, F, zone, i, j, s11, s22, s12):
    """Add the forces of a zone with the stress s to its corners; t is the area."""
    components, rows, _ = f.shape
    after = i + 1 if i + 1 < rows else 0
    for c in range(components):
        p1, p2 = t * (F[c, 0] * s11 + F[c, 1] * s12), t * (F[c, 0] * s12 + F[c, 1] * s22)
        t1, t2 = p1 * zone[0, i, j] + p2 * zone[1, i, j], p1 * zone[2, i, j] + p2 * zone[3, i, j]
        f[c, i, j] += t1
        f[c, after, j + 1] -= t1
        f[c, after, j] += t2
        f[c, i, j + 1] -= t2


@compiled
def central_force(r, zone, poisson, m, f):
    """Write the force of the smooth energy of m into f (components, ni, nj); return that energy."""
    f[:] = 0.0
    F, energy, plane = np.zeros((3, 2)), 0.0, 1.0 - poisson * poisson
    for i in range(zone.shape[1]):
        for j in range(zone.shape[2]):
            major, minor, co, si, _ = _zone(r, zone, i, j, F)
            tension, lateral = central(major, m), central(minor + poisson * major, m) / plane
            energy += zone[4, i, j] * (_density(major, m) + _density(minor + poisson * major, m) / plane)
            s1, s2 = tension + poisson * lateral, lateral
            s11, s22, s12 = co * co * s1 + si * si * s2, si * si * s1 + co * co * s2, co * si * (s1 - s2)
            _pull(f, zone[4, i, j], F, zone, i, j, s11, s22, s12)
    return energy


@compiled
def recentre(r, zone, poisson, m, s):
    """Put those partners s (2, zone rows, nj - 1) on the central path that are not inside their bounds."""
    F = np.zeros((3, 2))
    for i in range(zone.shape[1]):
        for j in range(zone.shape[2]):
            major, minor, _, _, _ = _zone(r, zone, i, j, F)
            for k in range(2):
                x = major if k == 0 else minor + poisson * major
                if not (s[k, i, j] > 0.0 and s[k, i, j] > x):
                    s[k, i, j] = central(x, m)


@compiled
def newton_system(r, zone, poisson, m, s, values, f):
    """The matrix (see `Tangent`, reach 1) and the right-hand side f of a primal-dual step."""
    components, rows, _ = r.shape
    values[:], f[:] = 0.0, 0.0
    plane = 1.0 - poisson * poisson
    F, moduli, turn, B, D = (
        np.zeros((3, 2)),
        np.zeros((3, 3)),
        np.zeros((3, 3)),
        np.zeros((2, 3, 3)),
        np.zeros((3, 3)),
    )
    # corners a, b, c, d: their diagonal, and whether it begins or ends there
    diagonal, sign, across, along = (0, 1, 0, 1), (-1.0, -1.0, 1.0, 1.0), (0, 1, 1, 0), (0, 0, 1, 1)
    for i in range(zone.shape[1]):
        for j in range(zone.shape[2]):
            major, minor, co, si, gap = _zone(r, zone, i, j, F)
            a, b, area = s[0, i, j], s[1, i, j], zone[4, i, j]
            p, q = 2.0 * a - major, 2.0 * b - minor - poisson * major
            k1, k2 = a / p, b / (q * plane)
            s1, s2 = a + poisson * b / plane, b / plane
            moduli[:] = 0.0
            moduli[0, 0], moduli[0, 1], moduli[1, 0], moduli[1, 1] = (
                k1 + poisson * poisson * k2,
                poisson * k2,
                poisson * k2,
                k2,
            )
            moduli[2, 2] = max(s1 - s2, 0.0) / (2.0 * gap + 1e-300)
            turn[0, 0], turn[0, 1], turn[0, 2] = co * co, si * si, co * si
            turn[1, 0], turn[1, 1], turn[1, 2] = si * si, co * co, -co * si
            turn[2, 0], turn[2, 1], turn[2, 2] = -2.0 * co * si, 2.0 * co * si, co * co - si * si
            for u in range(3):
                for v in range(3):
                    D[u, v] = 0.0
                    for w in range(3):
                        for x in range(3):
                            D[u, v] += turn[w, u] * moduli[w, x] * turn[x, v]
            tension = a + (m - a * (a - major)) / p
            lateral = (b + (m - b * (q - b)) / q) / plane
            n1, n2 = tension + poisson * lateral, lateral
            s11, s22, s12 = co * co * n1 + si * si * n2, si * si * n1 + co * co * n2, co * si * (n1 - n2)
            _pull(f, area, F, zone, i, j, s11, s22, s12)
            s11, s22, s12 = co * co * s1 + si * si * s2, si * si * s1 + co * co * s2, co * si * (s1 - s2)
            for k in range(2):
                gx, gy = zone[2 * k, i, j], zone[2 * k + 1, i, j]
                for c in range(components):
                    B[k, 0, c], B[k, 1, c], B[k, 2, c] = (
                        F[c, 0] * gx,
                        F[c, 1] * gy,
                        F[c, 0] * gy + F[c, 1] * gx,
                    )
            for k in range(2):
                gx, gy = zone[2 * k, i, j], zone[2 * k + 1, i, j]
                for n in range(2):
                    hx, hy = zone[2 * n, i, j], zone[2 * n + 1, i, j]
                    geometric = s11 * gx * hx + s22 * gy * hy + s12 * (gx * hy + gy * hx)
                    for c in range(components):
                        for e in range(components):
                            entry = geometric if c == e else 0.0
                            for u in range(3):
                                for v in range(3):
                                    entry += B[k, u, c] * D[u, v] * B[n, v, e]
                            for one in range(4):
                                for other in range(4):
                                    if diagonal[one] == k and diagonal[other] == n:
                                        row = i + across[one] if i + across[one] < rows else 0
                                        values[
                                            row,
                                            j + along[one],
                                            across[other] - across[one] + 1,
                                            along[other] - along[one] + 1,
                                            c,
                                            e,
                                        ] += sign[one] * sign[other] * area * entry


@compiled
def advance(r, p, zone, poisson, m, share, s):
    """Move the partners by their linear change along the share of the step p, at most to a twentieth."""
    components, rows, _ = r.shape
    F = np.zeros((3, 2))
    for i in range(zone.shape[1]):
        after = i + 1 if i + 1 < rows else 0
        for j in range(zone.shape[2]):
            major, minor, co, si, _ = _zone(r, zone, i, j, F)
            e11, e22, e12 = 0.0, 0.0, 0.0
            for c in range(components):
                d1, d2 = p[c, after, j + 1] - p[c, i, j], p[c, i, j + 1] - p[c, after, j]
                h1, h2 = d1 * zone[0, i, j] + d2 * zone[2, i, j], d1 * zone[1, i, j] + d2 * zone[3, i, j]
                e11 += F[c, 0] * h1
                e22 += F[c, 1] * h2
                e12 += 0.5 * (F[c, 0] * h2 + F[c, 1] * h1)
            change1 = co * co * e11 + si * si * e22 + 2.0 * co * si * e12
            change2 = si * si * e11 + co * co * e22 - 2.0 * co * si * e12
            for k in range(2):
                x = major if k == 0 else minor + poisson * major
                dx = change1 if k == 0 else change2 + poisson * change1
                old = s[k, i, j]
                new = old + share * (old * dx + m - old * (old - x)) / (2.0 * old - x)
                s[k, i, j] = max(new, 0.05 * old)
