"""Nested dissection of a logically rectangular mesh (George 1973): the order in which its nodes are best eliminated.

A mesh is cut by a strip of nodes so wide that no force reaches across it, each half again, and so on. The halves are
eliminated before the strip, so a node meets, besides its own part, only the ring of strips round it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEAF = 40  # nodes of the smallest parts: smaller ones cost more calls, larger ones more arithmetic


@dataclass(frozen=True)
class Part:
    """One part of the mesh.

    nodes : those eliminated here, then those of the ring round the part, both in the order of elimination.
    pivots : how many are eliminated. children : indices of the parts that this one joins.
    """

    nodes: np.ndarray
    pivots: int
    children: tuple[int, ...]


@dataclass(frozen=True)
class Ordering:
    """Nested dissection of the free nodes of a mesh.

    rank : (nodes,) int64, place of each node in the order of elimination, -1 for fixed nodes.
    parts : every child before its parent. shape : (ni, nj) of the mesh.
    reach : mesh lines across which two nodes act on each other.
    """

    rank: np.ndarray
    parts: tuple[Part, ...]
    shape: tuple[int, int]
    reach: int

    @property
    def entries(self) -> int:
        """Blocks, one for each pair of nodes, that a factor stores."""
        return sum(part.pivots * part.nodes.size for part in self.parts)


def dissect(free: np.ndarray, reach: int, closed: bool) -> Ordering:
    """Order the nodes where `free` (ni, nj) is true.

    reach : mesh lines across which two nodes act on each other. closed : the first mesh direction is a ring.
    """
    cutting = _Dissection(free, reach, closed)
    ni, nj = free.shape
    if closed and ni > 2 * reach + 1:
        strip, none = cutting.number[:reach].ravel(), np.empty(0, dtype=np.int64)
        child = cutting.cut(reach, ni, 0, nj)
        cutting.eliminate(strip, none, (child,))
    elif closed:
        cutting.eliminate(cutting.number.ravel(), np.empty(0, dtype=np.int64), ())
    else:
        cutting.cut(0, ni, 0, nj)
    rank = cutting.rank
    parts = (
        Part(np.concatenate([nodes, ring[np.argsort(rank[ring])]]), nodes.size, children)
        for nodes, ring, children in cutting.parts
    )
    return Ordering(rank, tuple(parts), (ni, nj), reach)


class _Dissection:
    """Cuts boxes (i0, i1, j0, j1) of nodes and ranks what is eliminated."""

    def __init__(self, free: np.ndarray, reach: int, closed: bool) -> None:
        self.free, self.reach, self.closed = free, reach, closed
        self.number = np.arange(free.size).reshape(free.shape)
        self.rank = np.full(free.size, -1)
        self.parts: list[tuple[np.ndarray, np.ndarray, tuple[int, ...]]] = []  # nodes, ring, children
        self.next = 0

    def cut(self, i0: int, i1: int, j0: int, j1: int) -> int:
        """Eliminate the box, its halves first; returns the index of its part."""
        high, wide, gap = i1 - i0, j1 - j0, self.reach
        ring = self._ring(i0, i1, j0, j1)
        if high * wide <= LEAF or max(high, wide) <= gap + 1:
            return self.eliminate(self.number[i0:i1, j0:j1].ravel(), ring, ())
        if high >= wide:
            middle = i0 + (high - gap) // 2
            children = self.cut(i0, middle, j0, j1), self.cut(middle + gap, i1, j0, j1)
            strip = self.number[middle : middle + gap, j0:j1]
        else:
            middle = j0 + (wide - gap) // 2
            children = self.cut(i0, i1, j0, middle), self.cut(i0, i1, middle + gap, j1)
            strip = self.number[i0:i1, middle : middle + gap]
        return self.eliminate(strip.ravel(), ring, children)

    def eliminate(self, nodes: np.ndarray, ring: np.ndarray, children: tuple[int, ...]) -> int:
        """Rank the free ones of these nodes; returns the index of the part."""
        free = self.free.ravel()
        nodes = nodes[free[nodes]]
        self.rank[nodes] = self.next + np.arange(nodes.size)
        self.next += nodes.size
        self.parts.append((nodes, ring[free[ring]], children))
        return len(self.parts) - 1

    def _ring(self, i0: int, i1: int, j0: int, j1: int) -> np.ndarray:
        """The nodes outside the box that act on nodes inside."""
        ni, nj = self.free.shape
        rows = np.arange(i0 - self.reach, i1 + self.reach)
        rows = np.unique(rows % ni) if self.closed else rows[(rows >= 0) & (rows < ni)]
        near = self.number[rows, max(j0 - self.reach, 0) : min(j1 + self.reach, nj)].ravel()
        i, j = np.divmod(near, nj)
        return near[(i < i0) | (i >= i1) | (j < j0) | (j >= j1)]
