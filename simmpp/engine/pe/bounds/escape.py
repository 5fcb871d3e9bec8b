"""The way out of a PE that can't go on: it fetches the object of its oldest ray.

Why a run in bounded memory ends (with ``escape: fetch``, shares of a ray and a header or more, and
queues for the largest tree). What is left of tests and of rays never grows. Suppose that nobody
ever again lowers it. Every message of rays and every fetch makes at least one test, and messages of
credit and load follow only upon others: at last nothing is on its way, and all PEs sleep. (0) A PE
without rays but with pixels starts one: its queue is empty, and has room for any tree. (1) A PE
that holds a ray has none that is ready and nothing else to do, so its latest dispatch has escaped:
the request is handled whatever rays ride with it, the owner answers from what it holds for good,
and the answer has a room of its own: a test follows. (2) If no PE holds a ray, rays lie in shares
alone, the queue of their PE is empty, and the first of them is taken in.
So no order among PEs is needed: room for rays is all that is waited for in a circle, and the escape
needs none of it (the analogue of Duato's escape channel, IEEE TPDS 4(12), 1993).

Hence it is the last decision of every dispatch, also of one that has sent or asked: the next
instant of the PE may be its sleep. What does not fit is nothing to do.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import first, following
from simmpp.engine.arrays.records import FOR_ESCAPE, NONE, Run
from simmpp.engine.arrays.views import messages, miss_rows, rays, rooms, unasked
from simmpp.engine.pe.bounds.admission import can_unpack
from simmpp.engine.pe.bounds.rooms import has_ready
from simmpp.engine.pe.islands import owner_of
from simmpp.engine.pe.misses import unfile
from simmpp.engine.pe.ready import make_ready
from simmpp.engine.pe.sending import new_part, post
from simmpp.machine.messages import REQUEST

ESCAPED = 2
"""RAY.granted of a ray whose object is in the escape room."""


@kernel
def escape(s: Run, me: int, inbox_empty: bool, now_ps: int) -> int:
    """If nothing is to be done, ask for what the oldest ray needs whose object is not on its way.

    One at a time: it is over when the ray has made that test. Returns the end of the sending.
    """
    room = rooms(s)[me]
    if room.stuck != NONE or not inbox_empty or has_ready(s, me) or can_unpack(s, me):
        return now_ps
    miss_row = _longest_waiting(s, me)
    if miss_row == NONE:
        return now_ps
    obj = miss_rows(s)[miss_row].key % s.n_objects
    room.stuck = miss_rows(s)[miss_row].first
    room.escapes += 1
    unfile(s, me, miss_row, 1)
    row = new_part(s, REQUEST, owner_of(s, me, obj), s.request_bytes)
    messages(s)[row].obj, messages(s)[row].purpose = obj, FOR_ESCAPE
    return post(s, me, row, now_ps)


@kernel
def _longest_waiting(s: Run, me: int) -> int:
    """The miss whose oldest ray has waited longest, of those that nobody has asked for; or NONE."""
    longest = NONE
    for which in range(2 * me, 2 * me + 2):
        row = first(unasked(s), which)
        while row >= 0:
            if longest == NONE or miss_rows(s)[row].since < miss_rows(s)[longest].since:
                longest = row
            row = following(unasked(s), row)
    return longest


@kernel
def admit_escape(s: Run, me: int, links: int) -> None:
    """The object has come: the ray may make its test, and no other."""
    ray = rooms(s)[me].stuck
    rays(s)[ray].granted = ESCAPED
    rays(s)[ray].hops += links
    make_ready(s, me, ray, ray, 1)
