"""Lit views of a deformed sheet: orthographic projection, two-sided shading, hidden surfaces removed."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass

import numpy as np
from numba import njit

SUPERSAMPLING = 2  # each pixel is the mean of 2 x 2, for smooth silhouettes
LIGHT = np.array([-0.55, 0.45, 0.70])  # from the upper left towards the reader, camera axes
AMBIENT, DIFFUSE, GLOSS, GLOSS_POWER = 0.38, 0.60, 0.16, 24.0
KEPT_PICTURES = 64  # of a few MB each


@dataclass(frozen=True)
class View:
    """Where the reader stands: azimuth from the x axis and elevation above the plane, degrees.

    Elevation 90 is the view from above, x to the right and y up.
    """

    azimuth_deg: float = -90.0
    elevation_deg: float = 90.0

    def axes(self) -> np.ndarray:
        """(3, 3) rows: right, up and towards the reader, in space."""
        a, e = math.radians(self.azimuth_deg), math.radians(self.elevation_deg)
        towards = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
        right = np.array([-math.sin(a), math.cos(a), 0.0])
        return np.array([right, np.cross(towards, right), towards])


@dataclass(frozen=True)
class Picture:
    """rgba : (rows, columns, 4) uint8, first row on top.  extent : left, right, bottom, top in mm."""

    rgba: np.ndarray
    extent: tuple[float, float, float, float]


_FILLED: dict[bytes, Picture] = {}


def flat_view(r: np.ndarray, zone_rgb: np.ndarray, closed: bool, pixels: int = 1000) -> Picture:
    """Draw zones in their plain colours from above, with smooth outlines; arguments as in `lit_view`.

    r : (ni, nj, 2 or 3) mm.
    """
    nodes = np.concatenate([r, r[:1]], axis=0) if closed else r
    if nodes.shape[-1] == 2:
        nodes = np.concatenate([nodes, np.zeros((*nodes.shape[:2], 1))], axis=-1)
    plain = np.zeros((*nodes.shape[:2], 2))
    plain[..., 0] = 1.0
    return _picture(nodes @ View().axes().T, plain, zone_rgb, pixels)


def lit_view(
    r: np.ndarray,
    zone_rgb: np.ndarray,
    closed: bool,
    view: View,
    pixels: int = 1000,
    relief: float = 1.0,
) -> Picture:
    """Draw a sheet as a lit surface.

    r : (ni, nj, 3) mm, deformed nodes.  zone_rgb : (nzi, nj - 1, 3) in [0, 1].
    closed : the first mesh direction is closed.
    pixels : width or height of the picture, the larger.
    relief : factor on z for the shading only; outlines and extent stay true.
    """
    axes = view.axes()
    nodes = np.concatenate([r, r[:1]], axis=0) if closed else r
    shade = _shade(nodes * np.array([1.0, 1.0, relief]), closed, axes)
    return _picture(nodes @ axes.T, shade, zone_rgb, pixels)


def _picture(seen: np.ndarray, shade: np.ndarray, zone_rgb: np.ndarray, pixels: int) -> Picture:
    """Fit the projected nodes (right, up, towards the reader; mm) into the picture and fill it.

    The page and the PDF show the same pictures: each is filled once.
    """
    zone_rgb = np.ascontiguousarray(zone_rgb, dtype=np.float64)
    content = b"".join(array.tobytes() for array in (seen, shade, zone_rgb))
    key = hashlib.blake2b(content + repr((pixels, seen.shape)).encode()).digest()
    if key not in _FILLED:
        while len(_FILLED) >= KEPT_PICTURES:
            _FILLED.pop(next(iter(_FILLED)))
        _FILLED[key] = _fill_picture(seen, shade, zone_rgb, pixels)
    return _FILLED[key]


def _fill_picture(seen: np.ndarray, shade: np.ndarray, zone_rgb: np.ndarray, pixels: int) -> Picture:
    low, high = seen[..., :2].min(axis=(0, 1)), seen[..., :2].max(axis=(0, 1))
    pad = 0.01 * float((high - low).max())
    low, high = low - pad, high + pad
    scale = SUPERSAMPLING * pixels / float((high - low).max())
    width, height = (int(math.ceil(side * scale / SUPERSAMPLING)) * SUPERSAMPLING for side in high - low)
    screen = np.empty_like(seen)
    screen[..., 0] = (seen[..., 0] - low[0]) * scale
    screen[..., 1] = (high[1] - seen[..., 1]) * scale
    screen[..., 2] = seen[..., 2]
    rgb, alpha = _fill(screen, shade, zone_rgb, width, height)
    left, top = float(low[0]), float(high[1])
    return Picture(_average(rgb, alpha), (left, left + width / scale, top - height / scale, top))


def _shade(nodes: np.ndarray, closed: bool, axes: np.ndarray) -> np.ndarray:
    """(ni, nj, 2): factor on the colour and gloss added to it at the nodes, either face lit alike."""
    along_i = np.gradient(nodes, axis=0)
    if closed:  # the last row repeats the first
        along_i[0] = along_i[-1] = 0.5 * (nodes[1] - nodes[-2])
    normal = np.cross(along_i, np.gradient(nodes, axis=1)) @ axes.T
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = normal / np.where(length > 0.0, length, 1.0)
    normal = np.where(normal[..., 2:] < 0.0, -normal, normal)
    light = LIGHT / np.linalg.norm(LIGHT)
    half = light + np.array([0.0, 0.0, 1.0])
    half /= np.linalg.norm(half)
    diffuse = AMBIENT + DIFFUSE * np.clip(normal @ light, 0.0, 1.0)
    return np.stack([diffuse, GLOSS * np.clip(normal @ half, 0.0, 1.0) ** GLOSS_POWER], axis=-1)


@njit(cache=True)
def _fill(
    screen: np.ndarray, shade: np.ndarray, zone_rgb: np.ndarray, width: int, height: int
) -> tuple[np.ndarray, np.ndarray]:  # pragma: no cover - compiled
    rgb = np.ones((height, width, 3))
    alpha = np.zeros((height, width))
    depth = np.full((height, width), -np.inf)
    corner_i, corner_j = np.array([0, 1, 1, 0]), np.array([0, 0, 1, 1])
    for i in range(zone_rgb.shape[0]):
        for j in range(zone_rgb.shape[1]):
            for half in range(2):
                third = 2 + half
                p = screen[i, j]
                q = screen[i + corner_i[third - 1], j + corner_j[third - 1]]
                s = screen[i + corner_i[third], j + corner_j[third]]
                lp = shade[i, j]
                lq = shade[i + corner_i[third - 1], j + corner_j[third - 1]]
                ls = shade[i + corner_i[third], j + corner_j[third]]
                area = (q[0] - p[0]) * (s[1] - p[1]) - (s[0] - p[0]) * (q[1] - p[1])
                if area == 0.0:
                    continue
                left = max(int(np.ceil(min(p[0], q[0], s[0]) - 0.5)), 0)
                right = min(int(np.floor(max(p[0], q[0], s[0]) - 0.5)), width - 1)
                top = max(int(np.ceil(min(p[1], q[1], s[1]) - 0.5)), 0)
                bottom = min(int(np.floor(max(p[1], q[1], s[1]) - 0.5)), height - 1)
                for row in range(top, bottom + 1):
                    for column in range(left, right + 1):
                        x, y = column + 0.5 - p[0], row + 0.5 - p[1]
                        wq = (x * (s[1] - p[1]) - y * (s[0] - p[0])) / area
                        ws = (y * (q[0] - p[0]) - x * (q[1] - p[1])) / area
                        wp = 1.0 - wq - ws
                        if wq < 0.0 or ws < 0.0 or wp < 0.0:
                            continue
                        z = wp * p[2] + wq * q[2] + ws * s[2]
                        if z <= depth[row, column]:
                            continue
                        depth[row, column] = z
                        alpha[row, column] = 1.0
                        diffuse = wp * lp[0] + wq * lq[0] + ws * ls[0]
                        gloss = wp * lp[1] + wq * lq[1] + ws * ls[1]
                        for k in range(3):
                            lit = zone_rgb[i, j, k] * diffuse + gloss
                            rgb[row, column, k] = min(max(lit, 0.0), 1.0)
    return rgb, alpha


def _average(rgb: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """Mean over the 2 x 2 samples of each pixel, colours weighted by coverage."""

    def total(samples: np.ndarray) -> np.ndarray:
        return sum(
            (
                samples[i::SUPERSAMPLING, j::SUPERSAMPLING]
                for i, j in np.ndindex(SUPERSAMPLING, SUPERSAMPLING)
            ),
            np.zeros(1),
        )

    covered = total(alpha)
    colour = total(rgb * alpha[..., None]) / np.where(covered > 0.0, covered, 1.0)[..., None]
    rgba = np.concatenate([colour, covered[..., None] / SUPERSAMPLING**2], axis=-1)
    return np.rint(255.0 * rgba).astype(np.uint8)
