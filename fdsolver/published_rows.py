"""Row stages of the kernel of the published scheme; `published` puts them in order.

Each stage is one equation of Taylor, Bertoldi and Steigmann (2014), for a row of zones or nodes. A zone has the corners
a = (i, j), b = (i+1, j), c = (i+1, j+1), d = (i, j+1), and A f,a = (f_c - f_a) A g1 + (f_d - f_b) A g2 for any nodal
field [57, 59]. A node is the corner a of its north-east zone, b of the north-west, c of the south-west and d of the
south-east one, and the contour sums [52, 61] are A f,a = (A g1 f)_NE + (A g2 f)_NW - (A g1 f)_SW - (A g2 f)_SE.
"""

from __future__ import annotations

from fdsolver import membrane
from fdsolver.membrane import (
    AREA,
    G1X,
    G1Y,
    G2X,
    G2Y,
    T1X,
    T1Y,
    T1Z,
    T2X,
    T2Y,
    T2Z,
    XA,
    XB,
    YA,
    YB,
    ZA,
    ZB,
    stress,
)
from fdsolver.rows import ONE, compiled, load, move, slots

XP, YP, ZP = slots(3, membrane.SLOTS)  # positions of the node row before XA
# Zone rows i - 1 (old) and i (new): gradient [57], area normal [63], contour weights A g1, A g2.
OLD_ZONE = slots(13, membrane.SLOTS + 3)
NEW_ZONE = slots(13, membrane.SLOTS + 16)
OLD_X1, OLD_X2, OLD_Y1, OLD_Y2, OLD_Z1, OLD_Z2, OLD_WX, OLD_WY, OLD_WZ, OLD_A1X, OLD_A1Y, OLD_A2X, OLD_A2Y = (
    OLD_ZONE
)
NEW_X1, NEW_X2, NEW_Y1, NEW_Y2, NEW_Z1, NEW_Z2, NEW_WX, NEW_WY, NEW_WZ, NEW_A1X, NEW_A1Y, NEW_A2X, NEW_A2Y = (
    NEW_ZONE
)
# Node rows i - 1 (old) and i (new): second gradient [61] and moments [34], components 11, 12, 22 of x, y and z.
OLD_NODE = slots(19, membrane.SLOTS + 29)
NEW_NODE = slots(19, membrane.SLOTS + 48)
OLD_H, OLD_M, OLD_B12 = OLD_NODE[:9], OLD_NODE[9:18], OLD_NODE[18]
NEW_H, NEW_M, NEW_B12 = NEW_NODE[:9], NEW_NODE[9:18], NEW_NODE[18]
NX, NY, NZ, M11, M22 = slots(5, membrane.SLOTS + 67)  # normal [64] and moments of node row i
INVERSE, SHARE = slots(2, membrane.SLOTS + 72)  # 1 / A of [53]; area of the sheet at the node
# Christoffel symbols [65] of zone row i - 1: 1 with 11, 12, 22, then 2 with 11, 12, 22
GAMMA111, GAMMA112, GAMMA122, GAMMA211, GAMMA212, GAMMA222 = slots(6, membrane.SLOTS + 74)
HOURGLASS, QX, QY, QZ = slots(4, membrane.SLOTS + 80)
SLOTS = membrane.SLOTS + 84


@compiled
def gradient_row(s, columns):
    """Deformation gradient [57] and area normal [63] of zone row i, from node rows i and i + 1."""
    for j in range(columns):
        d1x, d1y, d1z = s[XB + ONE + j] - s[XA + j], s[YB + ONE + j] - s[YA + j], s[ZB + ONE + j] - s[ZA + j]
        d2x, d2y, d2z = s[XA + ONE + j] - s[XB + j], s[YA + ONE + j] - s[YB + j], s[ZA + ONE + j] - s[ZB + j]
        g1x, g1y, g2x, g2y, area = s[G1X + j], s[G1Y + j], s[G2X + j], s[G2Y + j], s[AREA + j]
        x1, y1, z1 = d1x * g1x + d2x * g2x, d1y * g1x + d2y * g2x, d1z * g1x + d2z * g2x
        x2, y2, z2 = d1x * g1y + d2x * g2y, d1y * g1y + d2y * g2y, d1z * g1y + d2z * g2y
        s[NEW_X1 + j], s[NEW_Y1 + j], s[NEW_Z1 + j] = x1, y1, z1
        s[NEW_X2 + j], s[NEW_Y2 + j], s[NEW_Z2 + j] = x2, y2, z2
        s[NEW_WX + j], s[NEW_WY + j], s[NEW_WZ + j] = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
        s[NEW_A1X + j], s[NEW_A1Y + j] = area * g1x, area * g1y
        s[NEW_A2X + j], s[NEW_A2Y + j] = area * g2x, area * g2y


