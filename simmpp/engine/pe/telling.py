"""What PEs are told at the end of a dispatch, in messages of nothing else: loads and credit."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import Lists, first, following, sort_by_key
from simmpp.engine.arrays.records import FOR_CREDIT, Run
from simmpp.engine.arrays.views import (
    due,
    exchanged,
    messages,
    peer_rows,
    rooms,
    sort_items,
    sort_keys,
)
from simmpp.engine.pe.peers import silence_ps
from simmpp.engine.pe.sending import new_part, send, send_load
from simmpp.machine.messages import LOAD


@kernel
def collect_peers(s: Run, me: int, lists: Lists, which: int, n: int) -> int:
    """Add the peers of one list to the first n of ``sort_items``, in ring order from me."""
    nb = s.processors
    row = first(lists, which)
    while row >= 0:
        sort_keys(s)[n] = (peer_rows(s)[row].key % nb - me) % nb
        sort_items(s)[n] = row
        n += 1
        row = following(lists, row)
    sort_by_key(sort_keys(s), sort_items(s), n)
    return n


@kernel
def return_credits(s: Run, me: int, now_ps: int) -> int:
    """Tell peers that are owed half of their share or more, and that were sent nothing."""
    clock_ps = now_ps
    for i in range(collect_peers(s, me, due(s), me, 0)):
        other = peer_rows(s)[sort_items(s)[i]].key % s.processors
        row = new_part(s, LOAD, other, 0)
        messages(s)[row].purpose = FOR_CREDIT
        rooms(s)[me].credit_messages += 1
        clock_ps = send(s, me, row, clock_ps, False)
    return clock_ps


@kernel
def refresh_loads(s: Run, me: int, now_ps: int) -> int:
    """Tell peers that have heard nothing for long my load (the cure of Nebel 1998, 4.2.2).

    With nic: get the load of those of which nothing was heard for long.

    Not after the receipt of such a message, or loads would answer loads for ever.
    """
    clock_ps = now_ps
    for i in range(collect_peers(s, me, exchanged(s), me, 0)):
        peer_row = sort_items(s)[i]
        if silence_ps(s, peer_row, clock_ps) >= s.refresh_ps:
            other = peer_rows(s)[peer_row].key % s.processors
            clock_ps = send_load(s, me, other, clock_ps)
    return clock_ps
