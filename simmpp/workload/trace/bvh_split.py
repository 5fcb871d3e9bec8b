"""Where a node of the tree is cut: bins along the longest axis, and the cheapest plane between two.

Each box is read once for a cut: what the two parts need for the next cuts is the union of bins.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

WIDTH = 8
BINS = 16
SIDES = 12
"""Numbers of an extent: low and high corner of a box, then of the doubled centres of boxes."""


class Scratch(NamedTuple):
    """What building a tree writes to."""

    order: Ints
    """(n,) int32: the boxes, so that each node has a segment of them."""
    moving: Ints
    """(n,) int32."""
    bin_of: NDArray[np.uint8]
    """(n,) uint8, of the boxes in order."""
    cuts: NDArray[np.int64]
    """(9,) int64: where the segments of a node begin, and where the last one ends."""
    extents: Floats
    """(8, 12) float64: of the segments of a node ..."""
    costs: Floats
    """(8,) float64: ... and what they cost."""
    bins: Floats
    """(BINS, 12) float64: the extents of each bin ..."""
    counts: NDArray[np.int64]
    """(BINS,) int64: ... their number ..."""
    planes: Floats
    """(BINS,) float64: ... and the cost of a plane before it."""


def scratch(n: int) -> Scratch:
    """Memory for trees over at most ``n`` boxes."""
    return Scratch(
        order=np.empty(n, np.int32),
        moving=np.empty(n, np.int32),
        bin_of=np.empty(n, np.uint8),
        cuts=np.empty(WIDTH + 1, np.int64),
        extents=np.empty((WIDTH, SIDES)),
        costs=np.empty(WIDTH),
        bins=np.empty((BINS, SIDES)),
        counts=np.empty(BINS, np.int64),
        planes=np.empty(BINS),
    )


@kernel
def measure(boxes: Floats, memory: Scratch, k: int) -> None:
    """Extent and cost of segment ``k``, by looking at its boxes."""
    extent = memory.extents[k]
    _clear(extent)
    for at in range(memory.cuts[k], memory.cuts[k + 1]):
        _extend(extent, boxes, memory.order[at])
    _weigh(memory, k)


@kernel
def split(boxes: Floats, memory: Scratch, k: int, n: int) -> None:
    """Cut segment ``k`` of ``n`` in two, ``k`` and ``k + 1``; those behind move up."""
    cuts, extents = memory.cuts, memory.extents
    for other in range(n, k, -1):
        cuts[other + 1] = cuts[other]
        for side in range(SIDES):
            extents[other, side] = extents[other - 1, side]
        memory.costs[other] = memory.costs[other - 1]
    low, high = cuts[k], cuts[k + 2]
    axis, start, per_bin = _bins_of(extents[k])
    middle = low
    if 0.0 < per_bin < np.inf:  # centres that are one, or a subnormal number apart, have no bins
        _fill_bins(boxes, memory, low, high, axis, start, per_bin)
        plane = _cheapest_plane(memory)
        middle = _partition(memory, low, high, plane)
        _unite(memory.bins, 0, plane, extents[k])
        _unite(memory.bins, plane, BINS, extents[k + 1])
    # A half where there are no bins, as for boxes that are one and the same: it has to end.
    cuts[k + 1] = middle if low < middle < high else (low + high) // 2
    if cuts[k + 1] == middle:
        _weigh(memory, k)
        _weigh(memory, k + 1)
    else:
        measure(boxes, memory, k)
        measure(boxes, memory, k + 1)


@kernel
def _weigh(memory: Scratch, k: int) -> None:
    """The cost of a segment: surface times number; -1 if it fits a node, and need not be split."""
    number = memory.cuts[k + 1] - memory.cuts[k]
    memory.costs[k] = _area(memory.extents[k]) * number if number > WIDTH else -1.0


@kernel
def _clear(extent: Floats) -> None:
    """Turn an extent inside out: what it is extended by, it becomes."""
    for side in range(0, SIDES, 6):
        for axis in range(3):
            extent[side + axis], extent[side + 3 + axis] = np.inf, -np.inf


@kernel
def _extend(extent: Floats, boxes: Floats, i: int) -> None:
    """Have an extent hold box ``i``."""
    for axis in range(3):
        low, high = boxes[i, axis], boxes[i, 3 + axis]
        # The sum of the corners: no halving, and a subnormal number is not rounded to 0.
        centre = low + high
        extent[axis] = low if low < extent[axis] else extent[axis]
        extent[3 + axis] = high if high > extent[3 + axis] else extent[3 + axis]
        extent[6 + axis] = centre if centre < extent[6 + axis] else extent[6 + axis]
        extent[9 + axis] = centre if centre > extent[9 + axis] else extent[9 + axis]


@kernel
def _unite(bins: Floats, first: int, after: int, extent: Floats) -> None:
    """Make an extent that of some bins."""
    _clear(extent)
    for k in range(first, after):
        for side in range(0, SIDES, 6):
            for axis in range(side, side + 3):
                extent[axis] = min(extent[axis], bins[k, axis])
                extent[3 + axis] = max(extent[3 + axis], bins[k, 3 + axis])


@kernel
def _area(box: Floats) -> float:
    """Half the surface of a box; 0 for one that is inside out."""
    x, y, z = box[3] - box[0], box[4] - box[1], box[5] - box[2]
    return 0.0 if x < 0.0 else x * y + y * z + z * x


@kernel
def _bins_of(extent: Floats) -> tuple[int, float, float]:
    """Axis on which the boxes' centres spread most, twice its least centre, bins per length."""
    best, widest = 0, -1.0
    for axis in range(3):
        width = extent[9 + axis] - extent[6 + axis]
        if width > widest:
            best, widest = axis, width
    # A little less than BINS, so that the greatest centre is in the last bin and not behind it.
    return best, extent[6 + best], BINS * (1.0 - 2.0**-40) / widest