@compiled
def second_gradient_row(s, columns, old1, old2, new1, new2, h11, h12, h22):
    """F_k1,1, (F_k1,2 + F_k2,1) / 2 and F_k2,2 of node row i [61], one component k."""
    for j in range(ONE, columns - ONE):
        east, west = j, j - ONE  # zones j and j - 1: north and south of the node in the second mesh direction
        ne1, nw1, sw1, se1 = s[new1 + east], s[old1 + east], s[old1 + west], s[new1 + west]
        ne2, nw2, sw2, se2 = s[new2 + east], s[old2 + east], s[old2 + west], s[new2 + west]
        nex, nwx, swx, sex = s[NEW_A1X + east], s[OLD_A2X + east], s[OLD_A1X + west], s[NEW_A2X + west]
        ney, nwy, swy, sey = s[NEW_A1Y + east], s[OLD_A2Y + east], s[OLD_A1Y + west], s[NEW_A2Y + west]
        inverse = s[INVERSE + j]
        s[h11 + j] = inverse * (nex * ne1 + nwx * nw1 - swx * sw1 - sex * se1)
        s[h22 + j] = inverse * (ney * ne2 + nwy * nw2 - swy * sw2 - sey * se2)
        mixed = ney * ne1 + nwy * nw1 - swy * sw1 - sey * se1 + nex * ne2 + nwx * nw2 - swx * sw2 - sex * se2
        s[h12 + j] = 0.5 * inverse * mixed


@compiled
def moment_row(s, poisson, bending, columns):
    """Normal [64], curvature [60] and moments [34] of node row i; returns the row's bending energy."""
    x11, x12, x22, y11, y12, y22, z11, z12, z22 = NEW_H
    mx11, mx12, mx22, my11, my12, my22, mz11, mz12, mz22 = NEW_M
    spherical, deviator = bending * poisson / (1.0 - poisson * poisson), bending / (1.0 + poisson)
    energy = 0.0
    for j in range(ONE, columns - ONE):
        west = j - ONE
        wx = s[NEW_WX + j] + s[OLD_WX + j] + s[OLD_WX + west] + s[NEW_WX + west]
        wy = s[NEW_WY + j] + s[OLD_WY + j] + s[OLD_WY + west] + s[NEW_WY + west]
        wz = s[NEW_WZ + j] + s[OLD_WZ + j] + s[OLD_WZ + west] + s[NEW_WZ + west]
        scale = 1.0 / (wx * wx + wy * wy + wz * wz) ** 0.5
        nx, ny, nz = wx * scale, wy * scale, wz * scale
        b11 = nx * s[x11 + j] + ny * s[y11 + j] + nz * s[z11 + j]
        b12 = nx * s[x12 + j] + ny * s[y12 + j] + nz * s[z12 + j]
        b22 = nx * s[x22 + j] + ny * s[y22 + j] + nz * s[z22 + j]
        trace = spherical * (b11 + b22)
        m11, m12, m22 = trace + deviator * b11, deviator * b12, trace + deviator * b22
        energy += 0.5 * s[SHARE + j] * (m11 * b11 + 2.0 * m12 * b12 + m22 * b22)
        s[NX + j], s[NY + j], s[NZ + j], s[M11 + j], s[M22 + j], s[NEW_B12 + j] = nx, ny, nz, m11, m22, b12
        s[mx11 + j], s[mx12 + j], s[mx22 + j] = nx * m11, nx * m12, nx * m22
        s[my11 + j], s[my12 + j], s[my22 + j] = ny * m11, ny * m12, ny * m22
        s[mz11 + j], s[mz12 + j], s[mz22 + j] = nz * m11, nz * m12, nz * m22
    return energy


