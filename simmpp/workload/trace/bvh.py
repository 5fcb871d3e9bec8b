"""The 8-wide bounding volume tree: which boxes may a ray enter?

Built by binned surface area heuristic (Wald 2007, "On fast construction of SAH-based bounding
volume hierarchies"): a node splits its costliest segment until it has eight, or all of them fit
nodes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.workload.trace.bvh_split import WIDTH, Scratch, measure, scratch, split

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

EMPTY = np.int32(-(2**31))
"""Child of an unused slot; its box is inside out, so no ray enters it."""
NO_BOXES: Floats = np.empty((0, 6))
NO_SPANS: NDArray[np.int64] = np.empty((0, 2), np.int64)


class Tree(NamedTuple):
    """Nodes of eight boxes; the root of the first tree is node 0."""

    bounds: Floats
    """(nodes, 6, 8) float64: low x, y, z, then high x, y, z of each child."""
    children: Ints
    """(nodes, 8) int32: a node, or ~leaf, or EMPTY."""


def build(
    boxes: Floats, rows: Floats = NO_BOXES, spans: NDArray[np.int64] = NO_SPANS
) -> tuple[Tree, Ints]:
    """A tree over ``boxes``, one over each span of ``rows``, and the roots of the latter.

    Equal boxes give equal trees.

    Parameters
    ----------
    boxes : (n, 6) float64, low then high corner; leaf i of the first tree is box i
    rows : (m, 6) float64; leaf i of the others is row i
    spans : (k, 2) int64: the first row of a tree, and the row after its last
    """
    sizes = np.append(spans[:, 1] - spans[:, 0], len(boxes))
    # Of n leaves most nodes are made where each node of eight nodes holds two leaves in each.
    # What is never written takes no memory, so there may be room for all that can be.
    most = int((4 * sizes // 7 + 1).sum())
    tree = Tree(np.empty((most, 6, WIDTH)), np.empty((most, WIDTH), np.int32))
    roots, queue = np.empty(len(spans), np.int32), np.empty((most, 2), np.int64)
    used = _build(boxes, rows, spans, tree, roots, queue, scratch(int(sizes.max())))
    tree.bounds.resize((used, 6, WIDTH), refcheck=False)
    tree.children.resize((used, WIDTH), refcheck=False)
    return tree, roots


@njit
def _build(
    boxes: Floats,
    rows: Floats,
    spans: NDArray[np.int64],
    tree: Tree,
    roots: Ints,
    queue: NDArray[np.int64],
    memory: Scratch,
) -> int:
    """Fill the arrays of trees; how many nodes they have."""
    used = _grow(boxes, 0, len(boxes), tree, 0, queue, memory)
    for k in range(len(spans)):
        roots[k] = used
        used = _grow(rows, spans[k, 0], spans[k, 1], tree, used, queue, memory)
    return used


@kernel
def _grow(
    boxes: Floats,
    first: int,
    after: int,
    tree: Tree,
    root: int,
    queue: NDArray[np.int64],
    memory: Scratch,
) -> int:
    """A tree over boxes first ... after - 1, with its root at that node; the node after it."""
    for i in range(after - first):
        memory.order[i] = first + i
    queue[root, 0], queue[root, 1] = 0, after - first
    node, used = root, root + 1
    while node < used:  # children are numbered after their parents
        n = _cut_in_eight(boxes, memory, queue[node, 0], queue[node, 1])
        for k in range(WIDTH):
            low, high = memory.cuts[k], memory.cuts[k + 1]
            for side in range(6):
                inside_out = np.inf if side < 3 else -np.inf
                tree.bounds[node, side, k] = memory.extents[k, side] if k < n else inside_out
            if k >= n:
                tree.children[node, k] = EMPTY
            elif high - low == 1:
                tree.children[node, k] = ~memory.order[low]
            else:
                tree.children[node, k] = used
                queue[used, 0], queue[used, 1] = low, high
                used += 1
        node += 1
    return used


@kernel
def _cut_in_eight(boxes: Floats, memory: Scratch, low: int, high: int) -> int:
    """Cut order[low:high] into at most eight segments; how many there are."""
    n, cuts = high - low, memory.cuts
    if n <= WIDTH:  # as they come: in which slot a box is changes no answer
        for k in range(n):
            cuts[k], cuts[k + 1] = low + k, low + k + 1
            measure(boxes, memory, k)
        return n
    cuts[0], cuts[1] = low, high
    measure(boxes, memory, 0)
    for n_segments in range(1, WIDTH):
        worst = 0
        for k in range(1, n_segments):
            if memory.costs[k] > memory.costs[worst]:  # of equal ones the first: equal trees
                worst = k
        if memory.costs[worst] < 0.0:
            return n_segments
        split(boxes, memory, worst, n_segments)
    return WIDTH
