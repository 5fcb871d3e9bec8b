"""Ready rays of a PE: a linked list that is filled at its front or at its back."""

from __future__ import annotations

from simmpp.compiled import njit
from simmpp.engine.state import State
from simmpp.engine.tables import NONE


@njit
def make_ready(s: State, me: int, first: int, last: int, n: int) -> None:
    """Make the linked rays first ... last ready, as a block that keeps its order.

    Depth-first puts the block before, breadth-first behind the rays that are ready already.
    """
    pe = s.pes[me]
    if pe.n_ready == 0:
        pe.ready_first, pe.ready_last = first, last
        s.rays[last].next = NONE
    elif s.setup[0].depth_first:
        s.rays[last].next = pe.ready_first
        pe.ready_first = first
    else:
        s.rays[pe.ready_last].next = first
        s.rays[last].next = NONE
        pe.ready_last = last
    pe.n_ready += n


@njit
def pop_ready(s: State, me: int) -> None:
    """Take the first ray out of the ready ones."""
    pe = s.pes[me]
    pe.ready_first = s.rays[pe.ready_first].next
    pe.n_ready -= 1


@njit
def finish_ray(s: State, me: int, ray: int, now_ps: int) -> None:
    """A ray has made its last test and is shaded: its children become ready here."""
    pe, totals = s.pes[me], s.totals[0]
    child, end = s.child_offsets[ray], s.child_offsets[ray + 1]
    if child < end:
        for each in range(child, end - 1):
            s.rays[each].next = each + 1
        make_ready(s, me, child, end - 1, end - child)
    pe.load += end - child - 1
    pe.peak_rays = max(pe.peak_rays, pe.load)
    totals.rays += 1
    totals.rays_left += end - child - 1
    totals.last_ray_ps = max(totals.last_ray_ps, now_ps)
