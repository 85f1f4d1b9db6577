"""The Koiter energy per unit area of a thin sheet, with its exact gradient and Hessian.

With the tangents F_a = r,a, the Green strain E_ab = (F_a . F_b - delta_ab) / 2, the normal n = F_1 x F_2 / J, J its
length, and the curvature b_ab = n . r,ab (Steigmann 2013; Taylor, Bertoldi and Steigmann 2014, Eq. 24):

    W = h/2 (c (tr E)^2 + 2 mu E:E) + h^3/24 (c (tr b)^2 + 2 mu b:b),  c = Y nu / (1 - nu^2),  2 mu = Y / (1 + nu)

W is a function of the five vectors r,1  r,2  r,11  r,12  r,22: rows of `d` (5, 3), physical components on an orthogonal
coordinate net. The Hessian (15, 15) has them in the same order. Second derivatives of the normal are kept: nothing here
assumes small strain or small rotation.
"""

from __future__ import annotations

import numpy as np

from femref.compiled import compiled


def moduli(young_MPa: float, poisson: float, thickness_mm: float) -> np.ndarray:
    """(4,): h c, h mu (N/mm) and h^3/12 c, h^3/12 mu (N mm).

    Raises ValueError for values outside Y > 0, -1 < nu <= 1/2, h > 0.
    """
    if not (young_MPa > 0.0 and -1.0 < poisson <= 0.5 and thickness_mm > 0.0):
        raise ValueError("a sheet needs young_MPa > 0, -1 < poisson <= 0.5 and thickness_mm > 0")
    c = young_MPa * poisson / (1.0 - poisson**2)
    mu = 0.5 * young_MPa / (1.0 + poisson)
    return np.array([c, mu, c, mu]) * np.repeat([thickness_mm, thickness_mm**3 / 12.0], 2)


@compiled(inline="always")
def _cross(a, b, out):
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@compiled(inline="always")
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled()
def density(d, moduli, membrane_only, gradient):
    """Membrane and bending energy per area (N/mm) of the derivatives d (5, 3); dW/dd into gradient (5, 3).

    membrane_only : leave bending out.
    """
    c, mu, bend_c, bend_mu = moduli[0], moduli[1], moduli[2], moduli[3]
    f1, f2 = d[0], d[1]
    e11, e22, e12 = 0.5 * (_dot(f1, f1) - 1.0), 0.5 * (_dot(f2, f2) - 1.0), 0.5 * _dot(f1, f2)
    trace = c * (e11 + e22)
    s11, s22, s12 = trace + 2.0 * mu * e11, trace + 2.0 * mu * e22, 2.0 * mu * e12
    membrane = 0.5 * (s11 * e11 + s22 * e22 + 2.0 * s12 * e12)
    for k in range(3):
        gradient[0, k] = s11 * f1[k] + s12 * f2[k]
        gradient[1, k] = s12 * f1[k] + s22 * f2[k]
        gradient[2, k] = gradient[3, k] = gradient[4, k] = 0.0
    if membrane_only:
        return membrane, 0.0
    n, v, part = np.empty(3), np.empty(3), np.empty(3)
    _cross(f1, f2, n)
    length = np.sqrt(_dot(n, n))
    for k in range(3):
        n[k] /= length
    b11, b12, b22 = _dot(n, d[2]), _dot(n, d[3]), _dot(n, d[4])
    trace = bend_c * (b11 + b22)
    m11, m12, m22 = trace + 2.0 * bend_mu * b11, 2.0 * bend_mu * b12, trace + 2.0 * bend_mu * b22
    turned = m11 * b11 + 2.0 * m12 * b12 + m22 * b22
    for k in range(3):
        # v = sum of m_ab (r,ab - b_ab n) / J: the derivative of the moments' work with respect to F_1 x F_2
        v[k] = (m11 * d[2, k] + 2.0 * m12 * d[3, k] + m22 * d[4, k] - turned * n[k]) / length
        gradient[2, k] = m11 * n[k]
        gradient[3, k] = 2.0 * m12 * n[k]
        gradient[4, k] = m22 * n[k]
    _cross(f2, v, part)
    for k in range(3):
        gradient[0, k] += part[k]
    _cross(v, f1, part)
    for k in range(3):
        gradient[1, k] += part[k]
    return membrane, 0.5 * turned


@compiled()
def density_hessian(d, moduli, membrane_only, hessian):
    """d2W/dd2 into hessian (15, 15), row 3 p + k for component k of the derivative p."""
    hessian[:] = 0.0
    _membrane_hessian(d, moduli, hessian)
    if not membrane_only:
        _bending_hessian(d, moduli, hessian)


