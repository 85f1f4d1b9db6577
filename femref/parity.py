"""How modes behave under the reflections and the half turn that map a sheet's mesh onto itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from skfem import Mesh

IMAGES = {"mirror_x": (-1.0, 1.0), "mirror_y": (1.0, -1.0), "half_turn": (-1.0, -1.0)}
# A mode of a sheet with the symmetry is its image to rounding; of one without, or of a rotated pair, by chance only.
_CLEAR = 0.99
# Factors that differ by less cannot be told apart by the iteration: their modes are any mixture.
MULTIPLE = 1e-7


@dataclass(frozen=True)
class Parities:
    """correlation : name of the image -> (k,) integrals of w times its image over those of w^2, -1 to 1; empty for an
    image that does not map the mesh onto itself. modes : (vertices, k), mixtures within multiple factors resolved.
    """

    correlation: dict[str, np.ndarray]
    modes: np.ndarray

    def clear(self) -> str | None:
        """The first image that every mode reproduces up to its sign, None if there is none."""
        for name, values in self.correlation.items():
            if (np.abs(values) > _CLEAR).all():
                return name
        return None


def parities(mesh: Mesh, factor: np.ndarray, modes: np.ndarray) -> Parities:
    """Parities of modes (vertices, k) of ascending factors (k,); mesh coordinates are centred."""
    weight = vertex_weights(mesh)
    modes = modes.copy()
    images = {name: _permutation(mesh, signs) for name, signs in IMAGES.items()}
    known = {name: order for name, order in images.items() if order is not None}
    start = 0
    for stop in range(1, len(factor) + 1):
        if stop < len(factor) and factor[stop] - factor[start] < MULTIPLE * factor[stop]:
            continue
        if stop - start > 1 and known:
            modes[:, start:stop] = _resolve(modes[:, start:stop], weight, next(iter(known.values())))
        start = stop
    norm = (weight[:, None] * modes**2).sum(axis=0)
    correlation = {
        name: (weight[:, None] * modes * modes[order]).sum(axis=0) / norm for name, order in known.items()
    }
    return Parities(correlation, modes)


def vertex_weights(mesh: Mesh) -> np.ndarray:
    """(vertices,) areas of the cells shared equally among their vertices."""
    corners = mesh.p[:, mesh.t]
    x, y = corners - corners[:, :1]
    area = 0.5 * np.abs(sum(x[k] * y[k + 1] - x[k + 1] * y[k] for k in range(1, len(x) - 1)))
    share = np.tile(area / len(x), len(x))
    return np.bincount(mesh.t.ravel(), share, minlength=mesh.p.shape[1])


def _permutation(mesh: Mesh, signs: tuple[float, float]) -> np.ndarray | None:
    """For every vertex the one at its image, None if some image is no vertex."""
    distance, order = cKDTree(mesh.p.T).query((mesh.p * np.array(signs)[:, None]).T)
    return np.asarray(order) if np.max(distance) < 1e-9 else None


def _resolve(modes: np.ndarray, weight: np.ndarray, order: np.ndarray) -> np.ndarray:
    """The mixtures of modes (vertices, k) that the image reproduces up to their signs."""
    gram = modes.T @ (weight[:, None] * modes)
    values, vectors = np.linalg.eigh(gram)
    basis = modes @ (vectors / np.sqrt(values))
    image = basis.T @ (weight[:, None] * basis[order])
    return basis @ np.linalg.eigh(0.5 * (image + image.T))[1][:, ::-1]
