"""The event log: one row per arrival, and per message unpacked, computation and message packed.

A PE does these one after the other, so its rows are the slices of its time; where there is none it
is idle. So it is with its thread, if there is one: that serves (unpacks) and answers (packs), and
what the PE receives then is taken over. A network card answers in no time. Rows are written when
they begin, in the order of the engine's events, into a buffer that is handed on whenever it is
full.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.engine.arrays.records import (
    ANSWER,
    ARRIVAL,
    COMPUTE,
    EVENT,
    NONE,
    RECEIVE,
    SEND,
    SERVE,
    Run,
)
from simmpp.engine.arrays.views import log, messages, pes
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST

LOG_ROWS = 1 << 13
"""Rows that are kept before they are handed on: half a megabyte."""
EVENT_KINDS = ("arrival", "receive", "compute", "send", "serve", "answer")
"""Names of the field ``event``: ARRIVAL, RECEIVE, COMPUTE, SEND, SERVE, ANSWER."""

_WORDS = EVENT.itemsize // 8

Sink = Callable[[NDArray[np.void]], None]
"""Gets rows (n,) EVENT, which are its own until it returns: all that ended since the last call.

The rows of a PE come in the order of time; what comes later ends later.
"""


@kernel
def note_arrival(s: Run, message: int) -> None:
    """A message reached its destination's inbox."""
    m = messages(s)[message]
    _note(s, m.destination, ARRIVAL, 0, m.n, m.arrival_ps, m.arrival_ps)
    _note_message(s, message, m.source)


@kernel
def note_receive(s: Run, me: int, message: int, begin_ps: int, end_ps: int) -> None:
    """A message was unpacked."""
    m = messages(s)[message]
    _note(s, me, RECEIVE, 0, m.n, begin_ps, end_ps)
    _note_message(s, message, m.source)


@kernel
def note_unpack(s: Run, me: int, n: int, n_bytes: int, begin_ps: int, end_ps: int) -> None:
    """Rays of messages that were received before were taken in: a receipt from nobody."""
    _note(s, me, RECEIVE, 0, n, begin_ps, end_ps)
    event = log(s)[s.n_logged - 1]
    event.other, event.kind, event.number, event.payload_bytes = NONE, RAYS, NONE, n_bytes


@kernel
def note_reduction(s: Run, me: int, begin_ps: int, end_ps: int) -> None:
    """The PE took part in a reduction: a receipt of nothing but a header, from nobody."""
    _note(s, me, RECEIVE, 0, 0, begin_ps, end_ps)
    event = log(s)[s.n_logged - 1]
    event.other, event.kind, event.number, event.payload_bytes = NONE, LOAD, NONE, 0


@kernel
def note_compute(s: Run, me: int, tests: int, finished: int, begin_ps: int, end_ps: int) -> None:
    """Tests were made, after a look into the inbox, and rays finished."""
    _note(s, me, COMPUTE, tests, finished, begin_ps, end_ps)
    event = log(s)[s.n_logged - 1]
    event.other, event.kind, event.number, event.payload_bytes = NONE, NONE, NONE, 0


@kernel
def note_send(s: Run, me: int, message: int, begin_ps: int) -> None:
    """A message was packed; it departs when that is done."""
    m = messages(s)[message]
    _note(s, me, SEND, 0, m.n, begin_ps, m.depart_ps)
    _note_message(s, message, m.destination)


@kernel
def note_serve(s: Run, me: int, message: int, begin_ps: int, end_ps: int) -> None:
    """A thread unpacked a message."""
    m = messages(s)[message]
    _note(s, me, SERVE, 0, m.n, begin_ps, end_ps)
    _note_message(s, message, m.source)
    _hide_load(s)


@kernel
def note_answer(s: Run, message: int, begin_ps: int) -> None:
    """A thread packed an object, or a network card sends what it was asked for."""
    m = messages(s)[message]
    _note(s, m.source, ANSWER, 0, m.n, begin_ps, m.depart_ps)
    _note_message(s, message, m.destination)
    _hide_load(s)


@kernel
def _hide_load(s: Run) -> None:
    """The PE may be in the middle of an activity."""
    event = log(s)[s.n_logged - 1]
    event.load, event.ready = NONE, NONE


@kernel
def _note(s: Run, pe: int, event: int, tests: int, rays: int, begin_ps: int, end_ps: int) -> None:
    row = log(s)[s.n_logged]
    row.time_ps, row.end_ps, row.event = begin_ps, end_ps, event
    row.pe, row.tests, row.rays = pe, tests, rays
    row.load, row.ready = pes(s)[pe].load, pes(s)[pe].n_ready
    row.objects = row.requests = 0
    s.n_logged += 1


@kernel
def _note_message(s: Run, message: int, other: int) -> None:
    m, event = messages(s)[message], log(s)[s.n_logged - 1]
    event.other, event.kind = other, m.kind
    event.number, event.payload_bytes = m.number, m.payload_bytes
    part = message
    while part != NONE:
        kind = messages(s)[part].kind
        if kind == OBJECT:
            event.objects += 1
        elif kind == REQUEST:
            event.requests += 1
        part = messages(s)[part].part


def hand_on(rows: NDArray[np.void], now_ps: int, sink: Sink) -> int:
    """Hand on what is over at ``now_ps``, the time of the next event; the rest moves to the front.

    Rows are written when they begin, and the run may end before they do. Returns how many are left.
    """
    late = np.flatnonzero(rows["end_ps"] > now_ps)
    n = len(rows) - len(late)
    if len(late) == 0:
        sink(rows)
        return 0
    words = _words(rows)
    held = words[late]
    _close_gaps(words, late)
    sink(rows[:n])
    words[: len(late)] = held
    return len(late)


@njit
def _close_gaps(words: NDArray[np.int64], gaps: NDArray[np.int64]) -> None:
    """Move rows forward over those numbered ``gaps``; in place, as new memory costs more."""
    to, gap = gaps[0], 0
    for row in range(gaps[0], len(words)):
        if gap < gaps.size and gaps[gap] == row:
            gap += 1
        else:
            for word in range(words.shape[1]):
                words[to, word] = words[row, word]
            to += 1


def hand_on_last(rows: NDArray[np.void], makespan_ps: int, sink: Sink) -> None:
    """The run is over: what goes on ends here, and what has not departed never will."""
    rows["end_ps"] = makespan_ps
    rows["number"][np.isin(rows["event"], (SEND, ANSWER))] = NONE
    begun = rows["time_ps"] < makespan_ps
    sink(_words(rows)[begun].view(EVENT)[:, 0])


class Collector:
    """A sink that keeps all rows."""

    def __init__(self) -> None:
        self._parts = [np.zeros((0, _WORDS), np.int64)]

    def __call__(self, rows: NDArray[np.void]) -> None:
        """Keep these."""
        self._parts.append(_words(rows).copy())

    def rows(self) -> NDArray[np.void]:
        """All rows, (n,) EVENT."""
        return np.concatenate(self._parts).view(EVENT)[:, 0]


def _words(rows: NDArray[np.void]) -> NDArray[np.int64]:
    """The same memory: numpy copies words ten times as fast as records."""
    return rows.view(np.int64).reshape(-1, _WORDS)
