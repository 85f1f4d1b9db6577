"""Kernel of the relaxed membrane as a problem in two fields: where its nodes are, and how much each zone wrinkles.

Pipkin's energy (IMA J. Appl. Math. 36, 1986) is the least energy that a zone can have by wrinkling, which shortens its
chords without straining it: W_relaxed(E) = min W(E + B) over wrinkling strains B >= 0. The stress S = D : (E + B) is
then positive semidefinite as well, and S B = 0: a tense zone has no B, a slack one no S, a wrinkled one a part of each.
On the central path S B = m 1 instead, so both are definite; m -> 0 leads to the relaxed membrane itself.

A primal-dual step linearises S = D : (E + B) and S B = m 1, the latter symmetrically about the scaling w with
w S w = B (Nesterov and Todd 1997): dB + w dS w = m S^-1 - B - c, with c the second-order term of the step before
(Mehrotra 1992). Eliminated zone by zone, they leave a positive definite system in the nodes alone, with the modulus
(D^-1 + w . w)^-1 and the stress S as geometric stiffness. All per zone: lengths L, stresses over Y.
S, B, dS, dB, c, q : (3, zone rows, nj - 1) float64, components 11, 22, 12. zone : see `membrane`.
"""

from __future__ import annotations

import numpy as np

from fdsolver import symmetric
from fdsolver.rows import compiled


@compiled
def _at(a, i, j):
    return a[0, i, j], a[1, i, j], a[2, i, j]


@compiled
def _put(a, i, j, value):
    a[0, i, j], a[1, i, j], a[2, i, j] = value


@compiled
def _gradient(r, zone, i, j, F):
    """Write the gradient of r (components, ni, nj) over a zone into F (components, 2)."""
    after = i + 1 if i + 1 < r.shape[1] else 0
    for c in range(r.shape[0]):
        d1, d2 = r[c, after, j + 1] - r[c, i, j], r[c, i, j + 1] - r[c, after, j]
        F[c, 0] = d1 * zone[0, i, j] + d2 * zone[2, i, j]
        F[c, 1] = d1 * zone[1, i, j] + d2 * zone[3, i, j]


@compiled
def _product(F, H):
    """The symmetric part of F^T H."""
    p11, p22, p12 = 0.0, 0.0, 0.0
    for c in range(F.shape[0]):
        p11 += F[c, 0] * H[c, 0]
        p22 += F[c, 1] * H[c, 1]
        p12 += 0.5 * (F[c, 0] * H[c, 1] + F[c, 1] * H[c, 0])
    return p11, p22, p12


@compiled
def _strain(F):
    """Green's strain."""
    c = _product(F, F)
    return 0.5 * c[0] - 0.5, 0.5 * c[1] - 0.5, 0.5 * c[2]


@compiled
def _gap(E, S, B, nu):
    """E + B - D^-1 : S, zero where the stress belongs to the strain."""
    return (
        E[0] + B[0] - S[0] + nu * S[1],
        E[1] + B[1] - S[1] + nu * S[0],
        E[2] + B[2] - (1.0 + nu) * S[2],
    )


@compiled
def _modulus(w, nu, M):
    """(D^-1 + w . w)^-1, from strains (11, 22, 2 x 12) to stresses (11, 22, 12).

    Made along the directions of w, whose eigenvalues differ by up to 1e16: elsewhere their ratio would be rounding.
    """
    w1, w2, co, si = symmetric.principal(w)
    a, b = w1 * w1, w2 * w2
    d = a + b + a * b + 1.0 - nu * nu
    m11, m22, m12, shear = (1.0 + b) / d, (1.0 + a) / d, nu / d, 0.5 / (1.0 + nu + w1 * w2)
    turn = (
        (co * co, si * si, co * si),
        (si * si, co * co, -co * si),
        (-2.0 * co * si, 2.0 * co * si, co * co - si * si),
    )
    for u in range(3):
        for v in range(3):
            M[u, v] = (
                turn[0][u] * (m11 * turn[0][v] + m12 * turn[1][v])
                + turn[1][u] * (m12 * turn[0][v] + m22 * turn[1][v])
                + turn[2][u] * shear * turn[2][v]
            )


