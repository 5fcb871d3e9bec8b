"""The queue of what is going to happen: a binary heap of events, ordered by time and ties.

Ties are broken as in the readable engine: arrivals by (destination, source, send number), then the
instants of PEs by (PE, number), then heads of messages by (source, send number).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit_reading as njit
from simmpp.engine.arrays.layout import Row

INSTANT = 1 << 62
"""Rank of a PE's own instants, above all pairs of PEs."""
HEAD = INSTANT + (1 << 32)
"""Rank of heads of messages that come to a port or link, above all instants."""

EVENT_KEY = np.dtype(
    [
        ("time_ps", "i8"),
        ("rank", "i8"),  # destination * 2^31 + source, INSTANT + PE or HEAD + source
        ("number", "i8"),  # the sender's send number, or the PE's instants so far
        ("message", "i8"),  # that arrives or whose head moves; NONE at an instant
    ]
)


@njit
def _before(a: Row, time_ps: int, rank: int, number: int) -> bool:
    """Does event ``a`` come before the one with that key?"""
    if a.time_ps != time_ps:
        return a.time_ps < time_ps
    if a.rank != rank:
        return a.rank < rank
    return a.number < number


@njit
def _put(heap: NDArray[np.void], at: int, event: Row) -> None:
    heap[at].time_ps, heap[at].rank = event.time_ps, event.rank
    heap[at].number, heap[at].message = event.number, event.message


@njit
def push(
    heap: NDArray[np.void], loop: Row, time_ps: int, rank: int, number: int, message: int
) -> None:
    """Add an event to the binary heap."""
    at = loop.size
    loop.size += 1
    while at > 0:
        parent = (at - 1) // 2
        if _before(heap[parent], time_ps, rank, number):
            break
        _put(heap, at, heap[parent])
        at = parent
    heap[at].time_ps, heap[at].rank = time_ps, rank
    heap[at].number, heap[at].message = number, message


@njit
def pop(heap: NDArray[np.void], loop: Row) -> None:
    """Remove the first event of the binary heap."""
    loop.size -= 1
    last = heap[loop.size]
    replace_first(heap, loop, last.time_ps, last.rank, last.number, last.message)


@njit
def replace_first(
    heap: NDArray[np.void], loop: Row, time_ps: int, rank: int, number: int, message: int
) -> None:
    """Remove the first event and add one: quicker than both, above all if it soon follows."""
    at, child = 0, 1
    while child < loop.size:
        right = child + 1
        if right < loop.size:
            r = heap[right]
            if _before(r, heap[child].time_ps, heap[child].rank, heap[child].number):
                child = right
        if not _before(heap[child], time_ps, rank, number):
            break
        _put(heap, at, heap[child])
        at, child = child, 2 * child + 1
    heap[at].time_ps, heap[at].rank = time_ps, rank
    heap[at].number, heap[at].message = number, message
