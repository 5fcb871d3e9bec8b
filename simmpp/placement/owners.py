"""Which PE owns which object: the one that all others ask for it and send rays to for it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.randomness import generator
from simmpp.placement.placement import Owners, cut
from simmpp.placement.uses import UsesByPE

MORTON_BITS = 21
"""Bits a coordinate is cut to, so that three of them interleave into 63."""
SAME_LENGTH = 2.0**-30
"""Axes are as long as each other if they differ by at most this share of the scene: by a few steps
of the grid that traced centroids are rounded to."""


def owners(
    rule: Owners, centroids: NDArray[np.float64], processors: int, seed: int
) -> NDArray[np.int32]:
    """The owner of each object: (N,) int32.

    ``centroids`` is (N, 3) float64. Every rule gives each PE floor(N / nb) or ceil(N / nb) objects.
    """
    n_objects = len(centroids)
    if rule == "bisection":
        return _bisection(centroids, processors)
    if rule == "round_robin":
        return (np.arange(n_objects) % processors).astype(np.int32)
    if rule == "morton":
        order = np.lexsort((np.arange(n_objects), _morton(centroids)))
    else:
        order = generator(seed, "owners").permutation(n_objects)
    dealt = np.empty(n_objects, np.int32)
    dealt[order] = cut(n_objects, processors)
    return dealt


def most_using(by_pe: UsesByPE, n_objects: int, processors: int) -> NDArray[np.int32]:
    """Each object to the PE that uses it most and has room: (N,) int32.

    The greatest use is served first; of equal ones the lower object, then the lower PE. What no PE
    uses fills up those that have room. Every PE gets floor(N / nb) or ceil(N / nb) objects.
    Source: data live where they are needed most, as in Jaros et al., GPU Accelerated
    Path Tracing of Massive Scenes, ACM TOG 40(2), 2021.
    """
    owner_of = np.full(n_objects, -1, np.int32)
    room = np.full(processors, n_objects // processors)
    spare = n_objects % processors
    has_more = np.zeros(processors, bool)
    for at in np.lexsort((by_pe.pes, by_pe.objects, -by_pe.counts)).tolist():
        pe, obj = int(by_pe.pes[at]), int(by_pe.objects[at])
        if owner_of[obj] >= 0:
            continue
        if room[pe] > 0:
            room[pe] -= 1
        elif spare > 0 and not has_more[pe]:
            spare, has_more[pe] = spare - 1, True
        else:
            continue
        owner_of[obj] = pe
    left = np.flatnonzero(owner_of < 0)
    room[np.flatnonzero(~has_more)[:spare]] += 1
    owner_of[left] = np.repeat(np.arange(processors), room)[: len(left)]
    return owner_of


def _bisection(centroids: NDArray[np.float64], processors: int) -> NDArray[np.int32]:
    """Recursive bisection of space, across the longest axis of the centroids, the first of equals.

    p PEs are split floor(p / 2) : rest, and their n objects in that proportion, the lower part
    rounded down: floor(n / 2) : rest where p is even.
    """
    part_of = np.zeros(len(centroids), np.int32)
    slack = SAME_LENGTH * float(np.ptp(centroids, axis=0).max()) if len(centroids) else 0.0
    pending = [(np.arange(len(centroids)), 0, processors)]
    while pending:
        ids, first_pe, n_pes = pending.pop()
        if n_pes == 1 or len(ids) == 0:
            part_of[ids] = first_pe
            continue
        left_pes = n_pes // 2
        n_left = len(ids) * left_pes // n_pes
        points = centroids[ids]
        spread = np.ptp(points, axis=0)
        axis = int(np.argmax(spread >= spread.max() - slack))
        order = ids[np.lexsort((ids, points[:, axis]))]
        pending.append((np.sort(order[:n_left]), first_pe, left_pes))
        pending.append((np.sort(order[n_left:]), first_pe + left_pes, n_pes - left_pes))
    return part_of


def _morton(centroids: NDArray[np.float64]) -> NDArray[np.uint64]:
    """Position of each centroid on the Z-order curve through the scene's box."""
    if len(centroids) == 0:
        return np.zeros(0, np.uint64)
    low = centroids.min(axis=0)
    extent = float(np.max(np.ptp(centroids, axis=0))) or 1.0
    cells = ((centroids - low) / extent * (2**MORTON_BITS - 1)).astype(np.uint64)
    code = np.zeros(len(centroids), np.uint64)
    for bit in range(MORTON_BITS):
        for axis in range(3):
            taken = cells[:, axis] >> np.uint64(bit) & np.uint64(1)
            code |= taken << np.uint64(3 * bit + axis)
    return code
