"""Itineraries: which objects must a ray be tested against, in which order, and what does it hit?

embree has proposed a hit, which only bounds the search: the answer is a function of the float64
geometry alone. A search to a bound b that finds a hit at most at b has found the nearest, because
no hit comes before its object's box is entered; if it finds none, it is repeated without a bound.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from simmpp.workload.bvh import WIDTH
from simmpp.workload.exact import entries, entry, hit_object, hit_triangle, ray_of, row_of
from simmpp.workload.workload import SHADOW

SLACK = 1.0 + 1e-12
"""Boxes entered this little behind the hit still belong to the itinerary."""


class Work(NamedTuple):
    """Memory of a search, made once per batch by :func:`work_for`."""

    stack: NDArray[np.int32]
    """Nodes of the objects' tree still to visit."""
    found: NDArray[np.float64]
    """(8,) float64: entries of the boxes of one node."""
    inner_stack: NDArray[np.int32]
    """The same for the tree of one object ..."""
    inner_found: NDArray[np.float64]
    ids: NDArray[np.int32]
    """Candidates of one ray ..."""
    enters: NDArray[np.float64]
    """... and where it enters their boxes."""


@njit(cache=True, error_model="numpy", nogil=True)
def work_for(shapes):
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


@njit(cache=True, error_model="numpy", nogil=True)
def find_itineraries(shapes, boxes, origins, directions, kinds, limits, sources, claims):
    """Hits and itineraries of a batch of n rays.

    Parameters
    ----------
    shapes, boxes : of the :class:`~simmpp.workload.geometry.Geometry`
    origins, directions : (n, 3) float64, directions of length 1
    kinds : (n,) uint8
    limits : (n,) float64, distance to the light of a shadow ray
    sources : (n,) int32, the object a ray can't hit because it leaves it for good; -1 for none
    claims : (n, 2) int32, object and row of the triangle that embree proposes; -1 for none

    Returns
    -------
    hits (n,) int32, distances (n,) float64, counts (n,) int32, objects (sum of counts,) int32
    """
    n = len(kinds)
    hits, distances = np.empty(n, np.int32), np.empty(n)
    counts, objects = np.empty(n, np.int32), np.empty(4 * n + 16, np.int32)
    used = 0
    work = work_for(shapes)
    ids = work.ids
    for i in range(n):
        ray = ray_of(origins, directions, i)
        claim = claims[i, 0] if claims[i, 0] != sources[i] else -1
        if kinds[i] == SHADOW:
            hit, t, m = _first_blocker(shapes, boxes, ray, limits[i], sources[i], claim, work)
        else:
            hit, t, m = _nearest(shapes, ray, sources[i], claim, claims[i, 1], work)
        hits[i], distances[i], counts[i] = hit, t, m
        if used + m > len(objects):
            objects = _enlarged(objects, used, 2 * (used + m))
        for k in range(m):
            objects[used + k] = ids[k]
        used += m
    return hits, distances, counts, objects[:used].copy()


@njit(cache=True, error_model="numpy", nogil=True)
def _enlarged(objects, used, size):
    larger = np.empty(size, np.int32)
    larger[:used] = objects[:used]
    return larger


@njit(cache=True, error_model="numpy", nogil=True)
def _nearest(shapes, ray, source, claimed, row, work):
    """Nearest hit (-1 for none), its distance, and the number of sorted candidates."""
    stack, found, inner_stack, inner_found, ids, enters = work
    bound = np.inf
    if claimed >= 0 and row >= 0:
        bound = hit_triangle(row_of(shapes.surfaces, row), ray, shapes.t_min)
    elif claimed >= 0:
        bound, _ = hit_object(shapes, claimed, ray, 0.0, np.inf, inner_stack, inner_found)
    hit, t, m = _search(shapes, ray, source, bound, work)
    if t > bound:
        hit, t, m = _search(shapes, ray, source, np.inf, work)
    return hit, t, _keep(ids, enters, m, t * SLACK)


@njit(cache=True, error_model="numpy", nogil=True)
def _search(shapes, ray, source, bound, work):
    """Nearest hit among objects entered within ``bound``, ties by (distance, object).

    Leaves a superset of its itinerary in ``work``, unsorted; the third value is its length.
    """
    objects, surfaces, bounds, children, t_min = shapes
    stack, found, inner_stack, inner_found, ids, enters = work
    hit, best, m, limit = -1, np.inf, 0, bound * SLACK
    stack[0] = 0
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        entries(bounds, node, ray, found)
        for k in range(WIDTH):
            if not (found[k] <= limit and found[k] < np.inf):
                continue
            child = children[node, k]
            if child >= 0:
                stack[depth] = child
                depth += 1
            elif ~child != source:
                ids[m], enters[m] = ~child, found[k]
                m += 1
                t, _ = hit_object(shapes, ~child, ray, found[k], limit, inner_stack, inner_found)
                if t < best or (t == best and ~child < hit):
                    hit, best = ~child, t
                    limit = min(limit, t * SLACK)
    return hit, best, m


@njit(cache=True, error_model="numpy", nogil=True)
def _first_blocker(shapes, boxes, ray, light, source, claimed, work):
    """First object of the itinerary that blocks the ``light`` at that distance, ties by object.

    Returns it (-1 for none), its distance, and the number of sorted candidates up to it.
    """
    objects, surfaces, bounds, children, t_min = shapes
    stack, found, inner_stack, inner_found, ids, enters = work
    hit, t_hit, last, m = -1, np.inf, light, 0
    if claimed >= 0:
        enter = entry(boxes, claimed, ray)
        t, _ = hit_object(shapes, claimed, ray, enter, light, inner_stack, inner_found)
        if t < light:
            hit, t_hit, last = claimed, t, enter
    stack[0] = 0
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        entries(bounds, node, ray, found)
        for k in range(WIDTH):
            if not found[k] <= last:
                continue
            child = children[node, k]
            if child >= 0:
                stack[depth] = child
                depth += 1
            elif ~child != source and not (found[k] == last and 0 <= hit < ~child):
                ids[m], enters[m] = ~child, found[k]
                m += 1
                if ~child == hit:
                    continue
                t, _ = hit_object(shapes, ~child, ray, found[k], light, inner_stack, inner_found)
                if t < light:
                    hit, t_hit, last = ~child, t, found[k]
    m = _keep(ids, enters, m, last)
    while hit >= 0 and ids[m - 1] != hit:
        m -= 1
    return hit, t_hit, m


@njit(cache=True, error_model="numpy", nogil=True)
def _keep(ids, enters, m, last):
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