@compiled
def _mean(s, old, new, j):
    """Average of a nodal quantity over the corners of zone j of row i - 1."""
    return 0.25 * (s[old + j] + s[new + j] + s[new + ONE + j] + s[old + ONE + j])


@compiled
def christoffel_row(s, columns):
    """Gamma_alm = F_ka F_kl,m of zone row i - 1 [65], with F_kl,m averaged over the corners."""
    x11, x12, x22, y11, y12, y22, z11, z12, z22 = OLD_H
    nx11, nx12, nx22, ny11, ny12, ny22, nz11, nz12, nz22 = NEW_H
    for j in range(ONE, columns - ONE):
        x1, y1, z1, x2, y2, z2 = (
            s[OLD_X1 + j],
            s[OLD_Y1 + j],
            s[OLD_Z1 + j],
            s[OLD_X2 + j],
            s[OLD_Y2 + j],
            s[OLD_Z2 + j],
        )
        hx, hy, hz = _mean(s, x11, nx11, j), _mean(s, y11, ny11, j), _mean(s, z11, nz11, j)
        s[GAMMA111 + j], s[GAMMA211 + j] = x1 * hx + y1 * hy + z1 * hz, x2 * hx + y2 * hy + z2 * hz
        hx, hy, hz = _mean(s, x12, nx12, j), _mean(s, y12, ny12, j), _mean(s, z12, nz12, j)
        s[GAMMA112 + j], s[GAMMA212 + j] = x1 * hx + y1 * hy + z1 * hz, x2 * hx + y2 * hy + z2 * hz
        hx, hy, hz = _mean(s, x22, nx22, j), _mean(s, y22, ny22, j), _mean(s, z22, nz22, j)
        s[GAMMA122 + j], s[GAMMA222 + j] = x1 * hx + y1 * hy + z1 * hz, x2 * hx + y2 * hy + z2 * hz


@compiled
def membrane_row(s, law, columns):
    """T_ka = F_kb S_ba [36], scaled, of the inner zones of row i - 1; returns their energy."""
    energy = 0.0
    for j in range(ONE, columns - ONE):
        x1, y1, z1, x2, y2, z2 = (
            s[OLD_X1 + j],
            s[OLD_Y1 + j],
            s[OLD_Z1 + j],
            s[OLD_X2 + j],
            s[OLD_Y2 + j],
            s[OLD_Z2 + j],
        )
        e11, e22 = 0.5 * (x1 * x1 + y1 * y1 + z1 * z1 - 1.0), 0.5 * (x2 * x2 + y2 * y2 + z2 * z2 - 1.0)
        e12 = 0.5 * (x1 * x2 + y1 * y2 + z1 * z2)
        s11, s22, s12, density = stress(law, e11, e22, e12)
        energy += s[AREA + j] * density
        s[T1X + j], s[T2X + j] = x1 * s11 + x2 * s12, x1 * s12 + x2 * s22
        s[T1Y + j], s[T2Y + j] = y1 * s11 + y2 * s12, y1 * s12 + y2 * s22
        s[T1Z + j], s[T2Z + j] = z1 * s11 + z2 * s12, z1 * s12 + z2 * s22
    return energy


