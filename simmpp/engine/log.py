"""The event log: one row per arrival, and per message unpacked, computation and message packed.

A PE does these one after the other, so its rows are the slices of its time; where there is none it
is idle. Rows are written when they begin, in the order of the engine's events, into a buffer that
is handed on whenever it is full.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from simmpp.compiled import njit
from simmpp.engine.layout import ARRIVAL, COMPUTE, EVENT, NONE, RECEIVE, SEND, Run
from simmpp.engine.memory import log, messages, pes

EVENT_KINDS = ("arrival", "receive", "compute", "send")
"""Names of the field ``event``: ARRIVAL, RECEIVE, COMPUTE, SEND."""

_WORDS = EVENT.itemsize // 8

Sink = Callable[[NDArray[np.void]], None]
"""Gets (n,) EVENT rows, those of a PE in the order of time, which are its own until it returns."""


@njit
def note_arrival(runs: NDArray[np.void], message: int) -> None:
    """A message reached its destination's inbox."""
    s: Run = runs[0]
    m = messages(s)[message]
    _note(s, m.destination, ARRIVAL, 0, m.n, m.arrival_ps, m.arrival_ps)
    _note_message(s, message, m.source)


@njit
def note_receive(s: Run, me: int, message: int, begin_ps: int, end_ps: int) -> None:
    """A message was unpacked."""
    m = messages(s)[message]
    _note(s, me, RECEIVE, 0, m.n, begin_ps, end_ps)
    _note_message(s, message, m.source)


@njit
def note_compute(s: Run, me: int, tests: int, finished: int, begin_ps: int, end_ps: int) -> None:
    """Tests were made, after a look into the inbox, and rays finished."""
    _note(s, me, COMPUTE, tests, finished, begin_ps, end_ps)
    event = log(s)[s.n_logged - 1]
    event.other, event.kind, event.number, event.payload_bytes = NONE, NONE, NONE, 0


@njit
def note_send(s: Run, me: int, message: int, begin_ps: int) -> None:
    """A message was packed; it departs when that is done."""
    m = messages(s)[message]
    _note(s, me, SEND, 0, m.n, begin_ps, m.depart_ps)
    _note_message(s, message, m.destination)


@njit
def _note(s: Run, pe: int, event: int, tests: int, rays: int, begin_ps: int, end_ps: int) -> None:
    row = log(s)[s.n_logged]
    row.time_ps, row.end_ps, row.event = begin_ps, end_ps, event
    row.pe, row.tests, row.rays = pe, tests, rays
    row.load, row.ready = pes(s)[pe].load, pes(s)[pe].n_ready
    s.n_logged += 1


@njit
def _note_message(s: Run, message: int, other: int) -> None:
    m, event = messages(s)[message], log(s)[s.n_logged - 1]
    event.other, event.kind = other, m.kind
    event.number, event.payload_bytes = m.number, m.payload_bytes


class EventLog:
    """Hands rows on as soon as the end of the run can't cut them short any more."""

    def __init__(self, sink: Sink) -> None:
        self._sink = sink
        self._held = np.zeros(0, EVENT)

    def take(self, rows: NDArray[np.void]) -> None:
        """Take new rows, which the caller will overwrite.

        A row that is no send begins at the time of the event that wrote it, so nothing that ends
        before the last of these is concerned by what is still to come.
        """
        happened = np.flatnonzero(rows["event"] != SEND)
        now_ps = int(rows["time_ps"][happened[-1]]) if len(happened) else NONE
        still_held = self._held["end_ps"] > now_ps
        late = np.flatnonzero(rows["end_ps"] > now_ps)  # begun lately, so among the last rows
        n = int(late[0]) if len(late) else len(rows)
        self._sink(chosen(self._held, ~still_held))
        self._sink(rows[:n])
        self._held = join([chosen(self._held, still_held), rows[n:]])

    def close(self, makespan_ps: int) -> None:
        """The run is over: what goes on ends here, and what has not departed never will."""
        rows = self._held
        cut = rows["end_ps"] > makespan_ps
        rows["end_ps"][cut] = makespan_ps
        rows["number"][cut & (rows["event"] == SEND)] = NONE
        self._sink(chosen(rows, ~cut | (rows["time_ps"] < makespan_ps)))


class Collector:
    """A sink that keeps all rows."""

    def __init__(self) -> None:
        self._parts: list[NDArray[np.void]] = []

    def __call__(self, rows: NDArray[np.void]) -> None:
        self._parts.append(join([rows]))

    def rows(self) -> NDArray[np.void]:
        """All rows, (n,) EVENT."""
        return join(self._parts)


def join(parts: Sequence[NDArray[np.void]]) -> NDArray[np.void]:
    """Rows one after the other; numpy copies words ten times as fast as records of fields."""
    words = [np.zeros((0, _WORDS), np.int64), *map(_words, parts)]
    return np.concatenate(words).view(EVENT)[:, 0]


def chosen(rows: NDArray[np.void], which: NDArray[np.bool_]) -> NDArray[np.void]:
    """The rows where ``which`` (n,) is true."""
    return np.compress(which, _words(rows), axis=0).view(EVENT)[:, 0]


def _words(rows: NDArray[np.void]) -> NDArray[np.int64]:
    return rows.view(np.int64).reshape(-1, _WORDS)
