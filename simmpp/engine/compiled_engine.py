"""The fast engine: the same steps, driven by an event loop that is compiled too."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit_reading as njit
from simmpp.common.errors import ModelError
from simmpp.engine.arrays.hashtable import USED
from simmpp.engine.arrays.layout import NONE, Row, Run
from simmpp.engine.arrays.views import messages, messages_marks, outbox
from simmpp.engine.event_heap import EVENT_KEY, HEAD, INSTANT, pop, push, replace_first
from simmpp.engine.local_only import run_alone
from simmpp.engine.pe.sending import move_head
from simmpp.engine.pe.step import SLEEP, step
from simmpp.engine.record.log import note_arrival
from simmpp.engine.state import State, starved

EVENTS_PER_CALL = 1 << 20
"""So that progress is shown and Ctrl-C is heard."""
FINISHED, PAUSED, FULL, STARVED = range(4)

LINE = np.dtype(
    [
        ("first", "i4"),  # inbox of the PE, linked through MESSAGE.chain
        ("last", "i4"),
        ("instants", "i8"),
        ("phase", "i4"),  # of the next instant
        ("asleep", "i4"),
    ]
)
LOOP = np.dtype([("size", "i8"), ("arrivals", "i8")])


class CompiledRun:
    """One run in compiled code."""

    def __init__(self, state: State, progress: Callable[[int], None] | None = None) -> None:
        self.state = state
        self._progress = progress
        self._heap = np.zeros(0, EVENT_KEY)
        self._lines = np.zeros(len(state.pes), LINE)
        self._loop = np.zeros(1, LOOP)

    @property
    def arrivals(self) -> int:
        """Messages that have arrived."""
        return int(self._loop["arrivals"][0])

    def run(self) -> None:
        """Run until no ray is left.

        Raises ModelError if rays are left and nothing is scheduled.
        """
        status = FINISHED if self.state["rays_left"] == 0 or self._needs_no_events() else PAUSED
        while status in (PAUSED, FULL):
            self._make_room()
            arguments = (self.state.runs, self._heap, self._lines, self._loop, EVENTS_PER_CALL)
            status = _run(*arguments)
            if self._progress is not None:
                self._progress(self.state["rays_left"])
        if status == STARVED:
            raise ModelError(starved(self.state))

    def _needs_no_events(self) -> bool:
        """Was nothing remote, so that the run is at its end without any event?"""
        records = ("logs", "record_tests", "record_counters")
        if any(self.state[name] for name in records) or not run_alone(self.state.runs):
            return False
        if self._progress is not None:
            self._progress(0)
        return True

    def _make_room(self) -> None:
        self.state.ensure_room(int(self._heap[0]["time_ps"]) if len(self._heap) else 0)
        needed = len(self.state.messages) + len(self._lines) + 1
        if len(self._heap) < needed:
            heap = np.zeros(needed, EVENT_KEY)
            heap[: len(self._heap)] = self._heap
            self._heap = heap


@njit
def _run(
    runs: NDArray[np.void],
    heap: NDArray[np.void],
    lines: NDArray[np.void],
    loops: NDArray[np.void],
    n_events: int,
) -> int:
    """Handle up to ``n_events`` events; the first call begins with all PEs at time 0."""
    s: Run = runs[0]
    loop = loops[0]
    if s.activities == 0 and loop.size == 0:
        for me in range(lines.size):
            lines[me].first, lines[me].last = NONE, NONE
            _schedule_instant(heap, lines, loop, me, 0)
    for _ in range(n_events):
        if loop.size == 0:
            return FINISHED if s.rays_left == 0 else STARVED
        time_ps, rank, message = heap[0].time_ps, heap[0].rank, heap[0].message
        if s.rays_left == 0 and time_ps >= s.last_ray_ps:
            return FINISHED
        if _short_of_room(s):
            return FULL
        if rank >= HEAD:
            move_first(runs, heap, loop)
            continue
        pop(heap, loop)
        if message != NONE:
            _arrive(runs, heap, lines, loop, message, time_ps)
        else:
            _step(runs, heap, lines, loop, rank - INSTANT, time_ps)
    return PAUSED


@njit
def _short_of_room(s: Run) -> bool:
    most = min(s.outbox_n, s.rays_left + 2 * s.processors)
    short = s.messages_n - messages_marks(s)[USED] < most
    return short or (s.logs and s.log_n - s.n_logged < most + 2)


@njit
def _arrive(
    runs: NDArray[np.void],
    heap: NDArray[np.void],
    lines: NDArray[np.void],
    loop: Row,
    message: int,
    now_ps: int,
) -> None:
    """A message lies in the inbox of its destination, and wakes it if it sleeps."""
    s: Run = runs[0]
    me = messages(s)[message].destination
    line = lines[me]
    messages(s)[message].chain = NONE
    if line.first == NONE:
        line.first = message
    else:
        messages(s)[line.last].chain = message
    line.last = message
    loop.arrivals += 1
    if s.logs:
        note_arrival(runs, message)
    if line.asleep:
        line.asleep = 0
        _schedule_instant(heap, lines, loop, me, now_ps)


@njit
def _step(
    runs: NDArray[np.void],
    heap: NDArray[np.void],
    lines: NDArray[np.void],
    loop: Row,
    me: int,
    now_ps: int,
) -> None:
    """One instant of a PE; what it sends travels."""
    s: Run = runs[0]
    line = lines[me]
    message = line.first
    following = messages(s)[message].chain if message != NONE else NONE
    next_ps = step(runs, me, line.phase, message, now_ps)
    line.phase = s.phase
    if s.consumed:
        line.first = following
    for i in range(s.n_sent):
        row = outbox(s)[i]
        m = messages(s)[row]
        if s.contends:
            push(heap, loop, m.head_ps, HEAD + m.source, m.number, row)
        else:
            push(heap, loop, m.arrival_ps, _arrival_rank(m), m.number, row)
    if next_ps == SLEEP:
        line.asleep = 1
    else:
        _schedule_instant(heap, lines, loop, me, next_ps)


@njit
def move_first(runs: NDArray[np.void], heap: NDArray[np.void], loop: Row) -> None:
    """The first event is the head of a message: it goes on, or the message arrives."""
    rank, number, message = heap[0].rank, heap[0].number, heap[0].message
    next_ps = move_head(runs, message)
    m = messages(runs[0])[message]
    if m.arrival_ps != NONE:
        rank = _arrival_rank(m)
    replace_first(heap, loop, next_ps, rank, number, message)


@njit
def _arrival_rank(m: Row) -> int:
    return (np.int64(m.destination) << 31) | m.source


@njit
def _schedule_instant(
    heap: NDArray[np.void], lines: NDArray[np.void], loop: Row, me: int, time_ps: int
) -> None:
    lines[me].instants += 1
    push(heap, loop, time_ps, INSTANT + me, lines[me].instants, NONE)
