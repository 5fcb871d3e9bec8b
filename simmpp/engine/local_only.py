"""PEs that need nobody: a run in which nothing is remote, without its events.

Where every object that a PE's rays are tested against is in its memory (x = 1, the replicated
scene, one PE) no message is sent, and what a PE does is a sum: it works from the start until its
rays are finished, a quantum at a time. Only the most rays and bytes that it ever holds depend on
the order of its rays. Depth-first they are held soon after the start, while more of its pixels are
left than the rays that any later pixel brings forth; so far, and no farther, a PE is stepped
through its activities.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.engine.arrays.records import BEGIN, NONE, Row, Run
from simmpp.engine.arrays.views import (
    child_offsets,
    itinerary_objects,
    itinerary_offsets,
    pes,
    pixels,
    rays,
)
from simmpp.engine.pe.misses import is_in_memory
from simmpp.engine.pe.pace import cost_of_test_ps
from simmpp.engine.pe.step import step
from simmpp.machine.limits import CLOCK_LIMIT_PS

TOTALS = np.dtype(
    [
        ("tests", "i8"),
        ("compute_ps", "i8"),  # of all tests and rays
        ("last_ray", "i4"),  # the last primary ray or, breadth-first, the last ray; NONE: no rays
        ("largest_tree", "i4"),  # most rays under one pixel, the primary ray included
    ]
)
"""What one PE has to do in all."""


def run_alone(runs: NDArray[np.void]) -> bool:
    """Run to the end, if no ray needs an object that its PE lacks; else do nothing.

    Returns whether it has. Of the state only what a result is made of is valid afterwards. The run
    must not have begun, and neither keep a log nor record its tests.
    """
    n, n_primaries, processors = (
        int(runs[name][0]) for name in ("rays_n", "rays_left", "processors")
    )
    totals = np.zeros(processors, TOTALS)
    homes, trees = np.zeros(n_primaries, np.int32), np.zeros(n_primaries, np.int32)
    return _run_alone(runs, totals, homes, trees, np.zeros(n, np.int32))


@njit
def _run_alone(
    runs: NDArray[np.void],
    totals: NDArray[np.void],
    homes: NDArray[np.int32],
    trees: NDArray[np.int32],
    roots: NDArray[np.int32],
) -> bool:
    """The same, with room for a total of each PE and what is noted of each pixel and ray."""
    s: Run = runs[0]
    if not _add_up(s, totals, homes, trees, roots):
        return False
    for me in range(s.processors):
        _pass_the_peak(s, me, totals[me].largest_tree)
    s.activities, s.tests, s.last_ray_ps = 0, itinerary_objects(s).size, 0
    s.rays_done, s.rays_left = rays(s).size, 0
    for me in range(s.processors):
        if totals[me].last_ray != NONE:
            _settle(s, me, totals[me])
    return True


@kernel
def _add_up(
    s: Run,
    totals: NDArray[np.void],
    homes: NDArray[np.int32],
    trees: NDArray[np.int32],
    roots: NDArray[np.int32],
) -> bool:
    """Fill (nb,) TOTALS; False as soon as an object is missing somewhere."""
    for me in range(s.processors):
        totals[me].last_ray = NONE
        for at in range(pes(s)[me].pixel, pes(s)[me].pixel_end):
            ray = pixels(s)[at]
            homes[ray], roots[ray] = me, ray
            if not _add_ray(s, totals[me], me, ray, roots, trees):
                return False
    for ray in range(homes.size, roots.size):
        me = homes[roots[ray]]
        if not _add_ray(s, totals[me], me, ray, roots, trees):
            return False
    return True


@kernel
def _add_ray(
    s: Run, total: Row, me: int, ray: int, roots: NDArray[np.int32], trees: NDArray[np.int32]
) -> bool:
    """Add one ray to the total of its PE and to its tree; False if the PE lacks an object."""
    offsets, objects, pixel = itinerary_offsets(s), itinerary_objects(s), roots[ray]
    cost_ps = s.ray_ps
    for i in range(offsets[ray], offsets[ray + 1]):
        obj = objects[i]
        if not is_in_memory(s, me, obj):
            return False
        cost_ps += cost_of_test_ps(s, ray, obj)
    for child in range(child_offsets(s)[ray], child_offsets(s)[ray + 1]):
        roots[child] = pixel
    if ray == pixel or not s.depth_first:
        total.last_ray = ray
    trees[pixel] += 1
    total.largest_tree = max(total.largest_tree, trees[pixel])
    total.tests += offsets[ray + 1] - offsets[ray]
    total.compute_ps += cost_ps
    return True


@kernel
def _pass_the_peak(s: Run, me: int, largest_tree: int) -> None:
    """Step until the PE can't hold more rays any more than it did at the start.

    Depth-first it never holds more than those of now and what is left of one tree.
    """
    pe = pes(s)[me]
    at_the_start, clock_ps = pe.load, 0
    while pe.n_ready > 0 and (not s.depth_first or pe.load + largest_tree - 1 > at_the_start):
        clock_ps = step(s, me, BEGIN, NONE, clock_ps)


@kernel
def _settle(s: Run, me: int, total: Row) -> None:
    """Enter what a PE has done in all into its account."""
    activities = total.tests // s.quantum
    if total.tests % s.quantum > 0 or _is_left_over(s, total.last_ray):
        activities += 1
    if s.probe_ps > 0 and activities > (CLOCK_LIMIT_PS - total.compute_ps) // s.probe_ps:
        raise OverflowError("the clock")
    pe = pes(s)[me]
    pe.compute_ps, pe.communication_ps = total.compute_ps, activities * s.probe_ps
    pe.busy_until_ps = pe.compute_ps + pe.communication_ps
    s.activities += activities
    s.last_ray_ps = max(s.last_ray_ps, pe.busy_until_ps)


@kernel
def _is_left_over(s: Run, ray: int) -> bool:
    """Is the last ray of a PE still there when its last test has been made?

    Depth-first the last ray is the last child of the last child ... of the primary ray ``ray``.
    """
    if s.depth_first:
        while child_offsets(s)[ray] < child_offsets(s)[ray + 1]:
            ray = child_offsets(s)[ray + 1] - 1
    return itinerary_offsets(s)[ray] == itinerary_offsets(s)[ray + 1]
