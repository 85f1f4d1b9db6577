"""What supported edges exert on a sheet of bicubic elements."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from femref.assembly import SheetEnergy
from femref.held import edge_nodes


def reactions(
    energy: SheetEnergy, q: np.ndarray, edges: Iterable[str]
) -> Mapping[str, tuple[np.ndarray, np.ndarray]]:
    """Force (3,) N and moment about the origin (3,) N mm of each edge on the sheet, from the work of rigid motions.

    A translation moves the values of the edge's nodes, a rotation all their nodal values: the four kinds of one node
    are derivatives of the positions, so they turn together. The corner of two supported edges counts for both.
    """
    gradient = energy.gradient(q)
    found = {}
    for edge in edges:
        nodes = edge_nodes(energy.mesh, edge)
        force, turned = gradient[nodes], q[nodes]
        found[edge] = (force[:, 0].sum(axis=0), np.cross(turned, force).sum(axis=(0, 1)))
    return found
