"""Flow control of rays: a PE sends no more than the receiver has kept room for.

Each PE keeps a share of its memory for the rays of each other one, as MPI does for eager messages
(ANL tutorials: "buffering must be reserved for arbitrary senders"). The sender counts what it has
used of it, the receiver what is free again and has not been told; that rides on the next header,
or in a message of its own when it is half of the share.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import append, find, unlink
from simmpp.engine.arrays.records import NONE, Row, Run
from simmpp.engine.arrays.views import credits, due, peer_rows, peers, rooms
from simmpp.engine.pe.peers import peer_of

MANY = 1 << 62
"""More rays than there are."""


@kernel
def rays_allowed(s: Run, peer_row: int) -> int:
    """How many rays the credit lets go to a PE in one message."""
    if not s.bounded:
        return MANY
    other = peer_rows(s)[peer_row].key % s.processors
    free_bytes = rooms(s)[other].share - credits(s)[peer_row].used - s.header_bytes
    if free_bytes < 0:
        return 0
    return free_bytes // s.ray_bytes if s.ray_bytes > 0 else MANY


@kernel
def enough_for(s: Run, peer_row: int) -> int:
    """The batch that goes to a PE: no more than its share holds, but a ray."""
    if not s.bounded or s.send_from <= s.least_share:
        return s.send_from
    return min(s.send_from, rooms(s)[peer_rows(s)[peer_row].key % s.processors].share_rays)


@kernel
def spend(s: Run, peer_row: int, n_rays: int) -> None:
    """Rays go to a PE: the credit for them, and for a header, is used."""
    credits(s)[peer_row].used += s.header_bytes + n_rays * s.ray_bytes


@kernel
def hear_credit(s: Run, me: int, m: Row) -> None:
    """A header says what is free again."""
    if m.credit > 0:
        credits(s)[find(peers(s), me * s.processors + m.source)].used -= m.credit


@kernel
def owe(s: Run, me: int, source: int, n_bytes: int) -> None:
    """Bytes of the share of a PE are free again."""
    peer_row = peer_of(s, me, source)
    was_due = _is_due(s, me, peer_row)
    credits(s)[peer_row].owed += n_bytes
    if not was_due and _is_due(s, me, peer_row):
        append(due(s), me, peer_row)


@kernel
def take_owed(s: Run, me: int, other: int) -> int:
    """What a header to a PE says: all that it is owed."""
    peer_row = find(peers(s), me * s.processors + other)
    if peer_row == NONE:
        return 0
    if _is_due(s, me, peer_row):
        unlink(due(s), me, peer_row)
    owed = credits(s)[peer_row].owed
    credits(s)[peer_row].owed = 0
    return owed


@kernel
def _is_due(s: Run, me: int, peer_row: int) -> bool:
    owed = credits(s)[peer_row].owed
    return owed > 0 and 2 * owed >= rooms(s)[me].share
