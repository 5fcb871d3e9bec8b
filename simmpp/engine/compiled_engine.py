"""The fast engine: the same steps, driven by an event loop that is compiled too."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.engine.arrays.hashtable import link
from simmpp.engine.arrays.records import BY_NIC, BY_THREAD, NONE, SLEEP, WOKEN, Row, Run
from simmpp.engine.arrays.views import heap, messages, outbox, processes
from simmpp.engine.event_heap import (
    HEAD,
    INSTANT,
    PE_BITS,
    ROUND,
    close,
    heap_lacks_room,
    push,
    replace_first,
    take,
)
from simmpp.engine.local_only import run_alone
from simmpp.engine.network import move_head
from simmpp.engine.pe.bounds.rooms import note_arrival_of
from simmpp.engine.pe.gets import is_get, send_back
from simmpp.engine.pe.serving import serve
from simmpp.engine.pe.step import step
from simmpp.engine.pe.tables.rounds import round_begins
from simmpp.engine.record.log import note_arrival
from simmpp.engine.state import State, room_lacking

FIRST_EVENTS, MOST_EVENTS = 1 << 10, 1 << 20
"""Handled in one call, in which Ctrl-C and a point's timeout are not heard: four times as many each
time, until that takes CALL_S; half as many if it takes twice as long, as hooks may be slow."""
CALL_S = 0.1
FINISHED, PAUSED, FULL, STARVED = range(4)


class CompiledRun:
    """One run in compiled code."""

    def __init__(self, state: State, progress: Callable[[int], None] | None = None) -> None:
        self.state = state
        self._progress = progress

    @property
    def arrivals(self) -> int:
        """Messages that have arrived."""
        return self.state["arrivals"]

    def run(self) -> None:
        """Run until no ray is left.

        Raises ModelError if rays are left and nothing is scheduled.
        """
        n_events, status = FIRST_EVENTS, PAUSED
        if self.state["rays_left"] == 0 or self._needs_no_events():
            status = FINISHED
        while status in (PAUSED, FULL):
            self.state.ensure_room(self._next_ps())
            self.state.ensure_heap()
            began_s = time.monotonic()
            status = _run(self.state.runs, n_events)
            n_events = _as_many(n_events, time.monotonic() - began_s)
            if self._progress is not None:
                self._progress(self.state["rays_left"])
        if status == STARVED:
            self.state.starve()

    def _needs_no_events(self) -> bool:
        """Was nothing remote, so that the run is at its end without any event?"""
        records = ("logs", "record_tests", "record_counters", "record_ends", "measures", "uneven")
        # PEs that have nothing to do may have something to say.
        talks = self.state["idle"] != 0 or self.state["steals"] != 0
        is_more = talks or self.state["n_rounds"] > 1 or self.state["leaves_n"] > 0
        if is_more or any(self.state[name] for name in records) or not run_alone(self.state.runs):
            return False
        if self._progress is not None:
            self._progress(0)
        return True

    def _next_ps(self) -> int:
        """The time of the next event."""
        events = self.state.arrays["heap"]
        return int(events[0]["time_ps"]) if len(events) else 0


def _as_many(n_events: int, took_s: float) -> int:
    """How many events are handled at the next call."""
    if took_s < CALL_S:
        return min(4 * n_events, MOST_EVENTS)
    return max(n_events // 2, 1) if took_s > 2 * CALL_S else n_events


@njit
def _run(runs: NDArray[np.void], n_events: int) -> int:
    """Handle up to ``n_events`` events; the first call begins with all PEs at time 0."""
    s: Run = runs[0]
    if s.activities == 0 and s.n_events == 0:
        for me in range(s.processors):
            server = processes(s)[s.processors + me]
            processes(s)[me].first = server.first = NONE
            server.asleep = 1
            _schedule_instant(s, me, 0)
    for _ in range(n_events):
        if s.n_events == 0:
            return FINISHED if s.rays_left == 0 else STARVED
        event = heap(s)[0]
        time_ps, rank, message = event.time_ps, event.rank, event.message
        number = event.number
        # Not at once: messages that arrive until the last ray's end are counted.
        if s.rays_left == 0 and time_ps >= s.last_ray_ps:
            return FINISHED
        # Looked at before the event is taken, so that it is handled when there is room.
        if room_lacking(s) or heap_lacks_room(s):
            return FULL
        if rank >= HEAD:
            move_first(s)
            continue
        take(s)
        if message != NONE:
            _arrive(s, message, time_ps)
        elif rank == ROUND:
            _begin_round(s, time_ps)
        elif number != processes(s)[rank - INSTANT].instants:
            s.n_stale -= 1  # of a sleeper whom a message has woken before
        elif rank - INSTANT < s.processors:
            _step(s, rank - INSTANT, time_ps)
        else:
            _serve(s, rank - INSTANT - s.processors, time_ps)
        close(s)
    return PAUSED


@kernel
def _arrive(s: Run, message: int, now_ps: int) -> None:
    """A message lies in the inbox of its destination, or is answered by the network card there."""
    s.arrivals += 1
    if s.logs:
        note_arrival(s, message)
    if s.measures:
        note_arrival_of(s, message)
    m = messages(s)[message]
    if s.service == BY_NIC and is_get(m):
        send_back(s, message)
        _carry(s)
        return
    me = m.destination + s.processors if s.service == BY_THREAD else m.destination
    _deliver(s, message, me, now_ps)


@kernel
def _deliver(s: Run, message: int, me: int, now_ps: int) -> None:
    """A message lies in the inbox of a PE or thread, and wakes it if it sleeps."""
    link(messages(s), processes(s)[me], message)
    _rouse(s, me, now_ps)


@kernel
def _rouse(s: Run, me: int, now_ps: int) -> None:
    process = processes(s)[me]
    if process.asleep:
        process.asleep = 0
        if process.phase == WOKEN:
            s.n_stale += 1
        _schedule_instant(s, me, now_ps)


@kernel
def _begin_round(s: Run, now_ps: int) -> None:
    """All know that a round begins, and go on."""
    round_begins(s)
    for me in range(s.processors):
        _rouse(s, me, now_ps)
    _schedule_round(s)


@kernel
def _schedule_round(s: Run) -> None:
    if s.round_ps != NONE:
        push(s, s.round_ps, ROUND, s.next_round, NONE)


@kernel
def _step(s: Run, me: int, now_ps: int) -> None:
    """One instant of a PE; what it sends travels."""
    process = processes(s)[me]
    message = process.first
    # Read before the step, which gives the message's place back and may use it for another one.
    following = messages(s)[message].next if message != NONE else NONE
    next_ps = step(s, me, process.phase, message, now_ps)
    process.phase = s.phase
    if s.consumed:
        process.first = following
    _go_on(s, me, next_ps)
    _schedule_round(s)


@kernel
def _serve(s: Run, me: int, now_ps: int) -> None:
    """One instant of the thread of a PE."""
    process = processes(s)[s.processors + me]
    message = process.first
    following = messages(s)[message].next if message != NONE else NONE
    next_ps = serve(s, me, message, now_ps)
    if s.consumed:
        process.first = following
    if s.handed != NONE:
        _deliver(s, s.handed, me, now_ps)
    _go_on(s, s.processors + me, next_ps)


@kernel
def _go_on(s: Run, me: int, next_ps: int) -> None:
    """What a PE or thread has sent travels; its next instant comes, or it sleeps."""
    processes(s)[me].asleep = 1 if next_ps == SLEEP or s.phase == WOKEN else 0
    if next_ps != SLEEP:
        _schedule_instant(s, me, next_ps)
    if s.n_sent > 0:
        _carry(s)


@kernel
def _carry(s: Run) -> None:
    """Messages of the outbox travel."""
    for i in range(s.n_sent):
        row = outbox(s)[i]
        m = messages(s)[row]
        if s.contends:
            push(s, m.head_ps, HEAD + m.source, m.number, row)
        else:
            push(s, m.arrival_ps, _arrival_rank(m), m.number, row)


@kernel
def move_first(s: Run) -> None:
    """The first event is the head of a message: it goes on, or the message arrives."""
    event = heap(s)[0]
    rank, number, message = event.rank, event.number, event.message
    next_ps = move_head(s, message)
    m = messages(s)[message]
    if m.arrival_ps != NONE:
        rank = _arrival_rank(m)
    replace_first(s, next_ps, rank, number, message)


@kernel
def _arrival_rank(m: Row) -> int:
    return (np.int64(m.destination) << PE_BITS) | m.source


@kernel
def _schedule_instant(s: Run, me: int, time_ps: int) -> None:
    process = processes(s)[me]
    process.instants += 1
    push(s, time_ps, INSTANT + me, process.instants, NONE)