@compiled()
def _membrane_hessian(d, moduli, hessian):
    """h (S_ab delta_kl + c F_ka F_lb + mu (F_kb F_la + delta_ab F_kc F_lc))."""
    c, mu = moduli[0], moduli[1]
    f1, f2 = d[0], d[1]
    e11, e22, e12 = 0.5 * (_dot(f1, f1) - 1.0), 0.5 * (_dot(f2, f2) - 1.0), 0.5 * _dot(f1, f2)
    trace = c * (e11 + e22)
    stress = ((trace + 2.0 * mu * e11, 2.0 * mu * e12), (2.0 * mu * e12, trace + 2.0 * mu * e22))
    for a in range(2):
        for b in range(2):
            for k in range(3):
                hessian[3 * a + k, 3 * b + k] += stress[a][b]
                for m in range(3):
                    value = c * d[a, k] * d[b, m] + mu * d[b, k] * d[a, m]
                    if a == b:
                        value += mu * (f1[k] * f1[m] + f2[k] * f2[m])
                    hessian[3 * a + k, 3 * b + m] += value


@compiled()
def _bending_hessian(d, moduli, hessian):
    """sum over curvatures I, J of db_I D_IJ db_J, and of the moments m_I times d2b_I."""
    bend_c, bend_mu = moduli[2], moduli[3]
    f1, f2 = d[0], d[1]
    n = np.empty(3)
    _cross(f1, f2, n)
    length = np.sqrt(_dot(n, n))
    for k in range(3):
        n[k] /= length
    slopes = np.zeros((3, 15))  # of b11, b12, b22
    v, part = np.empty(3), np.empty(3)
    b = np.empty(3)
    for p in range(3):
        b[p] = _dot(n, d[2 + p])
        for k in range(3):
            v[k] = (d[2 + p, k] - b[p] * n[k]) / length
        _cross(f2, v, part)
        slopes[p, 0:3] = part
        _cross(v, f1, part)
        slopes[p, 3:6] = part
        slopes[p, 6 + 3 * p : 9 + 3 * p] = n
    straight, mixed, twist = bend_c + 2.0 * bend_mu, bend_c, 4.0 * bend_mu
    moment = (straight * b[0] + mixed * b[2], twist * b[1], mixed * b[0] + straight * b[2])
    for p in range(15):
        first = straight * slopes[0, p] + mixed * slopes[2, p]
        middle = twist * slopes[1, p]
        last = mixed * slopes[0, p] + straight * slopes[2, p]
        for q in range(15):
            hessian[p, q] += first * slopes[0, q] + middle * slopes[1, q] + last * slopes[2, q]
    _curvature_second_derivatives(d, n, length, b, moment, hessian)


@compiled()
def _curvature_second_derivatives(d, n, length, b, moment, hessian):
    """sum over I of m_I d2b_I, b_I = n . r,I; by the area vector A = F_1 x F_2 = J n.

    d2b_I / dA dA = (-g n - n g - b 1 + 3 b n n) / J^2 with g = r,I;  d2b_I / dA dg = (1 - n n) / J.
    """
    f1, f2 = d[0], d[1]
    g, v = np.empty(3), np.empty(3)
    work = moment[0] * b[0] + moment[1] * b[1] + moment[2] * b[2]
    for k in range(3):
        g[k] = moment[0] * d[2, k] + moment[1] * d[3, k] + moment[2] * d[4, k]
        v[k] = (g[k] - work * n[k]) / length
    # dA = area[0] dF_1 + area[1] dF_2
    area = np.zeros((2, 3, 3))
    for a, f, sign in ((0, f2, -1.0), (1, f1, 1.0)):
        area[a, 0, 1], area[a, 1, 2], area[a, 2, 0] = -sign * f[2], -sign * f[0], -sign * f[1]
        area[a, 1, 0], area[a, 2, 1], area[a, 0, 2] = sign * f[2], sign * f[0], sign * f[1]
    second, tangent = np.empty((3, 3)), np.empty((3, 3))
    for k in range(3):
        for m in range(3):
            one = 1.0 if k == m else 0.0
            second[k, m] = (-g[k] * n[m] - n[k] * g[m] - work * one + 3.0 * work * n[k] * n[m]) / length**2
            tangent[k, m] = (one - n[k] * n[m]) / length
    folded = np.empty((3, 3))
    for a in range(2):
        for k in range(3):
            for m in range(3):
                mixed = 0.0
                for s in range(3):
                    mixed += area[a, s, k] * tangent[s, m]
                for p in range(3):
                    hessian[3 * a + k, 6 + 3 * p + m] += moment[p] * mixed
                    hessian[6 + 3 * p + m, 3 * a + k] += moment[p] * mixed
        for c in range(2):
            for k in range(3):
                for m in range(3):
                    folded[k, m] = 0.0
                    for s in range(3):
                        folded[k, m] += second[k, s] * area[c, s, m]
            for k in range(3):
                for m in range(3):
                    for s in range(3):
                        hessian[3 * a + k, 3 * c + m] += area[a, s, k] * folded[s, m]
    # v . (dF_1 x dF_2), the second derivative of A itself
    for k, m, s in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        hessian[k, 3 + m] += v[s]
        hessian[m, 3 + k] -= v[s]
        hessian[3 + m, k] += v[s]
        hessian[3 + k, m] -= v[s]
