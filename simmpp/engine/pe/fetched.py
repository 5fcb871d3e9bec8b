"""Fetched objects: pinned for the rays that they release, and kept in transient memory."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import append, find, first, following, unlink
from simmpp.engine.arrays.records import NONE, Run
from simmpp.engine.arrays.views import miss_rows, misses, object_bytes, pes, rays, recent, rooms
from simmpp.engine.pe.candidates import set_sendable
from simmpp.engine.pe.misses import drop_if_idle
from simmpp.engine.pe.ready import make_ready
from simmpp.engine.pe.showing import show_object, view_of
from simmpp.policy.record import consult

UNRANKED = 1 << 62
"""The rank of what a policy has not been asked about: it leaves last."""


@kernel
def admit_object(s: Run, me: int, obj: int, links: int) -> None:
    """A fetched object has arrived: rays that wait for it are released for one test each.

    ``links`` were crossed for each of them, the request's and its own.
    """
    miss_row = find(misses(s), me * s.n_objects + obj)
    miss = miss_rows(s)[miss_row]
    miss.requests -= 1
    pes(s)[me].fetched += 1
    if miss.pinned == 0 and miss.transient == 0:
        pes(s)[me].held_bytes += object_bytes(s)[obj]
    _release(s, me, miss_row, links)
    if miss.requests == 0 and miss.n > 0:
        set_sendable(s, me, miss_row, miss.n)
    if s.keeps:
        _keep(s, me, miss_row)
    elif miss.pinned == 0:
        _let_go(s, me, miss_row)
    drop_if_idle(s, miss_row)


@kernel
def _let_go(s: Run, me: int, miss_row: int) -> None:
    """A fetched object is in memory no more; it may be on its way once again."""
    miss = miss_rows(s)[miss_row]
    n_bytes = object_bytes(s)[miss.key % s.n_objects]
    pes(s)[me].held_bytes -= n_bytes
    if s.measures and miss.requests == 0:
        rooms(s)[me].fetched -= n_bytes


@kernel
def reserve_object(s: Run, me: int, miss_row: int) -> bool:
    """Keep room for an object that is to be asked for; is there any?

    Kept objects that no ray needs at once leave for it, if that makes room enough.
    """
    miss, room = miss_rows(s)[miss_row], rooms(s)[me]
    if miss.pinned > 0:  # it is counted already
        return True
    n_bytes = object_bytes(s)[miss.key % s.n_objects]
    if s.bounded and room.fetched + n_bytes > room.fetch_bytes:
        if room.fetched - _idle_bytes(s, me) + n_bytes > room.fetch_bytes:
            return False
        while room.fetched + n_bytes > room.fetch_bytes:
            leaving = _first_idle(s, me)
            _drop(s, me, leaving)
            drop_if_idle(s, leaving)
    room.fetched += n_bytes
    return True


@kernel
def _idle_bytes(s: Run, me: int) -> int:
    """Bytes of kept objects that no ray needs at once."""
    n_bytes, row = 0, first(recent(s), me)
    while row >= 0:
        if miss_rows(s)[row].pinned == 0:
            n_bytes += object_bytes(s)[miss_rows(s)[row].key % s.n_objects]
        row = following(recent(s), row)
    return n_bytes


@kernel
def _first_idle(s: Run, me: int) -> int:
    """Of those the one that leaves first; there must be one."""
    leaving, row = NONE, first(recent(s), me)
    while row >= 0:
        miss = miss_rows(s)[row]
        if miss.pinned == 0 and (leaving == NONE or miss.rank < miss_rows(s)[leaving].rank):
            leaving = row
        row = following(recent(s), row)
    return leaving


@kernel
def _release(s: Run, me: int, miss_row: int, links: int) -> None:
    """Grant the waiting rays (one, if requests are not merged) their next test."""
    miss = miss_rows(s)[miss_row]
    if miss.n == 0:
        return
    n = miss.n if s.merge_requests else 1
    head = miss.first
    tail = head
    _grant(s, tail, links)
    for _ in range(n - 1):
        tail = rays(s)[tail].next
        _grant(s, tail, links)
    miss.first = rays(s)[tail].next
    miss.n -= n
    miss.pinned += n
    pes(s)[me].released += n
    make_ready(s, me, head, tail, n)


@kernel
def _grant(s: Run, ray: int, links: int) -> None:
    rays(s)[ray].granted = 1
    rays(s)[ray].hops += links


@kernel
def _keep(s: Run, me: int, miss_row: int) -> None:
    """Put a fetched object into transient memory; others, or itself, may have to go."""
    pe, miss = pes(s)[me], miss_rows(s)[miss_row]
    if miss.transient == 1:
        touch(s, me, miss_row)
        return
    miss.transient, miss.rank = 1, UNRANKED
    append(recent(s), me, miss_row)
    pe.n_transient += 1
    pe.transient_bytes += object_bytes(s)[miss.key % s.n_objects]
    while _has_too_much(s, me):
        leaving = _first_to_leave(s, me)
        _drop(s, me, leaving)
        if leaving != miss_row:  # which may still be needed, as who has put it here will see
            drop_if_idle(s, leaving)


@kernel
def _has_too_much(s: Run, me: int) -> bool:
    pe = pes(s)[me]
    if s.transient_bytes > 0:
        return pe.transient_bytes > s.transient_bytes
    return pe.n_transient > s.transient


@kernel
def _first_to_leave(s: Run, me: int) -> int:
    """The least recently used object or, if the policy ranks them, of those of the least rank."""
    leaving = first(recent(s), me)
    if s.keep != 0:
        row = following(recent(s), leaving)
        while row >= 0:
            if miss_rows(s)[row].rank < miss_rows(s)[leaving].rank:
                leaving = row
            row = following(recent(s), row)
    return leaving


@kernel
def _drop(s: Run, me: int, miss_row: int) -> None:
    """Take an object out of transient memory; while it is pinned it stays in memory."""
    pe, miss = pes(s)[me], miss_rows(s)[miss_row]
    n_bytes = object_bytes(s)[miss.key % s.n_objects]
    unlink(recent(s), me, miss_row)
    miss.transient = 0
    pe.n_transient -= 1
    pe.transient_bytes -= n_bytes
    if miss.pinned == 0:
        _let_go(s, me, miss_row)


@kernel
def touch(s: Run, me: int, miss_row: int) -> None:
    """An object in transient memory is used: it becomes the most recent one."""
    if miss_rows(s)[miss_row].transient == 1:
        unlink(recent(s), me, miss_row)
        append(recent(s), me, miss_row)


@kernel
def unpin(s: Run, me: int, miss_row: int, obj: int, now_ps: int) -> None:
    """A released ray has made the test that the object was pinned for."""
    miss = miss_rows(s)[miss_row]
    miss.pinned -= 1
    if miss.pinned == 0:
        if miss.transient == 0:
            _let_go(s, me, miss_row)
        elif s.keep != 0:
            _rank(s, me, miss_row, now_ps)
    drop_if_idle(s, miss_row)


@kernel
def _rank(s: Run, me: int, miss_row: int, now_ps: int) -> None:
    """Ask the policy what an object is worth, now that nothing needs it at once."""
    view = view_of(s, me)
    view.nothing_else = 0
    show_object(s, view, me, miss_row, now_ps, s.keep_reads)
    rank = consult(s.keep, view)
    if rank > 0:
        miss_rows(s)[miss_row].rank = rank
    else:
        _drop(s, me, miss_row)
