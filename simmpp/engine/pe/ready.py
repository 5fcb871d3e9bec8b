"""Ready rays of a PE: a linked list that is filled at its front or at its back."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import NONE, Run
from simmpp.engine.arrays.views import child_offsets, pes, rays


@kernel
def make_ready(s: Run, me: int, first: int, last: int, n: int) -> None:
    """Make the linked rays first ... last ready, as a block that keeps its order.

    Depth-first puts the block before, breadth-first behind the rays that are ready already.
    """
    pe = pes(s)[me]
    if pe.n_ready == 0:
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
    s.last_ray_ps = max(s.last_ray_ps, now_ps)
