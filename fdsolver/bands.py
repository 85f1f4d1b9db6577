"""The kernels on several threads: as many bands of rows as there are scratch arrays, one thread each.

Compiled on their own because a parallel loop takes longer to compile than the kernel that it calls.
"""

from __future__ import annotations

import numba

from fdsolver import membrane, membrane_plane, plate, plate_linear, plate_plane
from fdsolver.rows import threaded


@threaded
def plane_bands(law, r, f, zone, energy, rows, columns, closed, scratch):
    """`membrane_plane.band` on all rows."""
    bands = scratch.shape[0]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        membrane_plane.band(law, r, f, zone, energy, rows, columns, closed, start, stop, scratch[k])


@threaded
def membrane_bands(law, r, f, zone, energy, rows, columns, closed, scratch):
    """`membrane.band` on all rows."""
    bands = scratch.shape[0]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        membrane.band(law, r, f, zone, energy, rows, columns, closed, start, stop, scratch[k])


@threaded
def plate_plane_bands(law, r, f, zone, energy, rows, columns, closed, scratch, hourglass):
    """`plate_plane.band` on all rows."""
    bands = scratch.shape[0]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        plate_plane.band(law, r, f, zone, energy, rows, columns, closed, start, stop, scratch[k], hourglass)


@threaded
def plate_linear_bands(law, r, f, zone, energy, rows, columns, closed, scratch, node, twist, coupling):
    """`plate_linear.band` on all rows."""
    bands = scratch.shape[0]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        plate_linear.band(
            law, r, f, zone, energy, rows, columns, closed, start, stop, scratch[k], node, twist, coupling
        )


@threaded
def plate_bands(law, r, f, zone, energy, rows, columns, closed, scratch, node, twist):
    """`plate.band` on all rows."""
    bands = scratch.shape[0]
    for k in numba.prange(bands):
        start, stop = k * rows // bands, (k + 1) * rows // bands
        plate.band(law, r, f, zone, energy, rows, columns, closed, start, stop, scratch[k], node, twist)
