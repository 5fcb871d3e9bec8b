"""The numbers that rays get in a workload: generation by generation, siblings side by side."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit

Ints = NDArray[np.int64]


def generations(parents: Ints, kinds: NDArray[np.uint8], pixels: Ints) -> tuple[Ints, Ints]:
    """The rows of rays in their new order, and for each of them the row of its primary ray.

    Primary rays (parent -1) come first, by pixel; then the children of each ray in turn, by kind;
    ties by row. Rows that are in a cycle of parents, or come from one, are left out.
    """
    rows = np.arange(len(parents))
    primaries = np.flatnonzero(parents < 0)
    primaries = primaries[np.argsort(pixels[primaries], kind="stable")]
    spawned = np.flatnonzero(parents >= 0)
    children = spawned[np.lexsort((spawned, kinds[spawned], parents[spawned]))]
    first_child = np.searchsorted(parents[children], np.append(rows, len(rows)))
    return _breadth_first(primaries, first_child, children)


@njit
def _breadth_first(primaries: Ints, first_child: Ints, children: Ints) -> tuple[Ints, Ints]:
    order, roots = (
        np.empty(first_child.size - 1, np.int64),
        np.empty(first_child.size - 1, np.int64),
    )
    found = primaries.size
    order[:found], roots[:found] = primaries, primaries
    at = 0
    while at < found:
        for child in children[first_child[order[at]] : first_child[order[at] + 1]]:
            order[found], roots[found] = child, roots[at]
            found += 1
        at += 1
    return order[:found], roots[:found]


def row_in_cycle(parents: Ints, reached: Ints) -> int:
    """The least row of the first cycle met when parents are followed from a row not reached."""
    missing = np.ones(len(parents), bool)
    missing[reached] = False
    return int(_least_of_cycle(parents, int(np.argmax(missing))))


@njit
def _least_of_cycle(parents: Ints, row: int) -> int:
    for _ in range(parents.size):
        row = parents[row]
    least, at = row, parents[row]
    while at != row:
        least, at = min(least, at), parents[at]
    return least


@njit
def first_repeat(offsets: Ints, objects: Ints, n_objects: int) -> tuple[int, int]:
    """The first (row, object) that an itinerary names twice, or (-1, -1)."""
    seen = np.full(n_objects, -1, np.int64)
    for row in range(offsets.size - 1):
        for at in range(offsets[row], offsets[row + 1]):
            if seen[objects[at]] == row:
                return row, objects[at]
            seen[objects[at]] = row
    return -1, -1


def regrouped(offsets: Ints, order: Ints) -> tuple[Ints, Ints]:
    """CSR groups in another order: the new offsets, and where each entry was before."""
    lengths = np.diff(offsets)[order]
    new_offsets = np.concatenate([[0], np.cumsum(lengths)])
    moved = np.repeat(offsets[:-1][order] - new_offsets[:-1], lengths)
    return new_offsets, np.arange(new_offsets[-1]) + moved
