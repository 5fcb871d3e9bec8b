"""The 8-wide bounding volume tree: which boxes may a ray enter?

Built by binned surface area heuristic (Wald 2007, "On fast construction of SAH-based bounding
volume hierarchies"): a node splits its costliest segment until it has eight.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit

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


class Scratch(NamedTuple):
    """What building a tree writes to."""

    order: Ints
    """(n,) int32: the boxes, so that each node has a segment of them."""
    moving: Ints
    """(n,) int32."""
    cuts: NDArray[np.int64]
    """(9,) int64: where the segments of a node begin, and where the last one ends."""
    costs: Floats
    """(8,) float64: of the segments of a node."""
    box: Floats
    """(6,) float64."""
    bins: Floats
    """(BINS, 6) float64: the boxes of each bin ..."""
    counts: NDArray[np.int64]
    """(BINS,) int64: ... their number ..."""
    planes: Floats
    """(BINS,) float64: ... and the cost of a plane before it."""


def build(boxes: Floats) -> Tree:
    """Build the tree over ``boxes`` (n, 6) float64, low then high corner; leaf i is box i.

    Equal boxes give equal trees.
    """
    n = len(boxes)
    memory = Scratch(
        order=np.arange(n, dtype=np.int32),
        moving=np.empty(n, np.int32),
        cuts=np.empty(WIDTH + 1, np.int64),
        costs=np.empty(WIDTH),
        box=np.empty(6),
        bins=np.empty((BINS, 6)),
        counts=np.empty(BINS, np.int64),
        planes=np.empty(BINS),
    )
    bounds = np.empty((max(n, 1), 6, WIDTH))
    bounds[:, :3], bounds[:, 3:] = np.inf, -np.inf
    children = np.full((max(n, 1), WIDTH), EMPTY, np.int32)
    spans = np.empty((max(n, 1), 2), np.int64)
    spans[0] = 0, n
    n_nodes = _build(boxes, memory, bounds, children, spans)
    # A node of eight takes the place of seven splits, so most of the room was never used.
    return Tree(bounds[:n_nodes].copy(), children[:n_nodes].copy())


@njit
def _build(
    boxes: Floats, memory: Scratch, bounds: Floats, children: Ints, spans: NDArray[np.int64]
) -> int:
    """Fill the arrays of a tree; how many nodes it has."""
    n_nodes = 1
    node = 0
    while node < n_nodes:  # spans is the queue: children are numbered after their parents
        n = _cut_in_eight(boxes, memory, spans[node, 0], spans[node, 1])
        for k in range(n):
            low, high = memory.cuts[k], memory.cuts[k + 1]
            _unite(boxes, memory, low, high)
            for side in range(6):
                bounds[node, side, k] = memory.box[side]
            if high - low == 1:
                children[node, k] = ~memory.order[low]
            else:
                children[node, k] = n_nodes
                spans[n_nodes, 0], spans[n_nodes, 1] = low, high
                n_nodes += 1
        node += 1
    return n_nodes


@kernel
def _cut_in_eight(boxes: Floats, memory: Scratch, low: int, high: int) -> int:
    """Cut order[low:high] into at most eight segments; how many there are."""
    cuts, costs = memory.cuts, memory.costs
    cuts[0], cuts[1] = low, high
    costs[0] = _cost(boxes, memory, low, high)
    n = 1 if high > low else 0
    while 0 < n < WIDTH:
        worst = 0
        for k in range(1, n):
            if costs[k] > costs[worst]:  # of equal ones the first: equal boxes, equal trees
                worst = k
        first, last = cuts[worst], cuts[worst + 1]
        if costs[worst] < 0.0:  # all segments are single boxes
            break
        middle = _split(boxes, memory, first, last)
        for k in range(n, worst, -1):
            cuts[k + 1] = cuts[k]
            costs[k] = costs[k - 1]
        cuts[worst + 1] = middle
        costs[worst] = _cost(boxes, memory, first, middle)
        costs[worst + 1] = _cost(boxes, memory, middle, last)
        n += 1
    return n


@kernel
def _cost(boxes: Floats, memory: Scratch, low: int, high: int) -> float:
    """Surface times number of boxes; -1 for a single one, which is never split."""
    if high - low < 2:
        return -1.0
    _unite(boxes, memory, low, high)
    return _area(memory.box) * (high - low)


@kernel
def _unite(boxes: Floats, memory: Scratch, low: int, high: int) -> None:
    """Make memory.box the box of order[low:high]."""
    _clear(memory.box)
    for i in range(low, high):
        _extend(memory.box, boxes[memory.order[i]])


@kernel
def _clear(box: Floats) -> None:
    """Turn a box inside out: what it is extended by, it becomes."""
    for axis in range(3):
        box[axis], box[3 + axis] = np.inf, -np.inf


@kernel
def _extend(box: Floats, other: Floats) -> None:
    for axis in range(3):
        box[axis] = min(box[axis], other[axis])
        box[3 + axis] = max(box[3 + axis], other[3 + axis])


@kernel
def _area(box: Floats) -> float:
    """Half the surface of a box; 0 for one that is inside out."""
    x, y, z = box[3] - box[0], box[4] - box[1], box[5] - box[2]
    return 0.0 if x < 0.0 else x * y + y * z + z * x


@kernel
def _split(boxes: Floats, memory: Scratch, low: int, high: int) -> int:
    """Reorder order[low:high] about the cheapest plane between bins; its position."""
    axis, start, extent = _longest_axis(boxes, memory.order, low, high)
    middle = low
    # A little less than BINS, so that the greatest centre is in the last bin and not behind it.
    per_bin = BINS * (1.0 - 2.0**-40) / extent
    if 0.0 < per_bin < np.inf:  # centres that are one, or a subnormal number apart, have no bins
        plane = _cheapest_plane(boxes, memory, low, high, axis, start, per_bin)
        middle = _partition(boxes, memory, low, high, axis, start, per_bin, plane)
    # A half where there are no bins, as for boxes that are one and the same: it has to end.
    return middle if low < middle < high else (low + high) // 2


@kernel
def _longest_axis(boxes: Floats, order: Ints, low: int, high: int) -> tuple[int, float, float]:
    """Axis on which the boxes' centres spread most; twice its least centre, twice the spread."""
    best, start, extent = 0, 0.0, -1.0
    for axis in range(3):
        least, most = np.inf, -np.inf
        for i in range(low, high):
            # The sum of the corners: no halving, and a subnormal number is not rounded to 0.
            centre = boxes[order[i], axis] + boxes[order[i], 3 + axis]
            least, most = min(least, centre), max(most, centre)
        if most - least > extent:
            best, start, extent = axis, least, most - least
    return best, start, extent


