"""What PEs are told at the end of a dispatch, in messages of nothing else: loads and credit."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import Lists, first, following, sort_by_key
from simmpp.engine.arrays.records import Run
from simmpp.engine.arrays.views import due, exchanged, peer_rows, sort_items, sort_keys
from simmpp.engine.pe.sending import send_credit, send_load


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
        clock_ps = send_credit(s, me, other, clock_ps)
    return clock_ps


@kernel
def refresh_loads(s: Run, me: int, now_ps: int) -> int:
    """Tell peers that have heard nothing for long my load (the cure of Nebel 1998, 4.2.2).

    Not after the receipt of such a message, or loads would answer loads for ever.
    """
    clock_ps = now_ps
    for i in range(collect_peers(s, me, exchanged(s), me, 0)):
        peer = peer_rows(s)[sort_items(s)[i]]
        if clock_ps - peer.sent_ps >= s.refresh_ps:
            clock_ps = send_load(s, me, peer.key % s.processors, clock_ps)
    return clock_ps
