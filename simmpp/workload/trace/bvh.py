"""The 8-wide bounding volume tree: which boxes may a ray enter?

Built by binned surface area heuristic (Wald 2007, "On fast construction of SAH-based bounding
volume hierarchies"): a node splits its costliest segment until it has eight.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

WIDTH = 8
BINS = 16
EMPTY = np.int32(-(2**31))
"""Child of an unused slot; its box is inside out, so no ray enters it."""


class Tree(NamedTuple):
    """Nodes of eight boxes; the root is node 0 (or where ``join`` has put it)."""

    bounds: NDArray[np.float64]
    """(nodes, 6, 8) float64: low x, y, z, then high x, y, z of each child."""
    children: NDArray[np.int32]
    """(nodes, 8) int32: a node, or ~leaf, or EMPTY."""


@njit
def build(boxes: Floats) -> tuple[Floats, Ints]:
    """Build the tree over ``boxes`` (n, 6) float64, low then high corner; leaf i is box i.

    Returns the arrays of a :class:`Tree`. Equal boxes give equal trees.
    """
    n = len(boxes)
    order = np.arange(n, dtype=np.int32)
    scratch = np.empty(n, np.int32)
    bounds = np.empty((max(n, 1), 6, WIDTH))
    bounds[:, :3], bounds[:, 3:] = np.inf, -np.inf
    children = np.full((max(n, 1), WIDTH), EMPTY, np.int32)
    spans = np.empty((max(n, 1), 2), np.int64)
    spans[0] = 0, n
    used = 1
    node = 0
    while node < used:  # spans is the queue: children are numbered after their parents
        cuts = _cut_in_eight(boxes, order, scratch, spans[node, 0], spans[node, 1])
        for k in range(len(cuts) - 1):
            low, high = cuts[k], cuts[k + 1]
            bounds[node, :, k] = _union(boxes, order, low, high)
            if high - low == 1:
                children[node, k] = ~order[low]
            else:
                children[node, k] = used
                spans[used] = low, high
                used += 1
        node += 1
    return bounds[:used].copy(), children[:used].copy()


@njit
def _cut_in_eight(
    boxes: Floats, order: Ints, scratch: Ints, low: int, high: int
) -> NDArray[np.int64]:
    """Positions that cut order[low:high] into at most eight segments."""
    cuts = np.empty(WIDTH + 1, np.int64)
    cuts[0], cuts[1] = low, high
    cost = np.empty(WIDTH)
    cost[0] = _cost(boxes, order, low, high)
    n = 1 if high > low else 0
    while 0 < n < WIDTH:
        worst = 0
        for k in range(1, n):
            if cost[k] > cost[worst]:
                worst = k
        first, last = cuts[worst], cuts[worst + 1]
        if cost[worst] < 0.0:
            break
        middle = _split(boxes, order, scratch, first, last)
        for k in range(n, worst, -1):
            cuts[k + 1] = cuts[k]
            cost[k] = cost[k - 1]
        cuts[worst + 1] = middle
        cost[worst] = _cost(boxes, order, first, middle)
        cost[worst + 1] = _cost(boxes, order, middle, last)
        n += 1
    return cuts[: n + 1]


@njit
def _cost(boxes: Floats, order: Ints, low: int, high: int) -> float:
    """Surface times number of boxes; -1 for a single one, which is never split."""
    return -1.0 if high - low < 2 else _area(_union(boxes, order, low, high)) * (high - low)


@njit
def _union(boxes: Floats, order: Ints, low: int, high: int) -> Floats:
    box = boxes[order[low]].copy()
    for i in range(low + 1, high):
        _extend(box, boxes[order[i]])
    return box


@njit
def _extend(box: Floats, other: Floats) -> None:
    for axis in range(3):
        box[axis] = min(box[axis], other[axis])
        box[3 + axis] = max(box[3 + axis], other[3 + axis])


@njit
def _area(box: Floats) -> float:
    """Half the surface of a box; 0 for one that is inside out."""
    x, y, z = box[3] - box[0], box[4] - box[1], box[5] - box[2]
    return 0.0 if x < 0.0 else x * y + y * z + z * x


@njit
def _split(boxes: Floats, order: Ints, scratch: Ints, low: int, high: int) -> int:
    """Reorder order[low:high] about the cheapest plane between bins; its position."""
    axis, start, extent = _longest_axis(boxes, order, low, high)
    middle = low
    per_bin = BINS * (1.0 - 2.0**-40) / extent
    if 0.0 < per_bin < np.inf:  # centres that are one, or a subnormal number apart, have no bins
        plane = _cheapest_plane(boxes, order, low, high, axis, start, per_bin)
        middle = _partition(boxes, order, scratch, low, high, axis, start, per_bin, plane)
    return middle if low < middle < high else (low + high) // 2


@njit
def _longest_axis(boxes: Floats, order: Ints, low: int, high: int) -> tuple[int, float, float]:
    """Axis on which the boxes' centres spread most; twice its least centre, twice the spread."""
    best, start, extent = 0, 0.0, -1.0
    for axis in range(3):
        least, most = np.inf, -np.inf
        for i in range(low, high):
            centre = boxes[order[i], axis] + boxes[order[i], 3 + axis]
            least, most = min(least, centre), max(most, centre)
        if most - least > extent:
            best, start, extent = axis, least, most - least
    return best, start, extent


@njit
def _bin(boxes: Floats, i: int, axis: int, start: float, per_bin: float) -> int:
    return int((boxes[i, axis] + boxes[i, 3 + axis] - start) * per_bin)


@njit
def _cheapest_plane(
    boxes: Floats, order: Ints, low: int, high: int, axis: int, start: float, per_bin: float
) -> int:
    """The first bin of the upper part, by the least sum of surface times number."""
    count = np.zeros(BINS, np.int64)
    box = np.empty((BINS, 6))
    box[:, :3], box[:, 3:] = np.inf, -np.inf
    for i in order[low:high]:
        k = _bin(boxes, i, axis, start, per_bin)
        count[k] += 1
        _extend(box[k], boxes[i])
    cost = np.zeros(BINS)
    for sign in (1, -1):
        below, n = np.empty(6), 0
        below[:3], below[3:] = np.inf, -np.inf
        for step in range(BINS - 1):
            k = step if sign == 1 else BINS - 1 - step
            _extend(below, box[k])
            n += count[k]
            cost[k + 1 if sign == 1 else k] += _area(below) * n
    return int(1 + np.argmin(cost[1:]))


@njit
def _partition(
    boxes: Floats,
    order: Ints,
    scratch: Ints,
    low: int,
    high: int,
    axis: int,
    start: float,
    per_bin: float,
    plane: int,
) -> int:
    """Stable partition of order[low:high] by bin < plane; where the upper part begins."""
    middle, above = low, 0
    for position in range(low, high):
        i = order[position]
        if _bin(boxes, i, axis, start, per_bin) < plane:
            order[middle] = i
            middle += 1
        else:
            scratch[above] = i
            above += 1
    order[middle:high] = scratch[:above]
    return middle


def shifted(tree: Tree, *, nodes: int, leaves: int) -> Tree:
    """The same tree with ``nodes`` and ``leaves`` added to its numbers."""
    old = tree.children
    children = np.where(old >= 0, old + nodes, np.where(old == EMPTY, EMPTY, old - leaves))
    return Tree(tree.bounds, children.astype(np.int32))
