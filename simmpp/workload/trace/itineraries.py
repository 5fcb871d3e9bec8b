"""Itineraries: which objects must a ray be tested against, in which order, and what does it hit?

embree has proposed a hit, which only bounds the search: the answer is a function of the float64
geometry alone. No hit comes before its object's box is entered, so a search of all boxes entered
up to b that finds a hit not beyond b has found the nearest; if it finds none, it is repeated
without a bound. Shadow rays are searched without a proposal: it costs more than it saves.

A ray that enters five boxes and hits three of the objects in them, at these distances::

    object     0    1    2    3    4
    entered    1    2    3    4    6     nearest hit   3 at 4.5, itinerary 0 1 2 3
    hit        -    5    -    4.5  7     shadow ray    1 at 5, itinerary 0 1

If embree proposes 1, boxes entered up to 5 are searched, and from the hit of 3 on those up to 4.5:
4 is not tested. If it proposes 2, which float64 misses, there is no bound at first, and the answer
is the same. A shadow ray tests in the same order and stops at the first object that blocks the
light, although 3 is nearer: whether light passes does not depend on which object stops it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.workload.trace.bvh_split import WIDTH
from simmpp.workload.trace.exact import Ray, Walk, entries, hit_object, hit_triangle, ray_of, row_of
from simmpp.workload.trace.geometry import Shapes
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.workload import SHADOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Answers = tuple[Ints, Floats, Ints]
"""Hits, distances and lengths of the itineraries."""

SLACK = 1.0 + 1e-12
"""Boxes entered this little behind the hit still belong to the itinerary."""


class Work(NamedTuple):
    """Memory of a search, made once per batch by :func:`work_for`."""

    outer: Walk
    """Through the tree over the objects."""
    inner: Walk
    """Through the tree of one object, while the other stands still."""
    ids: Ints
    """Candidates of one ray ..."""
    enters: Floats
    """... and where it enters their boxes."""


def work_for(shapes: Shapes) -> Work:
    """Memory for any search in ``shapes``: no node is pushed twice."""
    nodes, n = len(shapes.children) + 1, len(shapes.objects) + 1
    outer, inner = (Walk(np.empty(nodes, np.int32), np.empty(WIDTH)) for _ in range(2))
    return Work(outer, inner, np.empty(n, np.int32), np.empty(n))


def find_itineraries(
    shapes: Shapes, rays: RayBatch, claims: Ints
) -> tuple[Ints, Floats, Ints, Ints]:
    """Hits and itineraries of a batch of n rays.

    Parameters
    ----------
    shapes : of the :class:`~simmpp.workload.trace.geometry.Geometry`
    rays : their parents are not read
    claims : (n, 2) int32, object and row of the triangle that embree proposes; -1 for none

    Returns
    -------
    hits (n,) int32, distances (n,) float64, counts (n,) int32, objects (sum of counts,) int32
    """
    n = len(rays.kinds)
    hits, distances, counts = answers = np.empty(n, np.int32), np.empty(n), np.empty(n, np.int32)
    work, parts, done = work_for(shapes), [np.empty(0, np.int32)], 0
    while done < n:
        # A guess of four objects per ray left, and always room for one more ray that meets all.
        objects = np.empty(4 * (n - done) + len(work.ids), np.int32)
        done, used = _find(shapes, rays, claims, answers, objects, work, done)
        parts.append(objects[:used])
    return hits, distances, counts, np.concatenate(parts)


@njit
def _find(
    shapes: Shapes,
    rays: RayBatch,
    claims: Ints,
    answers: Answers,
    objects: Ints,
    work: Work,
    first: int,
) -> tuple[int, int]:
    """Answer for the rays from ``first`` on, as long as ``objects`` can hold any itinerary.

    Returns the next ray and how much of ``objects`` is used.
    """
    hits, distances, counts = answers
    used, i = 0, first
    while i < len(hits) and used + len(work.ids) <= len(objects):
        ray, source = ray_of(rays.origins, rays.directions, i), rays.sources[i]
        if rays.kinds[i] == SHADOW:
            hit, t, m = _first_blocker(shapes, ray, rays.limits[i], source, work)
        else:
            # The object that the ray leaves is never tested, so a hit on it would be no bound.
            claimed = claims[i, 0] if claims[i, 0] != source else -1
            hit, t, m = _nearest(shapes, ray, source, claimed, claims[i, 1], work)
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
    # What is not hit in float64 gives infinity here, and so a search that has no bound.
    if claimed >= 0 and row >= 0:
        bound = hit_triangle(row_of(shapes.surfaces, row), ray, shapes.t_min)
    elif claimed >= 0:
        bound, _ = hit_object(shapes, claimed, ray, 0.0, np.inf, work.inner)
    hit, t, m = _search(shapes, ray, source, False, np.inf, bound * SLACK, work)
    # Nothing up to the bound, so it was none. A hit in the slack behind it does not count: of the
    # boxes in the slack behind that hit not all were searched.
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
    # Boxes that are entered where the blocker's is may stand behind it, by number: cut them off.
    while hit >= 0 and work.ids[m - 1] != hit:
        m -= 1
    return hit, t, m


@kernel
def _search(
    shapes: Shapes, ray: Ray, source: int, shadow: bool, light: float, limit: float, work: Work
) -> tuple[int, float, int]:
    """The hit before ``light`` that comes first, among objects entered at most at ``limit``.

    First by (distance, object), for a shadow ray by (entry, object). Returns the object, its
    distance and the number of boxes entered until then, in ``work`` by (entry, object).
    """
    hit, first, distance, m = -1, np.inf, np.inf, 0
    (stack, entered), ids, enters = work.outer, work.ids, work.enters
    stack[0] = 0
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        entries(shapes.bounds, node, ray, entered)
        for k in range(WIDTH):
            # Twice, since a limit of infinity is not below the infinity of a box that is missed.
            if not (entered[k] <= limit and entered[k] < np.inf):
                continue
            child = shapes.children[node, k]
            if child >= 0:
                # In any order: the answer does not depend on it, and the bound has cut the rest.
                stack[depth] = child
                depth += 1
            elif ~child != source:
                ids[m], enters[m] = ~child, entered[k]
                m += 1
                reach = light if shadow else limit
                t, _ = hit_object(shapes, ~child, ray, entered[k], reach, work.inner)
                # Ties go to the lower number, whichever the walk meets first: trees may change.
                place = entered[k] if shadow else t
                if t < light and (place < first or (place == first and ~child < hit)):
                    hit, first, distance = ~child, place, t
                    limit = min(limit, place if shadow else place * SLACK)
    return hit, distance, _keep(ids, enters, m, limit)


@kernel
def _keep(ids: Ints, enters: Floats, m: int, last: float) -> int:
    """Keep candidates entered at most at ``last``, sorted by (entry, object); their number."""
    # Most were noted while the limit was still far away.
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
