"""Outstanding misses: rays that wait for an object their PE lacks, and what it holds for a while.

A miss is a row of ``misses`` for a PE and an object, as in the registers of a non-blocking cache:
it counts the rays that wait, the requests in flight and the rays the object is pinned for.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import Lists, add, append, find, link, remove, unlink
from simmpp.engine.arrays.records import NONE, Run
from simmpp.engine.arrays.views import (
    exchanged,
    miss_rows,
    misses,
    owners,
    peer_rows,
    peers,
    pes,
    rays,
    replica_objects,
    replica_offsets,
    resident,
    sendable,
    unasked,
    unsent,
)
from simmpp.policy.view import LOADS


@kernel
def is_in_memory(s: Run, me: int, obj: int) -> bool:
    """Is the object resident, or in transient memory?"""
    if owners(s)[obj] == me or s.all_resident:
        return True
    if _is_replica(s, me, obj):
        return True
    if s.transient == 0:
        return False
    miss_row = find(misses(s), me * s.n_objects + obj)
    return miss_row != NONE and miss_rows(s)[miss_row].transient == 1


@kernel
def is_holder(s: Run, pe: int, obj: int) -> bool:
    """Does a PE have the object for good, as its owner or as a replica?"""
    return owners(s)[obj] == pe or _is_replica(s, pe, obj)


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
def note_exchange(s: Run, me: int, peer_row: int) -> None:
    """Rays or objects went from one to the other: loads are refreshed between them."""
    if peer_rows(s)[peer_row].exchanged == 0:
        peer_rows(s)[peer_row].exchanged = 1
        append(exchanged(s), me, peer_row)


@kernel
def peer_of(s: Run, me: int, other: int) -> int:
    """The row of what PE ``me`` knows of PE ``other``."""
    key = me * s.processors + other
    peer_row = find(peers(s), key)
    if peer_row == NONE:
        peer_row = add(peers(s), key)
        peer_rows(s)[peer_row].load = NONE  # the rest is 0: rows of peers are never given back
    return peer_row


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
        if s.sends or s.ask_reads & LOADS:
            miss.peer = peer_of(s, me, owners(s)[obj])
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
    if s.asks:
        _relist(unasked(s), me, miss_row, miss.unasked, n, s.ask_from)
    miss.unasked = n


@kernel
def set_sendable(s: Run, me: int, miss_row: int, n_more: int) -> None:
    """Waiting rays of an object become sendable; all of its rays before were, or none."""
    if not s.sends:
        return
    miss = miss_rows(s)[miss_row]
    if miss.n == n_more:
        append(sendable(s), miss.peer, miss_row)
    set_peer_sendable(s, me, miss.peer, peer_rows(s)[miss.peer].sendable + n_more)


@kernel
def withdraw(s: Run, me: int, miss_row: int) -> None:
    """An object has been asked for: its waiting rays can't be sent any more."""
    if not s.sends:
        return
    miss = miss_rows(s)[miss_row]
    unlink(sendable(s), miss.peer, miss_row)
    set_peer_sendable(s, me, miss.peer, peer_rows(s)[miss.peer].sendable - miss.n)


@kernel
def set_peer_sendable(s: Run, me: int, peer_row: int, n: int) -> None:
    """Change the number of rays that may be sent to an owner, and the list that shows it."""
    peer = peer_rows(s)[peer_row]
    _relist(unsent(s), me, peer_row, peer.sendable, n, s.send_from)
    peer.sendable = n


@kernel
def _relist(lists: Lists, me: int, row: int, before: int, after: int, enough: int) -> None:
    """Keep ``row`` in the PE's list of those with some rays (2 me) or enough (2 me + 1).

    ``enough`` is what the policy declares (``send_from``, ``ask_from``): below it its rule says no
    as long as there is anything else to do. So at most dispatches only the second list is looked
    at, and nothing is missed: a PE waits for a thousand objects, and few of them have enough.
    """
    if before > 0 and after > 0 and (before >= enough) == (after >= enough):
        return
    if before > 0:
        unlink(lists, 2 * me + (1 if before >= enough else 0), row)
    if after > 0:
        append(lists, 2 * me + (1 if after >= enough else 0), row)
