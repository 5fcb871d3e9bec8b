"""Outstanding misses: rays that wait for an object their PE lacks, and what it holds for a while.

A miss is a row of ``misses`` for a PE and an object, as in the registers of a non-blocking cache:
it counts the rays that wait, the requests in flight and the rays the object is pinned for.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import add, find, link, remove
from simmpp.engine.arrays.records import NONE, Run
from simmpp.engine.arrays.views import (
    miss_rows,
    misses,
    pes,
    rays,
    replica_objects,
    replica_offsets,
    resident,
    unasked,
    waited,
)
from simmpp.engine.pe.candidates import count_sendable, relist, set_sendable, withdraw
from simmpp.engine.pe.islands import owner_of, owns
from simmpp.engine.pe.peers import peer_of
from simmpp.policy.view import LOADS


@kernel
def is_in_memory(s: Run, me: int, obj: int) -> bool:
    """Is the object resident, or in transient memory?"""
    if owns(s, me, obj) or s.all_resident:
        return True
    if _is_replica(s, me, obj):
        return True
    if not s.keeps:
        return False
    miss_row = find(misses(s), me * s.n_objects + obj)
    return miss_row != NONE and miss_rows(s)[miss_row].transient == 1


@kernel
def is_holder(s: Run, pe: int, obj: int) -> bool:
    """Does a PE have the object for good, as its owner or as a replica?"""
    return owns(s, pe, obj) or _is_replica(s, pe, obj)


@kernel
def _is_replica(s: Run, me: int, obj: int) -> bool:
    """Does the PE hold a replica of the object for good?"""
    if s.row_bytes > 0:
        return resident(s)[me * s.row_bytes + (obj >> 3)] >> (obj & 7) & 1 == 1
    if s.replica_objects_n == 0:  # the offsets are empty then, too
        return False
    low, high = replica_offsets(s)[me], replica_offsets(s)[me + 1]
    end = high
    while low < high:
        middle = (low + high) // 2
        if replica_objects(s)[middle] < obj:
            low = middle + 1
        else:
            high = middle
    return low < end and replica_objects(s)[low] == obj


@kernel
def file_ray(s: Run, me: int, ray: int, obj: int) -> None:
    """A ray begins to wait, filed under (object, owner)."""
    miss_row = _miss_of(s, me, obj)
    miss = miss_rows(s)[miss_row]
    link(rays(s), miss, ray)
    miss.n += 1
    pe = pes(s)[me]
    pe.waits += 1
    # While the object is on its way its rays can't be sent: they would make it come in vain.
    if miss.requests == 0:
        set_sendable(s, me, miss_row, 1)
    if miss.requests == 0 or not s.merge_requests:
        if miss.unasked == 0:
            miss.since = pe.waits
        set_unasked(s, me, miss_row, miss.unasked + 1)
    if s.bounded:
        waited(s)[ray] = pe.waits


@kernel
def unfile(s: Run, me: int, miss_row: int, n: int) -> None:
    """The n rays that have waited longest for an object leave; nobody has asked for it."""
    miss = miss_rows(s)[miss_row]
    if n == miss.n:
        withdraw(s, me, miss_row)
        miss.first, miss.n = NONE, 0
        set_unasked(s, me, miss_row, 0)
        drop_if_idle(s, miss_row)
        return
    if s.sends:
        count_sendable(s, me, miss_row, -n)
    for _ in range(n):
        miss.first = rays(s)[miss.first].next
    miss.n -= n
    miss.since = waited(s)[miss.first]
    set_unasked(s, me, miss_row, miss.n)


@kernel
def _miss_of(s: Run, me: int, obj: int) -> int:
    """The row of an object that PE ``me`` lacks or holds for a while."""
    key = me * s.n_objects + obj
    miss_row = find(misses(s), key)
    if miss_row == NONE:
        miss_row = add(misses(s), key)
        miss = miss_rows(s)[miss_row]
        miss.first = NONE
        miss.n = 0
        miss.unasked = 0
        miss.requests = 0
        miss.pinned = 0
        miss.transient = 0
        if s.sends or (s.ask_reads | s.keep_reads) & LOADS:
            miss.peer = peer_of(s, me, owner_of(s, me, obj))
    return miss_row


@kernel
def drop_if_idle(s: Run, miss_row: int) -> None:
    """Forget an object that nobody waits for and nobody holds."""
    miss = miss_rows(s)[miss_row]
    if miss.n == 0 and miss.requests == 0 and miss.pinned == 0 and miss.transient == 0:
        remove(misses(s), miss_row)


@kernel
def set_unasked(s: Run, me: int, miss_row: int, n: int) -> None:
    """Change the number of rays that no request covers, and the list that shows it."""
    miss = miss_rows(s)[miss_row]
    if s.asks or s.escapes:
        relist(unasked(s), me, miss_row, miss.unasked, n, s.ask_from)
    miss.unasked = n