@compiled
def _times(M, x):
    """M times a strain (11, 22, 12)."""
    return (
        M[0, 0] * x[0] + M[0, 1] * x[1] + 2.0 * M[0, 2] * x[2],
        M[1, 0] * x[0] + M[1, 1] * x[1] + 2.0 * M[1, 2] * x[2],
        M[2, 0] * x[0] + M[2, 1] * x[1] + 2.0 * M[2, 2] * x[2],
    )


@compiled
def _demand(gap, S, B, m, c, q):
    """What the strain of a step is added to before it makes stress."""
    s = symmetric.inverse(S)
    return (
        gap[0] + q[0] + m * s[0] - B[0] - c[0],
        gap[1] + q[1] + m * s[1] - B[1] - c[1],
        gap[2] + q[2] + m * s[2] - B[2] - c[2],
    )


@compiled
def centre(r, zone, nu, m, S, B):
    """Write the S and B of the central path at the positions r (components, ni, nj).

    Along the principal directions of strain: s1 - nu s2 = e1 + m / s1 and the same with 1 and 2 exchanged, by Newton.
    """
    F = np.zeros((r.shape[0], 2))
    for i in range(zone.shape[1]):
        for j in range(zone.shape[2]):
            _gradient(r, zone, i, j, F)
            E = _strain(F)
            half = 0.5 * (E[0] - E[1])
            angle, radius = 0.5 * np.arctan2(E[2], half), np.sqrt(half * half + E[2] * E[2])
            e1, e2 = 0.5 * (E[0] + E[1]) + radius, 0.5 * (E[0] + E[1]) - radius
            s1 = max(e1, 0.0) + np.sqrt(m)
            s2 = max((e2 + nu * e1) / (1.0 - nu * nu), 0.0) + np.sqrt(m)
            for _ in range(100):
                g1, g2 = s1 - nu * s2 - e1 - m / s1, s2 - nu * s1 - e2 - m / s2
                h1, h2 = 1.0 + m / (s1 * s1), 1.0 + m / (s2 * s2)
                d1, d2 = (
                    -(h2 * g1 + nu * g2) / (h1 * h2 - nu * nu),
                    -(h1 * g2 + nu * g1) / (h1 * h2 - nu * nu),
                )
                share = min(1.0, 0.9 / max(-d1 / s1, -d2 / s2, 0.9))
                s1, s2 = s1 + share * d1, s2 + share * d2
                if abs(d1) < 1e-14 * s1 and abs(d2) < 1e-14 * s2:
                    break
            co, si = np.cos(angle), np.sin(angle)
            _put(S, i, j, symmetric.along(s1, s2, 0.0, co, si))
            _put(B, i, j, symmetric.along(m / s1, m / s2, 0.0, co, si))


@compiled
def duality(zone, S, B):
    """Mean of S : B / 2 over the zones, which is m on the central path; zones without area are images of others."""
    total, count = 0.0, 0
    for i in range(S.shape[1]):
        for j in range(S.shape[2]):
            if zone[4, i, j] > 0.0:
                total += S[0, i, j] * B[0, i, j] + S[1, i, j] * B[1, i, j] + 2.0 * S[2, i, j] * B[2, i, j]
                count += 1
    return 0.5 * total / count


@compiled
def newton_matrix(r, zone, nu, S, B, values):
    """Write the matrix of a step at r into `values` (see `Tangent`, reach 1)."""
    components, rows, _ = r.shape
    values[:] = 0.0
    F, M, G = np.zeros((components, 2)), np.zeros((3, 3)), np.zeros((2, 3, components))
    # corners a, b, c, d: their diagonal, and whether it begins or ends there
    diagonal, sign, across, along = (0, 1, 0, 1), (-1.0, -1.0, 1.0, 1.0), (0, 1, 1, 0), (0, 0, 1, 1)
    for i in range(zone.shape[1]):
        for j in range(zone.shape[2]):
            _gradient(r, zone, i, j, F)
            s = _at(S, i, j)
            _modulus(symmetric.mean(_at(B, i, j), symmetric.inverse(s)), nu, M)
            for k in range(2):
                gx, gy = zone[2 * k, i, j], zone[2 * k + 1, i, j]
                for c in range(components):
                    G[k, 0, c], G[k, 1, c] = F[c, 0] * gx, F[c, 1] * gy
                    G[k, 2, c] = F[c, 0] * gy + F[c, 1] * gx
            for k in range(2):
                gx, gy = zone[2 * k, i, j], zone[2 * k + 1, i, j]
                for n in range(2):
                    hx, hy = zone[2 * n, i, j], zone[2 * n + 1, i, j]
                    geometric = s[0] * gx * hx + s[1] * gy * hy + s[2] * (gx * hy + gy * hx)
                    for c in range(components):
                        for e in range(components):
                            entry = geometric if c == e else 0.0
                            for u in range(3):
                                for v in range(3):
                                    entry += G[k, u, c] * M[u, v] * G[n, v, e]
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
                                        ] += sign[one] * sign[other] * zone[4, i, j] * entry


