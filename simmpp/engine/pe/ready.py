"""Ready rays of a PE: pixels that are not started, and a linked list of started rays.

The list is filled at its front (depth-first) or at its back. A primary ray is not started until it
is its turn: depth-first when no other is ready, breadth-first before all others but the one that
the quantum has cut. So the pixels that a PE has left are a row of ``pixels``, however many.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import NONE, Run
from simmpp.engine.arrays.views import child_offsets, ends_ps, most_alive, pes, pixels, rays, rooms
from simmpp.engine.pe.bounds.rooms import fits, note_memory
from simmpp.engine.pe.tables.rounds import count_in_round


@kernel
def make_ready(s: Run, me: int, first: int, last: int, n: int) -> None:
    """Make the linked rays first ... last ready, as a block that keeps its order.

    Depth-first puts the block before, breadth-first behind the rays that are ready already.
    """
    pe = pes(s)[me]
    if pe.first == NONE:
        pe.first, pe.last = first, last
        rays(s)[last].next = NONE
    elif s.depth_first:
        rays(s)[last].next = pe.first
        pe.first = first
    else:
        rays(s)[pe.last].next = first
        rays(s)[last].next = NONE
        pe.last = last
    pe.n_ready += n


@kernel
def next_ready(s: Run, me: int) -> int:
    """The ready ray whose turn it is, at the front of the list; there must be one."""
    pe = pes(s)[me]
    if pe.pixel < pe.pixel_end and (pe.first == NONE or not (s.depth_first or pe.cut)):
        ray = pixels(s)[pe.pixel]
        if not s.bounded or fits(s, me, ray):
            _start(s, me, ray)
    pe.cut = 0
    return pe.first


@kernel
def _start(s: Run, me: int, ray: int) -> None:
    """Put the next pixel to the front of the list."""
    pe = pes(s)[me]
    pe.pixel += 1
    rays(s)[ray].next = pe.first
    if pe.first == NONE:
        pe.last = ray
    pe.first = ray
    if s.bounded:
        rooms(s)[me].reserved += most_alive(s)[ray]
    if s.measures:
        note_memory(s, me)


@kernel
def cross(s: Run, first: int, n: int, links: int) -> None:
    """Links were crossed by n linked rays."""
    ray = first
    for _ in range(n):
        rays(s)[ray].hops += links
        ray = rays(s)[ray].next


@kernel
def pop_ready(s: Run, me: int) -> None:
    """Take the first ray out of the ready ones."""
    pe = pes(s)[me]
    pe.first = rays(s)[pe.first].next
    pe.n_ready -= 1


@kernel
def finish_ray(s: Run, me: int, ray: int, now_ps: int) -> None:
    """A ray has made its last test and is shaded: its children become ready here."""
    pe = pes(s)[me]
    child, end = child_offsets(s)[ray], child_offsets(s)[ray + 1]
    if child < end:
        # Children are numbered in a row; make_ready corrects what comes after the last one.
        for ray_number in range(child, end):
            rays(s)[ray_number].next = ray_number + 1
        make_ready(s, me, child, end - 1, end - child)
    # The ray itself leaves; what it has hit brings forth its children here, whoever owns it.
    pe.load += end - child - 1
    pe.peak_rays = max(pe.peak_rays, pe.load)
    pe.finished += 1
    s.rays_done += 1
    s.rays_left += end - child - 1
    if s.n_rounds > 1:
        count_in_round(s, ray, end - child - 1, now_ps)
    if s.record_ends:
        ends_ps(s)[ray] = now_ps
    if s.bounded and child == end:
        rooms(s)[me].reserved -= 1  # else its children have its room
    elif s.measures and not s.bounded:
        note_memory(s, me)


@kernel
def end_together(s: Run, ray: int, now_ps: int) -> None:
    """Linked rays are finished now, with lanes that were left empty, and not one by one."""
    while ray != NONE:
        ends_ps(s)[ray] = now_ps
        ray = rays(s)[ray].next
