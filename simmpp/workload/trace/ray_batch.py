"""Rays as arrays: what is intersected, spawned and shaded together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class RayBatch(NamedTuple):
    """n rays of one generation, lengths normalised."""

    origins: Floats
    """(n, 3) float64."""
    directions: Floats
    """(n, 3) float64 of length 1."""
    kinds: NDArray[np.uint8]
    """(n,) uint8."""
    limits: Floats
    """(n,) float64: distance to the light of a shadow ray, else infinity."""
    sources: NDArray[np.int32]
    """(n,) int32: the object that the ray leaves for good, convex and opaque; else -1."""
    parents: NDArray[np.int32]
    """(n,) int32: number of the parent; -1 for primary rays."""
    roots: NDArray[np.int32]
    """(n,) int32: number of the primary ray at the root of the ray's tree."""

    def part(self, start: int, stop: int) -> RayBatch:
        """Rays start ... stop - 1."""
        return RayBatch._make(array[start:stop] for array in self)


def unwritten(n: int) -> RayBatch:
    """Room for ``n`` rays."""
    return RayBatch(
        origins=np.empty((n, 3)),
        directions=np.empty((n, 3)),
        kinds=np.empty(n, np.uint8),
        limits=np.empty(n),
        sources=np.empty(n, np.int32),
        parents=np.empty(n, np.int32),
        roots=np.empty(n, np.int32),
    )


def joined(parts: list[RayBatch]) -> RayBatch:
    """Runs of rays, one after the other."""
    return RayBatch._make(np.concatenate(column) for column in zip(*parts, strict=True))