@kernel
def _bin(boxes: Floats, i: int, axis: int, start: float, per_bin: float) -> int:
    return int((boxes[i, axis] + boxes[i, 3 + axis] - start) * per_bin)


@kernel
def _cheapest_plane(
    boxes: Floats, memory: Scratch, low: int, high: int, axis: int, start: float, per_bin: float
) -> int:
    """The first bin of the upper part, by the least sum of surface times number."""
    bins, counts, planes, below = memory.bins, memory.counts, memory.planes, memory.box
    for k in range(BINS):
        _clear(bins[k])
        counts[k], planes[k] = 0, 0.0
    for at in range(low, high):
        i = memory.order[at]
        k = _bin(boxes, i, axis, start, per_bin)
        counts[k] += 1
        _extend(bins[k], boxes[i])
    # Two passes, from below and from above: each adds its side's share to every plane's cost.
    for sign in (1, -1):
        _clear(below)
        n = 0
        for step in range(BINS - 1):
            k = step if sign == 1 else BINS - 1 - step
            _extend(below, bins[k])
            n += counts[k]
            planes[k + 1 if sign == 1 else k] += _area(below) * n
    best = 1
    for k in range(2, BINS):
        if planes[k] < planes[best]:
            best = k
    return best


@kernel
def _partition(
    boxes: Floats,
    memory: Scratch,
    low: int,
    high: int,
    axis: int,
    start: float,
    per_bin: float,
    plane: int,
) -> int:
    """Stable partition of order[low:high] by bin < plane; where the upper part begins."""
    order, moving = memory.order, memory.moving
    middle, above = low, 0
    for position in range(low, high):
        i = order[position]
        if _bin(boxes, i, axis, start, per_bin) < plane:
            order[middle] = i
            middle += 1
        else:
            moving[above] = i
            above += 1
    for k in range(above):  # a slice would have numba compile how shapes that differ are told
        order[middle + k] = moving[k]
    return middle


def shifted(tree: Tree, *, nodes: int, leaves: int) -> Tree:
    """The same tree with ``nodes`` and ``leaves`` added to its numbers."""
    old = tree.children
    # ~(leaf + leaves) is ~leaf - leaves.
    children = np.where(old >= 0, old + nodes, np.where(old == EMPTY, EMPTY, old - leaves))
    return Tree(tree.bounds, children.astype(np.int32))