@compiled
def newton_force(r, zone, nu, m, S, B, c, q, f):
    """Write the right-hand side of a step towards m into f (components, ni, nj)."""
    components, rows, _ = r.shape
    f[:] = 0.0
    F, M = np.zeros((components, 2)), np.zeros((3, 3))
    for i in range(zone.shape[1]):
        after = i + 1 if i + 1 < rows else 0
        for j in range(zone.shape[2]):
            _gradient(r, zone, i, j, F)
            s, b = _at(S, i, j), _at(B, i, j)
            _modulus(symmetric.mean(b, symmetric.inverse(s)), nu, M)
            gap = _gap(_strain(F), s, b, nu)
            n = _times(M, _demand(gap, s, b, m, _at(c, i, j), _at(q, i, j)))
            n11, n22, n12 = s[0] + n[0], s[1] + n[1], s[2] + n[2]
            for k in range(components):
                p1 = zone[4, i, j] * (F[k, 0] * n11 + F[k, 1] * n12)
                p2 = zone[4, i, j] * (F[k, 0] * n12 + F[k, 1] * n22)
                t1 = p1 * zone[0, i, j] + p2 * zone[1, i, j]
                t2 = p1 * zone[2, i, j] + p2 * zone[3, i, j]
                f[k, i, j] += t1
                f[k, after, j + 1] -= t1
                f[k, after, j] += t2
                f[k, i, j + 1] -= t2


@compiled
def changes(r, p, zone, nu, m, S, B, c, q, dS, dB):
    """Write what a step p (components, ni, nj) does to S and B; returns how much of it leaves both definite."""
    F, H, M = np.zeros((r.shape[0], 2)), np.zeros((r.shape[0], 2)), np.zeros((3, 3))
    most = np.inf
    for i in range(zone.shape[1]):
        for j in range(zone.shape[2]):
            _gradient(r, zone, i, j, F)
            _gradient(p, zone, i, j, H)
            s, b, e, u = _at(S, i, j), _at(B, i, j), _product(F, H), _at(q, i, j)
            _modulus(symmetric.mean(b, symmetric.inverse(s)), nu, M)
            gap = _gap(_strain(F), s, b, nu)
            d = _demand(gap, s, b, m, _at(c, i, j), u)
            t = _times(M, (d[0] + e[0], d[1] + e[1], d[2] + e[2]))
            # from the strain, not from w dS w, whose rounding is 1e16 times as large
            g = _gap(
                (e[0] + gap[0] + u[0], e[1] + gap[1] + u[1], e[2] + gap[2] + u[2]), t, (0.0, 0.0, 0.0), nu
            )
            x = -g[0], -g[1], -g[2]
            _put(dS, i, j, t)
            _put(dB, i, j, x)
            most = min(most, symmetric.longest(s, t), symmetric.longest(b, x))
    return most


@compiled
def second_order(p, zone, S, B, dS, dB, c, q):
    """Write the second-order terms of a step p: c of S B, and q of the strain."""
    H = np.zeros((p.shape[0], 2))
    for i in range(zone.shape[1]):
        for j in range(zone.shape[2]):
            _gradient(p, zone, i, j, H)
            h = _product(H, H)
            _put(q, i, j, (0.5 * h[0], 0.5 * h[1], 0.5 * h[2]))
            s = _at(S, i, j)
            w = symmetric.root(symmetric.mean(_at(B, i, j), symmetric.inverse(s)))
            x, y = symmetric.between(w, _at(dS, i, j)), symmetric.between(symmetric.inverse(w), _at(dB, i, j))
            z = symmetric.divided(symmetric.symmetric_product(x, y), symmetric.between(w, s))
            _put(c, i, j, symmetric.between(w, z))
