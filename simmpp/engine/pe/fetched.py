"""Fetched objects: pinned for the rays that they release, and kept in transient memory."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import append, find, first, unlink
from simmpp.engine.arrays.records import Run
from simmpp.engine.arrays.views import miss_rows, misses, object_bytes, pes, rays, recent
from simmpp.engine.pe.candidates import set_sendable
from simmpp.engine.pe.misses import drop_if_idle
from simmpp.engine.pe.ready import make_ready


@kernel
def admit_object(s: Run, me: int, obj: int, links: int) -> None:
    """A fetched object has arrived: rays that wait for it are released for one test each.

    ``links`` were crossed for each of them, the request's and its own.
    """
    miss_row = find(misses(s), me * s.n_objects + obj)
    miss = miss_rows(s)[miss_row]
    miss.requests -= 1
    if miss.pinned == 0 and miss.transient == 0:
        pes(s)[me].held_bytes += object_bytes(s)[obj]
    _release(s, me, miss_row, links)
    if miss.requests == 0 and miss.n > 0:
        set_sendable(s, me, miss_row, miss.n)
    if s.transient > 0:
        _keep(s, me, miss_row)
    elif miss.pinned == 0:
        pes(s)[me].held_bytes -= object_bytes(s)[obj]
    drop_if_idle(s, miss_row)


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
    make_ready(s, me, head, tail, n)


@kernel
def _grant(s: Run, ray: int, links: int) -> None:
    rays(s)[ray].granted = 1
    rays(s)[ray].hops += links


@kernel
def _keep(s: Run, me: int, miss_row: int) -> None:
    """Put a fetched object into transient memory; the least recently used one may have to go."""
    pe, miss = pes(s)[me], miss_rows(s)[miss_row]
    if miss.transient == 1:
        touch(s, me, miss_row)
        return
    miss.transient = 1
    append(recent(s), me, miss_row)
    pe.n_transient += 1
    if pe.n_transient > s.transient:
        oldest = first(recent(s), me)
        evicted = miss_rows(s)[oldest]
        unlink(recent(s), me, oldest)
        evicted.transient = 0
        pe.n_transient -= 1
        if evicted.pinned == 0:
            pe.held_bytes -= object_bytes(s)[evicted.key % s.n_objects]
        drop_if_idle(s, oldest)


@kernel
def touch(s: Run, me: int, miss_row: int) -> None:
    """An object in transient memory is used: it becomes the most recent one."""
    if miss_rows(s)[miss_row].transient == 1:
        unlink(recent(s), me, miss_row)
        append(recent(s), me, miss_row)


@kernel
def unpin(s: Run, me: int, miss_row: int, obj: int) -> None:
    """A released ray has made the test that the object was pinned for."""
    miss = miss_rows(s)[miss_row]
    miss.pinned -= 1
    if miss.pinned == 0 and miss.transient == 0:
        pes(s)[me].held_bytes -= object_bytes(s)[obj]
    drop_if_idle(s, miss_row)
