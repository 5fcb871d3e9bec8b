"""Itineraries: which objects must a ray be tested against, in which order, and what does it hit?

embree has proposed a hit, which only bounds the search: the answer is a function of the float64
geometry alone. No hit comes before its object's box is entered, so a search of all boxes entered
up to b that finds a hit not beyond b has found the nearest; if it finds none, it is repeated
without a bound. Shadow rays are searched without a proposal: it costs more than it saves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit, njit_reading
from simmpp.workload.trace.bvh import WIDTH
from simmpp.workload.trace.exact import Ray, entries, hit_object, hit_triangle, ray_of, row_of
from simmpp.workload.trace.geometry import Shapes
from simmpp.workload.workload import SHADOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

SLACK = 1.0 + 1e-12
"""Boxes entered this little behind the hit still belong to the itinerary."""


class Work(NamedTuple):
    """Memory of a search, made once per batch by :func:`work_for`."""

    stack: Ints
    """Nodes of the objects' tree still to visit."""
    found: Floats
    """(8,) float64: entries of the boxes of one node."""
    inner_stack: Ints
    """The same for the tree of one object ..."""
    inner_found: Floats
    ids: Ints
    """Candidates of one ray ..."""
    enters: Floats
    """... and where it enters their boxes."""


@njit
def work_for(shapes: Shapes) -> Work:
    """Memory for any search in ``shapes``: no node is pushed twice."""
    nodes, n = len(shapes.children) + 1, len(shapes.objects) + 1
    return Work(
        np.empty(nodes, np.int32),
        np.empty(WIDTH),
        np.empty(nodes, np.int32),
        np.empty(WIDTH),
        np.empty(n, np.int32),
        np.empty(n),
    )


@njit
def find_itineraries(
    shapes: Shapes,
    origins: Floats,
    directions: Floats,
    kinds: NDArray[np.uint8],
    limits: Floats,
    sources: Ints,
    claims: Ints,
) -> tuple[Ints, Floats, Ints, Ints]:
    """Hits and itineraries of a batch of n rays.

    Parameters
    ----------
    shapes : of the :class:`~simmpp.workload.trace.geometry.Geometry`
    origins, directions : (n, 3) float64, directions of length 1
    kinds : (n,) uint8
    limits : (n,) float64, distance to the light of a shadow ray, else infinity
    sources : (n,) int32, the object a ray can't hit because it leaves it for good; -1 for none
    claims : (n, 2) int32, object and row of the triangle that embree proposes; -1 for none

    Returns
    -------
    hits (n,) int32, distances (n,) float64, counts (n,) int32, objects (sum of counts,) int32
    """
    n = len(kinds)
    hits, distances = np.empty(n, np.int32), np.empty(n)
    counts, objects = np.empty(n, np.int32), np.empty(4 * n + 16, np.int32)
    work = work_for(shapes)
    used = 0
    for i in range(n):
        ray = ray_of(origins, directions, i)
        claimed = claims[i, 0] if claims[i, 0] != sources[i] else -1
        if kinds[i] == SHADOW:
            hit, t, m = _first_blocker(shapes, ray, limits[i], sources[i], work)
        else:
            hit, t, m = _nearest(shapes, ray, sources[i], claimed, claims[i, 1], work)
        hits[i], distances[i], counts[i] = hit, t, m
        if used + m > len(objects):
            objects = _enlarged(objects, used, 2 * (used + m))
        for k in range(m):
            objects[used + k] = work.ids[k]
        used += m
    return hits, distances, counts, objects[:used].copy()


@njit
def _enlarged(objects: Ints, used: int, size: int) -> Ints:
    larger = np.empty(size, np.int32)
    larger[:used] = objects[:used]
    return larger


@njit_reading
def _nearest(
    shapes: Shapes, ray: Ray, source: int, claimed: int, row: int, work: Work
) -> tuple[int, float, int]:
    """Nearest hit (-1 for none), its distance, and the length of the itinerary in ``work``."""
    bound = np.inf
    if claimed >= 0 and row >= 0:
        bound = hit_triangle(row_of(shapes.surfaces, row), ray, shapes.t_min)
    elif claimed >= 0:
        bound, _ = hit_object(shapes, claimed, ray, 0.0, np.inf, work.inner_stack, work.inner_found)
    hit, t, m = _search(shapes, ray, source, False, np.inf, bound * SLACK, work)
    if t > bound:
        hit, t, m = _search(shapes, ray, source, False, np.inf, np.inf, work)
    return hit, t, m


@njit_reading
def _first_blocker(
    shapes: Shapes, ray: Ray, light: float, source: int, work: Work
) -> tuple[int, float, int]:
    """First object of the itinerary that blocks the ``light`` at that distance; -1 for none.

    Returns it, its distance, and the length of the itinerary up to it in ``work``.
    """
    hit, t, m = _search(shapes, ray, source, True, light, light, work)
    while hit >= 0 and work.ids[m - 1] != hit:
        m -= 1
    return hit, t, m


@njit_reading
def _search(
    shapes: Shapes,
    ray: Ray,
    source: int,
    shadow: bool,
    light: float,
    limit: float,
    work: Work,
) -> tuple[int, float, int]:
    """The hit before ``light`` that comes first, among objects entered at most at ``limit``.

    First by (distance, object), for a shadow ray by (entry, object). Returns the object, its
    distance and the number of boxes entered until then, in ``work`` by (entry, object).
    """
    hit, first, distance, m = -1, np.inf, np.inf, 0
    stack, found, ids, enters = work.stack, work.found, work.ids, work.enters
    stack[0] = 0
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        entries(shapes.bounds, node, ray, found)
        for k in range(WIDTH):
            if not (found[k] <= limit and found[k] < np.inf):
                continue
            child = shapes.children[node, k]
            if child >= 0:
                stack[depth] = child
                depth += 1
            elif ~child != source:
                ids[m], enters[m] = ~child, found[k]
                m += 1
                reach = light if shadow else limit
                t, _ = hit_object(
                    shapes, ~child, ray, found[k], reach, work.inner_stack, work.inner_found
                )
                place = found[k] if shadow else t
                if t < light and (place < first or (place == first and ~child < hit)):
                    hit, first, distance = ~child, place, t
                    limit = min(limit, place if shadow else place * SLACK)
    return hit, distance, _keep(ids, enters, m, limit)


@njit_reading
def _keep(ids: Ints, enters: Floats, m: int, last: float) -> int:
    """Keep candidates entered at most at ``last``, sorted by (entry, object); their number."""
    kept = 0
    for k in range(m):
        if enters[k] <= last:
            ids[kept], enters[kept] = ids[k], enters[k]
            kept += 1
    gap = kept // 2 if kept > 32 else min(kept, 1)
    while gap > 0:  # shell sort: insertion sort for the usual short list
        for k in range(gap, kept):
            i, enter, place = ids[k], enters[k], k
            while place >= gap:
                before = place - gap
                if enters[before] < enter or (enters[before] == enter and ids[before] < i):
                    break
                ids[place], enters[place] = ids[before], enters[before]
                place = before
            ids[place], enters[place] = i, enter
        gap //= 2
    return kept