@kernel
def _fill_bins(
    boxes: Floats, memory: Scratch, low: int, high: int, axis: int, start: float, per_bin: float
) -> None:
    """Which bin each box of order[low:high] is in, and the extents and numbers of all bins."""
    for k in range(BINS):
        _clear(memory.bins[k])
        memory.counts[k] = 0
    for at in range(low, high):
        i = memory.order[at]
        k = int((boxes[i, axis] + boxes[i, 3 + axis] - start) * per_bin)
        memory.bin_of[at] = k
        memory.counts[k] += 1
        _extend(memory.bins[k], boxes, i)


@kernel
def _cheapest_plane(memory: Scratch) -> int:
    """The first bin of the upper part, by the least sum of surface times number."""
    bins, counts, planes = memory.bins, memory.counts, memory.planes
    # Two passes, from below and from above: each adds its side's share to every plane's cost.
    for upwards in (True, False):
        x = y = z = np.inf
        u = v = w = -np.inf
        n = 0
        for step in range(BINS - 1):
            k = step if upwards else BINS - 1 - step
            x, y, z = min(x, bins[k, 0]), min(y, bins[k, 1]), min(z, bins[k, 2])
            u, v, w = max(u, bins[k, 3]), max(v, bins[k, 4]), max(w, bins[k, 5])
            n += counts[k]
            a, b, c = u - x, v - y, w - z
            cost = 0.0 if a < 0.0 else (a * b + b * c + c * a) * n
            if upwards:
                planes[k + 1] = cost
            else:
                planes[k] += cost
    best = 1
    for k in range(2, BINS):
        if planes[k] < planes[best]:
            best = k
    return best


@kernel
def _partition(memory: Scratch, low: int, high: int, plane: int) -> int:
    """Stable partition of order[low:high] by bin < plane; where the upper part begins."""
    order, moving = memory.order, memory.moving
    middle, above = low, 0
    for position in range(low, high):
        i = order[position]
        if memory.bin_of[position] < plane:
            order[middle] = i
            middle += 1
        else:
            moving[above] = i
            above += 1
    for k in range(above):  # a slice would have numba compile how shapes that differ are told
        order[middle + k] = moving[k]
    return middle
