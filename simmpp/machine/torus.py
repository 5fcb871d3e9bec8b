"""The 3-D torus: where PEs sit, and how many hops lie between two of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.compiled import njit


def default_shape(processors: int) -> tuple[int, int, int]:
    """The most cubic torus of that many PEs: X >= Y >= Z with the least X + Y + Z.

    Source: near-cubic partitions of the T3E (ESTIMATE: real ones also held system PEs).
    """
    shapes = (
        (processors // (y * z), y, z)
        for z in range(1, round(processors ** (1 / 3)) + 2)
        if processors % z == 0
        for y in range(z, processors // z + 1)
        if y * y * z <= processors and processors % (y * z) == 0
    )
    return min(shapes, key=lambda shape: (sum(shape), shape))


@njit
def ring_distance(size: int, a: int, b: int) -> int:
    """Hops from a to b on a ring of ``size`` PEs, the shortest way round."""
    forward = abs(b - a)
    return min(forward, size - forward)


@njit
def hops(x_size: int, y_size: int, z_size: int, source: int, destination: int) -> int:
    """Links that a message crosses under dimension-order routing; PE k = x + X (y + Y z)."""
    source_row, destination_row = source // x_size, destination // x_size
    return (
        ring_distance(x_size, source % x_size, destination % x_size)
        + ring_distance(y_size, source_row % y_size, destination_row % y_size)
        + ring_distance(z_size, source_row // y_size, destination_row // y_size)
    )


DIRECTIONS = ("+x", "-x", "+y", "-y", "+z", "-z")
"""Links of a PE; link number 6 k + d leads from PE k in direction d."""


@njit
def route(
    shape: tuple[int, int, int], source: int, destination: int, links: NDArray[np.int64]
) -> int:
    """Number the links that a message crosses, in order, into ``links``; returns how many.

    Along x, then y, then z, the shortest way round, towards + where both are as long. ``links``
    (X // 2 + Y // 2 + Z // 2,) int64 holds the longest route.
    """
    n, here, stride = 0, source, 1
    for axis in range(3):
        size = shape[axis]
        at, to = here // stride % size, destination // stride % size
        forward = (to - at) % size
        is_back = 1 if 2 * forward > size else 0
        for _ in range(size - forward if is_back else forward):
            links[n] = 6 * here + 2 * axis + is_back
            following = (at + (size - 1 if is_back else 1)) % size
            here += (following - at) * stride
            at = following
            n += 1
        stride *= size
    return n