@compiled
def bending_row(s, columns, m11, m12, m22, new11, new12, new22, t1, t2):
    """T_ka -= M_klm Gamma_alm [35] + M_kab,b [31, 59] in the inner zones of row i - 1, one component k."""
    for j in range(ONE, columns - ONE):
        g1x, g1y, g2x, g2y = s[G1X + j], s[G1Y + j], s[G2X + j], s[G2Y + j]
        a11, c11, b11, d11 = s[m11 + j], s[new11 + ONE + j], s[new11 + j], s[m11 + ONE + j]
        a12, c12, b12, d12 = s[m12 + j], s[new12 + ONE + j], s[new12 + j], s[m12 + ONE + j]
        a22, c22, b22, d22 = s[m22 + j], s[new22 + ONE + j], s[new22 + j], s[m22 + ONE + j]
        one, mixed, two = (
            0.25 * (a11 + b11 + c11 + d11),
            0.5 * (a12 + b12 + c12 + d12),
            0.25 * (a22 + b22 + c22 + d22),
        )
        divergence1 = (c11 - a11) * g1x + (d11 - b11) * g2x + (c12 - a12) * g1y + (d12 - b12) * g2y
        divergence2 = (c12 - a12) * g1x + (d12 - b12) * g2x + (c22 - a22) * g1y + (d22 - b22) * g2y
        s[t1 + j] -= one * s[GAMMA111 + j] + mixed * s[GAMMA112 + j] + two * s[GAMMA122 + j] + divergence1
        s[t2 + j] -= one * s[GAMMA211 + j] + mixed * s[GAMMA212 + j] + two * s[GAMMA222 + j] + divergence2


@compiled
def contour_row(s, columns, t1, t2):
    """A g1 . T and A g2 . T of the inner zones of row i - 1 [52], one component; exterior ones pull on nothing [77]."""
    for j in range(ONE, columns - ONE):
        p, q = s[t1 + j], s[t2 + j]
        s[t1 + j] = s[OLD_A1X + j] * p + s[OLD_A1Y + j] * q
        s[t2 + j] = s[OLD_A2X + j] * p + s[OLD_A2Y + j] * q


@compiled
def hourglass_row(s, columns):
    """Stiffness against g = (n . (r_c - r_b - r_d + r_a) - A b12) / 2 in zone row i - 1; returns its energy."""
    energy = 0.0
    for j in range(ONE, columns - ONE):
        sx = s[XA + ONE + j] - s[XA + j] - s[XP + ONE + j] + s[XP + j]
        sy = s[YA + ONE + j] - s[YA + j] - s[YP + ONE + j] + s[YP + j]
        sz = s[ZA + ONE + j] - s[ZA + j] - s[ZP + ONE + j] + s[ZP + j]
        wx, wy, wz = s[OLD_WX + j], s[OLD_WY + j], s[OLD_WZ + j]
        scale = 1.0 / (wx * wx + wy * wy + wz * wz) ** 0.5
        twist = s[AREA + j] * _mean(s, OLD_B12, NEW_B12, j)
        g = 0.5 * (scale * (wx * sx + wy * sy + wz * sz) - twist)
        pull = 0.5 * s[HOURGLASS + j] * g * scale
        energy += 0.5 * s[HOURGLASS + j] * g * g
        s[QX + j], s[QY + j], s[QZ + j] = pull * wx, pull * wy, pull * wz
    return energy


@compiled
def node_row(s, f, start, columns, t1, t2, q, upper):
    """Force on a row of nodes, one component: corners a and d of the zones above, b and c of those below."""
    for j in range(columns):
        f[start + j] = s[upper + j] + s[t1 + j] - s[q + j] - s[t2 - ONE + j] + s[q - ONE + j]


@compiled
def keep_upper(s, columns, t1, t2, q, upper):
    """Keep what the zone row pulls with on its far node row (corners b and c), one component."""
    for j in range(columns):
        s[upper + j] = s[t2 + j] + s[q + j] - s[t1 - ONE + j] - s[q - ONE + j]


@compiled
def load_row(s, slot, source, row, columns):
    """Load one row of a flat array with rows of `columns` numbers."""
    load(s, slot, source, row * columns, columns)


@compiled
def age(s, columns):
    """What was new becomes old: the next rows of zones and nodes come in."""
    for k in range(13):
        move(s, OLD_ZONE[k], NEW_ZONE[k], columns)
    for k in range(19):
        move(s, OLD_NODE[k], NEW_NODE[k], columns)
    for old, new in ((XP, XA), (YP, YA), (ZP, ZA)):
        move(s, old, new, columns)
