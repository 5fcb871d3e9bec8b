"""Where waiting rays may go: to the owner of what they need next, or to any PE that holds it.

A policy says which (``candidates``). With owners the objects whose rays may be sent are in one list
for each owner; with holders in one for each PE, and every PE that holds such an object counts its
rays, so that some rays count at several.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import Lists, append, unlink
from simmpp.engine.arrays.records import Run
from simmpp.engine.arrays.views import (
    holder_pes,
    miss_rows,
    peer_rows,
    sendable,
    unsent,
)
from simmpp.engine.pe.bounds.credits import enough_for
from simmpp.engine.pe.islands import holders_of
from simmpp.engine.pe.peers import peer_of


@kernel
def set_sendable(s: Run, me: int, miss_row: int, n_more: int) -> None:
    """Waiting rays of an object become sendable; all of its rays before were, or none."""
    if not s.sends:
        return
    miss = miss_rows(s)[miss_row]
    if miss.n == n_more:
        append(sendable(s), me if s.to_holders else miss.peer, miss_row)
    count_sendable(s, me, miss_row, n_more)


@kernel
def withdraw(s: Run, me: int, miss_row: int) -> None:
    """An object has been asked for, or its rays are sent: they can't be sent any more."""
    if not s.sends:
        return
    miss = miss_rows(s)[miss_row]
    unlink(sendable(s), me if s.to_holders else miss.peer, miss_row)
    count_sendable(s, me, miss_row, -miss.n)


@kernel
def count_sendable(s: Run, me: int, miss_row: int, n_more: int) -> None:
    """Change the number of rays that may go to each PE that they may go to."""
    miss = miss_rows(s)[miss_row]
    if not s.to_holders:
        _count(s, me, miss.peer, n_more)
        return
    first, end = holders_of(s, me, miss.key % s.n_objects)
    for at in range(first, end):
        _count(s, me, peer_of(s, me, holder_pes(s)[at]), n_more)


@kernel
def _count(s: Run, me: int, peer_row: int, n_more: int) -> None:
    peer = peer_rows(s)[peer_row]
    enough = enough_for(s, peer_row)
    relist(unsent(s), me, peer_row, peer.sendable, peer.sendable + n_more, enough)
    peer.sendable += n_more


@kernel
def relist(lists: Lists, me: int, row: int, before: int, after: int, enough: int) -> None:
    """Keep ``row`` in the PE's list of those with some rays (2 me) or enough (2 me + 1).

    ``enough`` is what the policy declares (``send_from``, ``ask_from``): below it its hook is not
    asked as long as there is anything else to do. So at most dispatches only the second list is
    looked at: a PE waits for a thousand objects, and few of them have enough.
    """
    if before > 0 and after > 0 and (before >= enough) == (after >= enough):
        return
    if before > 0:
        unlink(lists, 2 * me + (1 if before >= enough else 0), row)
    if after > 0:
        append(lists, 2 * me + (1 if after >= enough else 0), row)
