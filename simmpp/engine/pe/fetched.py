"""Fetched objects: pinned for the rays that they release, and kept in transient memory."""

from __future__ import annotations

from simmpp.common.compiled import njit_reading as njit
from simmpp.engine.arrays.hashtable import append, find, first, unlink
from simmpp.engine.arrays.layout import Run
from simmpp.engine.arrays.views import object_bytes, pes, rays, recent, want_rows, wants
from simmpp.engine.pe.misses import drop_if_idle, set_sendable
from simmpp.engine.pe.ready import make_ready


@njit
def admit_object(s: Run, me: int, arrived: int) -> None:
    """A fetched object has arrived: rays that wait for it are released for one test each."""
    row = find(wants(s), me * s.n_objects + arrived)
    want = want_rows(s)[row]
    want.requests -= 1
    if want.pinned == 0 and want.transient == 0:
        pes(s)[me].held_bytes += object_bytes(s)[arrived]
    _release(s, me, row)
    if want.requests == 0 and want.n > 0:
        set_sendable(s, me, row, want.n)
    if s.transient > 0:
        _keep(s, me, row)
    elif want.pinned == 0:
        pes(s)[me].held_bytes -= object_bytes(s)[arrived]
    drop_if_idle(s, row)


@njit
def _release(s: Run, me: int, row: int) -> None:
    """Grant the waiting rays (one, if requests are not merged) their next test."""
    want = want_rows(s)[row]
    if want.n == 0:
        return
    n = want.n if s.merge_requests else 1
    head = want.first
    tail = head
    _grant(s, tail, want.hops)
    for _ in range(n - 1):
        tail = rays(s)[tail].next
        _grant(s, tail, want.hops)
    want.first = rays(s)[tail].next
    want.n -= n
    want.pinned += n
    make_ready(s, me, head, tail, n)


@njit
def _grant(s: Run, ray: int, hops: int) -> None:
    """What the ray was filed for has come to it, the same way back."""
    rays(s)[ray].granted = 1
    rays(s)[ray].hops += hops


@njit
def _keep(s: Run, me: int, row: int) -> None:
    """Put a fetched object into transient memory; the least recently used one may have to go."""
    pe, want = pes(s)[me], want_rows(s)[row]
    if want.transient == 1:
        touch(s, me, row)
        return
    want.transient = 1
    append(recent(s), me, row)
    pe.n_transient += 1
    if pe.n_transient > s.transient:
        oldest = first(recent(s), me)
        evicted = want_rows(s)[oldest]
        unlink(recent(s), me, oldest)
        evicted.transient = 0
        pe.n_transient -= 1
        if evicted.pinned == 0:
            pe.held_bytes -= object_bytes(s)[evicted.key % s.n_objects]
        drop_if_idle(s, oldest)


@njit
def touch(s: Run, me: int, row: int) -> None:
    """An object in transient memory is used: it becomes the most recent one."""
    if want_rows(s)[row].transient == 1:
        unlink(recent(s), me, row)
        append(recent(s), me, row)


@njit
def unpin(s: Run, me: int, row: int, tested: int) -> None:
    """A released ray has made the test that the object was pinned for."""
    want = want_rows(s)[row]
    want.pinned -= 1
    if want.pinned == 0 and want.transient == 0:
        pes(s)[me].held_bytes -= object_bytes(s)[tested]
    drop_if_idle(s, row)
