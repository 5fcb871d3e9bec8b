"""The queue of what is going to happen: a binary heap of events, ordered by time and ties.

Ties are broken as in the readable engine: arrivals by (destination, source, send number), then the
beginning of a round, then the instants of PEs by (PE, number), then heads of messages by (source,
send number).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import Row, Run
from simmpp.engine.arrays.views import heap

PE_BITS = 31
"""A PE's number is an int32: the rank of an arrival is destination * 2^31 + source."""
# Arrivals come first: a PE that begins in the same instant finds them in its inbox.
INSTANT = 1 << 2 * PE_BITS
"""Rank of a PE's own instants, above all pairs of PEs."""
ROUND = INSTANT - 1
"""Rank of the beginning of a round, before the instants of those whom it wakes."""
# Heads come last, when all messages that the instant sends are known: a message that costs nothing
# may be at its link in the instant in which it was packed, and must wait for its turn by source.
HEAD = INSTANT + (1 << 32)
"""Rank of heads of messages that come to a port or link, above all instants."""


@kernel
def _before(a: Row, time_ps: int, rank: int, number: int) -> bool:
    """Does event ``a`` come before the one with that key?"""
    if a.time_ps != time_ps:
        return a.time_ps < time_ps
    if a.rank != rank:
        return a.rank < rank
    return a.number < number


@kernel
def _put(events: NDArray[np.void], at: int, event: Row) -> None:
    _set(events[at], event.time_ps, event.rank, event.number, event.message)


@kernel
def _set(event: Row, time_ps: int, rank: int, number: int, message: int) -> None:
    event.time_ps, event.rank, event.number, event.message = time_ps, rank, number, message


@kernel
def heap_lacks_room(s: Run) -> bool:
    """Might one more step not find room, as there are so many instants that come to nothing?"""
    return s.heap_n < s.messages_n + s.processes_n + 2 + s.n_stale


@kernel
def take(s: Run) -> None:
    """The first event is being handled: its place is for the first that is pushed meanwhile."""
    s.taken = 1


@kernel
def close(s: Run) -> None:
    """It has been handled; if nothing was pushed its place is closed."""
    if s.taken:
        s.taken = 0
        pop(s)


@kernel
def push(s: Run, time_ps: int, rank: int, number: int, message: int) -> None:
    """Add an event to the binary heap."""
    if s.taken:
        s.taken = 0
        replace_first(s, time_ps, rank, number, message)
        return
    events, at = heap(s), s.n_events
    s.n_events += 1
    while at > 0:
        parent = (at - 1) // 2
        if _before(events[parent], time_ps, rank, number):
            break
        _put(events, at, events[parent])
        at = parent
    _set(events[at], time_ps, rank, number, message)


@kernel
def pop(s: Run) -> None:
    """Remove the first event of the binary heap."""
    s.n_events -= 1
    last = heap(s)[s.n_events]
    replace_first(s, last.time_ps, last.rank, last.number, last.message)


@kernel
def replace_first(s: Run, time_ps: int, rank: int, number: int, message: int) -> None:
    """Remove the first event and add one: quicker than both, above all if it soon follows."""
    events, at, child = heap(s), 0, 1
    while child < s.n_events:
        right = child + 1
        if right < s.n_events:
            r = events[right]
            if _before(r, events[child].time_ps, events[child].rank, events[child].number):
                child = right
        if not _before(events[child], time_ps, rank, number):
            break
        _put(events, at, events[child])
        at, child = child, 2 * child + 1
    _set(events[at], time_ps, rank, number, message)
