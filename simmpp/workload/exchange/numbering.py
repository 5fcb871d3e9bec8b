"""The numbers that rays get in a workload: generation by generation, siblings side by side."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.workload.workload import FIRST_REPEATING, SHADOW

Ints = NDArray[np.int64]


def by_generation(parents: Ints, kinds: NDArray[np.uint8], pixels: Ints) -> tuple[Ints, Ints]:
    """The rows of rays in their new order, and for each of them the row of its primary ray.

    Primary rays (parent -1) come first, by pixel; then the children of each ray in turn, by kind
    with shadow rays last; ties by row. Rows that are in a cycle of parents, or come from one, are
    left out. Two trees as another renderer may write them, and the order of their rows in a
    workload::

        row     0        1       2       3        4
        kind    primary  shadow  shadow  primary  reflected      order  3  0  2  4  1
        parent  -1       0       3       -1       0              root   3  0  3  0  0
        pixel   1        -       -       0        -
    """
    rows = np.arange(len(parents))
    primaries = np.flatnonzero(parents < 0)
    primaries = primaries[np.argsort(pixels[primaries], kind="stable")]
    spawned = np.flatnonzero(parents >= 0)
    of_spawned = kinds[spawned]
    keys = (spawned, of_spawned, of_spawned == SHADOW, parents[spawned])
    children = spawned[np.lexsort(keys)]
    first_child = np.searchsorted(parents[children], np.append(rows, len(rows)))
    return _breadth_first(primaries, first_child, children)


@njit
def _breadth_first(primaries: Ints, first_child: Ints, children: Ints) -> tuple[Ints, Ints]:
    n_rows = first_child.size - 1
    order, roots = np.empty(n_rows, np.int64), np.empty(n_rows, np.int64)
    n_ordered = primaries.size
    order[:n_ordered], roots[:n_ordered] = primaries, primaries
    row = 0
    while row < n_ordered:
        for child in children[first_child[order[row]] : first_child[order[row] + 1]]:
            order[n_ordered], roots[n_ordered] = child, roots[row]
            n_ordered += 1
        row += 1
    return order[:n_ordered], roots[:n_ordered]


def row_in_cycle(parents: Ints, reached: Ints) -> int:
    """The least row of the first cycle met when parents are followed from a row not reached."""
    missing = np.ones(len(parents), bool)
    missing[reached] = False
    return int(_least_of_cycle(parents, int(np.argmax(missing))))


@njit
def _least_of_cycle(parents: Ints, row: int) -> int:
    for _ in range(parents.size):  # after so many steps it is in the cycle, wherever it began
        row = parents[row]
    least, ancestor = row, parents[row]
    while ancestor != row:
        least, ancestor = min(least, ancestor), parents[ancestor]
    return least


@njit
def first_repeat(
    offsets: Ints, objects: Ints, n_objects: int, kinds: NDArray[np.uint8]
) -> tuple[int, int]:
    """The first (row, object) that an itinerary names twice and may not, or (-1, -1)."""
    seen = np.full(n_objects, -1, np.int64)
    for row in range(offsets.size - 1):
        if kinds[row] >= FIRST_REPEATING:
            continue
        for obj in objects[offsets[row] : offsets[row + 1]]:
            if seen[obj] == row:
                return row, obj
            seen[obj] = row  # so the marks of earlier rows need no clearing
    return -1, -1


def regrouped(offsets: Ints, order: Ints) -> tuple[Ints, Ints]:
    """CSR groups in another order: the new offsets, and where each entry was before."""
    lengths = np.diff(offsets)[order]
    new_offsets = np.concatenate([[0], np.cumsum(lengths)])
    moved = np.repeat(offsets[:-1][order] - new_offsets[:-1], lengths)
    return new_offsets, np.arange(new_offsets[-1]) + moved
