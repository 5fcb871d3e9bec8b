"""embree's proposals: which triangle does a ray hit first, as float32 sees it?

The only import of embreex. What it says bounds an exact search and never reaches a workload.
"""

from __future__ import annotations

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.workload.trace.exact import entry, ray_of
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.proxies import proxy_mesh

AWAY = 2.0**-16
"""How far rays start from the surface they leave, in scene sizes: past float32's roundings."""


class Intersector:
    """Proposes a hit for each ray; tests put false witnesses in its place."""

    def __init__(self, geometry: Geometry) -> None:
        vertices, faces, self._stands_for = proxy_mesh(geometry)
        self._box = geometry.box.reshape(1, 6)
        # embree fails on a scene without triangles. "Robust" closes the edges between them.
        self._scene = EmbreeScene(robust=True) if len(faces) else None
        if self._scene is not None:
            TriangleMesh(self._scene, vertices, faces)

    def claims(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> NDArray[np.int32]:
        """Object and row of the triangle proposed for each ray, (n, 2) int32; -1 for none.

        Parameters
        ----------
        origins, directions : (n, 3) float64, normalised and finite; directions of length 1
        """
        if origins.shape != directions.shape or origins.shape[1:] != (3,):
            raise ValueError(f"rays of shapes {origins.shape} and {directions.shape}, not (n, 3)")
        claims = np.full((len(origins), 2), -1, dtype=np.int32)
        which, starts, ahead = _starts_in_box(self._box, origins, directions)
        if self._scene is not None and len(which):
            first = self._scene.run(starts, ahead, query="INTERSECT")
            hit = (first >= 0) & (first < len(self._stands_for))
            claims[which[hit]] = self._stands_for[first[hit]]
        return claims


def _starts_in_box(
    box: NDArray[np.float64], origins: NDArray[np.float64], directions: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float32], NDArray[np.float32]]:
    """Rays that enter the scene's box, as float32, moved to where they enter it."""
    which = np.empty(len(origins), np.int64)
    starts, ahead = np.empty((2, len(origins), 3), np.float32)
    # A part of an array would be another type, and compiled once more.
    contiguous = np.ascontiguousarray(origins), np.ascontiguousarray(directions)
    n = _start_in_box(box, *contiguous, which, starts, ahead)
    return which[:n], starts[:n], ahead[:n]


@njit
def _start_in_box(
    box: NDArray[np.float64],
    origins: NDArray[np.float64],
    directions: NDArray[np.float64],
    which: NDArray[np.int64],
    origins32: NDArray[np.float32],
    directions32: NDArray[np.float32],
) -> int:
    """Fill the arrays of :func:`_starts_in_box`; how many rays there are."""
    n = 0
    for i in range(len(origins)):
        t = entry(box, 0, ray_of(origins, directions, i))
        if t < np.inf:
            # From within it starts ahead of its surface, which float32 would find again; from
            # outside before the box, whose face may be the very object that is to be found.
            t += AWAY if t == 0.0 else -AWAY
            for axis in range(3):
                origins32[n, axis] = origins[i, axis] + t * directions[i, axis]
                directions32[n, axis] = directions[i, axis]
            which[n] = i
            n += 1
    return n
