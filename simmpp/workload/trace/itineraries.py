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

from simmpp.common.compiled import kernel, njit
from simmpp.workload.trace.bvh import WIDTH
from simmpp.workload.trace.exact import Ray, entries, hit_object, hit_triangle, ray_of, row_of
from simmpp.workload.trace.geometry import Shapes
from simmpp.workload.workload import SHADOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Batch = tuple[Floats, Floats, NDArray[np.uint8], Floats, Ints, Ints]
"""Origins, directions, kinds, limits, sources and claims."""
Answers = tuple[Ints, Floats, Ints]
"""Hits, distances and lengths of the itineraries."""

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
    rays = origins, directions, kinds, limits, sources, claims
    hits, distances, counts = answers = np.empty(n, np.int32), np.empty(n), np.empty(n, np.int32)
    work, parts, done = work_for(shapes), [np.empty(0, np.int32)], 0
    while done < n:
        objects = np.empty(4 * (n - done) + len(work.ids), np.int32)
        done, used = _find(shapes, rays, answers, objects, work, done)
        parts.append(objects[:used])
    return hits, distances, counts, np.concatenate(parts)


@njit
def _find(
    shapes: Shapes, rays: Batch, answers: Answers, objects: Ints, work: Work, first: int
) -> tuple[int, int]:
    """Answer for the rays from ``first`` on, as long as ``objects`` can hold any itinerary.

    Returns the next ray and how much of ``objects`` is used.
    """
    origins, directions, kinds, limits, sources, claims = rays
    hits, distances, counts = answers
    used, i = 0, first
    while i < len(kinds) and used + len(work.ids) <= len(objects):
        ray = ray_of(origins, directions, i)
        claimed = claims[i, 0] if claims[i, 0] != sources[i] else -1
        if kinds[i] == SHADOW:
            hit, t, m = _first_blocker(shapes, ray, limits[i], sources[i], work)
        else:
            hit, t, m = _nearest(shapes, ray, sources[i], claimed, claims[i, 1], work)
        hits[i], distances[i], counts[i] = hit, t, m
        for k in range(m):
            objects[used + k] = work.ids[k]
        used += m
        i += 1
    return i, used


@kernel
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


@kernel
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


@kernel
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


@kernel
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
